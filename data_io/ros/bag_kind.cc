#include "data_io/ros/bag_kind.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "data_io/files/compression.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRos1Magic = "#ROSBAG V";
constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
constexpr std::string_view kMcapMagic{"\x89MCAP", 5};

bool Equals(const std::vector<std::byte>& bytes, std::string_view text) {
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()) == text;
}

bool IsCompressedName(const fs::path& file) {
  return file.extension() == ".zstd";
}

// Name without the extension that rosbag2 appends to compressed files.
fs::path PlainName(const fs::path& file) {
  return IsCompressedName(file) ? fs::path(file).replace_extension() : file;
}

// Number at the end of "dive_12.db3"; files without one come first.
std::uint64_t NumberOf(const fs::path& file) {
  const std::string stem = PlainName(file).stem().string();
  const std::string digits = stem.substr(stem.find_last_not_of("0123456789") + 1);
  std::uint64_t number = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

// First bytes of a storage, and the extension of its files.
struct StorageMarks {
  std::string_view magic;
  std::string_view extension;
};

StorageMarks MarksOf(Ros2Storage storage) {
  return storage == Ros2Storage::kSqlite ? StorageMarks{kSqliteMagic, ".db3"}
                                         : StorageMarks{kMcapMagic, ".mcap"};
}

// True if the content of the file, inflated if it is compressed, has this storage. A compressed file that is
// too damaged to be inflated is judged by its name.
bool HasStorage(const fs::path& file, const StorageMarks& marks) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const std::vector<std::byte> bytes = FirstPlainBytes(file, marks.magic.size());
  if (Equals(bytes, marks.magic)) return true;
  return bytes.size() < marks.magic.size() && IsCompressedName(file) &&
         PlainName(file).extension() == marks.extension && IsZstd(FirstBytes(file, kZstdMagicBytes));
}

// Files of a folder, or the file itself, by number, then name.
std::vector<fs::path> FilesOf(const fs::path& path, const StorageMarks& marks) {
  std::vector<fs::path> files;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
      const fs::path extension = PlainName(entry.path()).extension();
      if ((extension == ".db3" || extension == ".mcap") && HasStorage(entry.path(), marks))
        files.push_back(entry.path());
    }
  } else if (HasStorage(path, marks)) {
    files.push_back(path);
  }
  // The tools of ROS 2 leave an inflated file beside the compressed one.
  const std::vector<fs::path> all = files;
  std::erase_if(files, [&all](const fs::path& file) {
    return IsCompressedName(file) && std::ranges::find(all, PlainName(file)) != all.end();
  });
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return NumberOf(a) != NumberOf(b) ? NumberOf(a) < NumberOf(b) : a < b;
  });
  return files;
}

}  // namespace

bool IsRos1Bag(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && Equals(FirstBytes(path, kRos1Magic.size()), kRos1Magic);
}

bool IsRos2Bag(const fs::path& path) {
  return !Ros2BagFiles(path, Ros2Storage::kSqlite).empty() || !Ros2BagFiles(path, Ros2Storage::kMcap).empty();
}

std::vector<fs::path> Ros2BagFiles(const fs::path& path, Ros2Storage storage) {
  return FilesOf(path, MarksOf(storage));
}

}  // namespace sonarcal::data_io
