#include "data_io/ros/bag_kind.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRos1Magic = "#ROSBAG V";
constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
constexpr std::string_view kMcapMagic{"\x89MCAP", 5};

bool BeginsWith(const fs::path& file, std::string_view magic) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) < magic.size() || error) return false;
  const std::vector<std::byte> bytes = ReadFileRange(file, 0, magic.size(), "magic number");
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()) == magic;
}

// Number at the end of "dive_12.db3"; files without one come first.
std::uint64_t NumberOf(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::string digits = stem.substr(stem.find_last_not_of("0123456789") + 1);
  std::uint64_t number = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

// Files of a folder, or the file itself, that begin with `magic`; by number, then name.
std::vector<fs::path> FilesThatBegin(const fs::path& path, std::string_view magic) {
  std::vector<fs::path> files;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
      const fs::path extension = entry.path().extension();
      if ((extension == ".db3" || extension == ".mcap") && BeginsWith(entry.path(), magic))
        files.push_back(entry.path());
    }
  } else if (BeginsWith(path, magic)) {
    files.push_back(path);
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return NumberOf(a) != NumberOf(b) ? NumberOf(a) < NumberOf(b) : a < b;
  });
  return files;
}

}  // namespace

bool IsRos1Bag(const fs::path& path) {
  return BeginsWith(path, kRos1Magic);
}

bool IsRos2Bag(const fs::path& path) {
  return !Ros2BagFiles(path, Ros2Storage::kSqlite).empty() || !Ros2BagFiles(path, Ros2Storage::kMcap).empty();
}

std::vector<fs::path> Ros2BagFiles(const fs::path& path, Ros2Storage storage) {
  return FilesThatBegin(path, storage == Ros2Storage::kSqlite ? kSqliteMagic : kMcapMagic);
}

}  // namespace sonarcal::data_io
