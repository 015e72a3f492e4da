// Definitions of the ROS messages that are written, as stored in a bag: the message's own, then those of its
// nested messages. Comments are omitted; they do not affect the MD5.
//
// marine_acoustic_msgs: github.com/apl-ocean-engineering/marine_msgs 88e39b6 (BSD-3-Clause), version 2.
#pragma once

namespace sonarcal::data_io {

inline constexpr const char* kProjectedSonarImageType = "marine_acoustic_msgs/ProjectedSonarImage";
inline constexpr const char* kProjectedSonarImageMd5 = "c72fc8e29ab227a547720a36666022fd";
inline constexpr const char* kProjectedSonarImageText = R"(std_msgs/Header header
PingInfo ping_info
geometry_msgs/Vector3[] beam_directions
float32[] ranges
SonarImageData image
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: marine_acoustic_msgs/PingInfo
float32 frequency
float32 sound_speed
float32[] tx_beamwidths
float32[] rx_beamwidths
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: marine_acoustic_msgs/SonarImageData
bool    is_bigendian
uint32  DTYPE_UINT8 = 0
uint32  DTYPE_INT8 = 1
uint32  DTYPE_UINT16 = 2
uint32  DTYPE_INT16 = 3
uint32  DTYPE_UINT32 = 4
uint32  DTYPE_INT32 = 5
uint32  DTYPE_UINT64 = 6
uint32  DTYPE_INT64 = 7
uint32  DTYPE_FLOAT32 = 8
uint32  DTYPE_FLOAT64 = 9
uint32  dtype
uint32 beam_count
uint8[] data
)";

inline constexpr const char* kPoseStampedType = "geometry_msgs/PoseStamped";
inline constexpr const char* kPoseStampedMd5 = "d3812c3cbc69362b77dc0b19b345f8f5";
inline constexpr const char* kPoseStampedText = R"(Header header
Pose pose
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Pose
Point position
Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
)";

}  // namespace sonarcal::data_io
