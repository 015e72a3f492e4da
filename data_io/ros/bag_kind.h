// Detects bags by their first bytes. Needs no library of ROS.
#pragma once

#include <filesystem>
#include <vector>

namespace sonarcal::data_io {

// True if the file begins with "#ROSBAG V".
bool IsRos1Bag(const std::filesystem::path& path);

// Storages of bags of ROS 2.
enum class Ros2Storage { kSqlite, kMcap };

// The file itself or the files of a folder that have this storage, by the number in the name, then by name.
// Files that rosbag2 has compressed as a whole (Zstandard, name "dive_0.db3.zstd") are among them, unless the
// inflated file stands beside them. None for a folder that holds several bags: its files have different
// storages, or names that differ before the number ("dive_0.db3", "other_0.db3") and are not all listed in
// metadata.yaml.
std::vector<std::filesystem::path> Ros2BagFiles(const std::filesystem::path& path, Ros2Storage storage);

// True for a file in one of the storages of ROS 2, and for a folder that holds one bag of such files.
bool IsRos2Bag(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
