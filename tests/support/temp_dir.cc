#include "tests/support/temp_dir.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/types/error.h"

namespace sonarcal::testing {

TempDir::TempDir() {
  std::string pattern = (std::filesystem::temp_directory_path() / "sonarcal-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw DataError("cannot make a directory like {}", pattern);
  path_ = pattern;
}

TempDir::~TempDir() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

void WriteFile(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw DataError("cannot write {}", path.string());
}

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw DataError("cannot read {}", path.string());
  return text.str();
}

}  // namespace sonarcal::testing
