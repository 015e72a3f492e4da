// Bags of ROS 2 in SQLite's storage: a `.db3` file, or a folder of them beside `metadata.yaml`, as rosbag2
// writes. Tables, as of its first version:
//
//   topics    id, name, type "package/msg/Message", serialization_format "cdr", ...
//   messages  id, topic_id, timestamp in ns, data (the message, CDR)
//
// Source: github.com/ros2/rosbag2, rosbag2_storage_sqlite3. The files of a folder are put together by the
// number at the end of their names; metadata.yaml is not read. Storage mcap and compressed bags are refused
// by name.
//
// The database is opened read-only and immutable, with its triggers, views and functions of the schema off;
// no value above kMostBagMessageBytes, or above the file's size, is read, nor more rows than the file can
// hold. What still stands in a write-ahead log beside the file is not seen, with a note.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/ros/bag.h"

namespace sonarcal::data_io {

// True for an SQLite file, the only ones read, for a file of mcap, which is refused when opened, and for a
// folder that holds either.
bool IsRos2Bag(const std::filesystem::path& path);

std::unique_ptr<Bag> OpenRos2Bag(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
