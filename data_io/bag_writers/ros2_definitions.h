// Definitions of the ROS 2 messages that are written, as stored in a bag: the message's own fields, then
// those of its nested messages. Comments and constants are omitted; they do not affect the encoding.
#pragma once

#include <string>

namespace sonarcal::data_io {

// `type` is named as in ROS 1: "sensor_msgs/Image". Must be one of the types in ros2_definitions.cc.
std::string Ros2Definition(const std::string& type);

}  // namespace sonarcal::data_io
