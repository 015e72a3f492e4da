// Bags of ROS 2 in SQLite storage: a `.db3` file, or a folder of them beside `metadata.yaml`, as rosbag2
// writes, also compressed by file (`.db3.zstd`) or by message. Tables since its first version:
//
//   topics    id, name, type "package/msg/Message", serialization_format "cdr", ...
//   messages  id, topic_id, timestamp in ns, data (the message, CDR)
//
// Source: github.com/ros2/rosbag2, rosbag2_storage_sqlite3. The files of a folder are ordered by the number
// at the end of their names; metadata.yaml is not read.
//
// The database is opened read-only and immutable; its triggers, views and schema functions are disabled. No
// value above kMaxBagMessageBytes or above the file's size is read, and not more rows than the file can
// hold. Data in a write-ahead log beside the file are not read, which is noted.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "data_io/ros/bag.h"

namespace sonarcal::data_io {

// Opens the databases of one bag. Throws DataError if one of them has no tables of a bag.
std::unique_ptr<Bag> OpenRos2Bag(const std::vector<std::filesystem::path>& files);

}  // namespace sonarcal::data_io
