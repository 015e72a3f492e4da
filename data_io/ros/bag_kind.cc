#include "data_io/ros/bag_kind.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include "core/types/error.h"
#include "data_io/files/compression.h"
#include "data_io/files/yaml_reader.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRos1Mark = "#ROSBAG V";
constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
constexpr std::string_view kMcapMark{"\x89MCAP", 5};

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

// Parts of the name "dive_12.db3". A name without a number has 0, so that this file comes first.
struct BagFileName {
  std::string bag;  // "dive"
  std::uint64_t number = 0;
};

BagFileName NameOf(const fs::path& file) {
  const std::string stem = PlainName(file).stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
  BagFileName name;
  std::from_chars(stem.data() + digits, stem.data() + stem.size(), name.number);
  const bool is_split = digits > 0 && digits < stem.size() && stem[digits - 1] == '_';
  name.bag = is_split ? stem.substr(0, digits - 1) : stem;
  return name;
}

// First bytes of a storage, and the extension of its files.
struct StorageMarks {
  std::string_view magic;
  std::string_view extension;
};

StorageMarks MarksOf(Ros2Storage storage) {
  return storage == Ros2Storage::kSqlite ? StorageMarks{kSqliteMagic, ".db3"}
                                         : StorageMarks{kMcapMark, ".mcap"};
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
    const std::uint64_t number_a = NameOf(a).number;
    const std::uint64_t number_b = NameOf(b).number;
    return number_a != number_b ? number_a < number_b : a < b;
  });
  return files;
}

// Plain names of the files that rosbag2's metadata.yaml lists; none if it is absent or damaged.
std::set<std::string> FilesOfMetadata(const fs::path& folder) {
  const fs::path file = folder / "metadata.yaml";
  std::set<std::string> names;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return names;
  try {
    const YamlReader list =
        YamlReader::FromFile(file).At("rosbag2_bagfile_information").At("relative_file_paths");
    for (const YamlReader& name : list.Items()) names.insert(PlainName(name.String()).filename().string());
  } catch (const DataError&) {
    names.clear();
  }
  return names;
}

// True if the files of a folder are parts of one bag: by their names, or by the metadata beside them.
bool AreOneBag(const fs::path& folder, const std::vector<fs::path>& files) {
  const auto has_name_of_first = [&](const fs::path& file) {
    return NameOf(file).bag == NameOf(files.front()).bag;
  };
  if (std::ranges::all_of(files, has_name_of_first)) return true;
  const std::set<std::string> listed = FilesOfMetadata(folder);
  return std::ranges::all_of(
      files, [&](const fs::path& file) { return listed.contains(PlainName(file).filename().string()); });
}

}  // namespace

bool IsRos1Bag(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && Equals(FirstBytes(path, kRos1Mark.size()), kRos1Mark);
}

bool IsRos2Bag(const fs::path& path) {
  return !Ros2BagFiles(path, Ros2Storage::kSqlite).empty() || !Ros2BagFiles(path, Ros2Storage::kMcap).empty();
}

std::vector<fs::path> Ros2BagFiles(const fs::path& path, Ros2Storage storage) {
  std::vector<fs::path> files = FilesOf(path, MarksOf(storage));
  std::error_code error;
  if (files.empty() || !fs::is_directory(path, error)) return files;
  const Ros2Storage other = storage == Ros2Storage::kSqlite ? Ros2Storage::kMcap : Ros2Storage::kSqlite;
  if (!AreOneBag(path, files) || !FilesOf(path, MarksOf(other)).empty()) return {};
  return files;
}

}  // namespace sonarcal::data_io
