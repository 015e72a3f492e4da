#include "tests/support/recordings.h"

#include <cstdlib>

namespace sonarcal::testing {

std::optional<std::filesystem::path> FindRecording(const std::string& relative_path) {
  const char* variable = std::getenv("SONARCAL_RECORDINGS");
  const std::filesystem::path root = variable != nullptr && *variable != '\0'
                                         ? std::filesystem::path(variable)
                                         : std::filesystem::path(SONARCAL_SOURCE_DIR) / "recordings";
  const std::filesystem::path path = root / relative_path;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  return path;
}

}  // namespace sonarcal::testing
