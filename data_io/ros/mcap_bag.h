// Bags of ROS in MCAP storage: a `.mcap` file, or a folder of them beside `metadata.yaml`, as rosbag2 writes
// by default. The container is read by data_io/mcap/mcap_file.h.
//
// Channels with message encoding "cdr" (ROS 2) and "ros1" are topics. Channels of other encodings are left
// out, which is noted. The name of a channel's schema is the type of its messages. The files of a folder are
// ordered by the number at the end of their names.
#pragma once

#include <memory>
#include <vector>

#include "data_io/ros/bag.h"
#include "data_io/ros/bag_kind.h"

namespace sonarcal::data_io {

// Record of metadata and its key that hold recording.json.
inline constexpr const char* kRecordingMetadata = "recording";
inline constexpr const char* kRecordingJsonKey = "recording.json";

// Throws DataError for a file of another version, and a file that cannot be read.
std::unique_ptr<Bag> OpenMcapBag(const std::vector<std::filesystem::path>& files);

}  // namespace sonarcal::data_io
