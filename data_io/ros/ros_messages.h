// ROS messages that are read from bags, field by field in the order of their definitions. One decoder serves
// ROS 1 and ROS 2; the only difference is the sequence number of a ROS 1 header. Types are named as in ROS 1,
// "package/Message".
//
// Sources: github.com/apl-ocean-engineering/marine_msgs (marine_acoustic_msgs),
// MarineRoboticsGroup/sonar_oculus, and the common packages sensor_msgs, nav_msgs, geometry_msgs, tf2_msgs.
//
// Decoders throw DataError if the bytes are not exactly such a message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/types/pose.h"
#include "data_io/ros/message_stream.h"

namespace sonarcal::data_io {

struct RosHeader {
  std::int64_t stamp_ns = 0;  // since 1970; 0 if the writer omitted it
  std::string frame_id;
};

inline constexpr std::int64_t kNsPerS = 1'000'000'000;

// Seconds, accurate to 0.3 microseconds for times since 1970.
double SecondsOfNs(std::int64_t time_ns);

// Every message below begins with a header. Reads only its time; the message's first kRosStampBytes suffice.
std::int64_t ReadStampNs(MessageStream& stream);
inline constexpr std::size_t kRosStampBytes = 16;

// marine_acoustic_msgs/ProjectedSonarImage. Spans point into the message's bytes.
struct ProjectedSonarImage {
  RosHeader header;
  float frequency_hz = 0.0F;  // 0 = unknown; the sound speed likewise
  float sound_speed_m_per_s = 0.0F;
  std::vector<float> tx_beam_width_rad;  // may be empty, as may rx
  std::vector<float> rx_beam_width_rad;
  std::vector<Eigen::Vector3d> beam_direction;  // Z forward, X up
  std::vector<float> range_m;                   // centres of the bins
  bool is_big_endian = false;
  std::uint32_t sample_type = 0;  // 0..9: u8, i8, u16, i16, u32, i32, u64, i64, f32, f64
  std::uint32_t beam_count = 0;
  std::span<const std::byte> data;
};
ProjectedSonarImage ReadProjectedSonarImage(MessageStream& stream);

// sensor_msgs/Image.
struct RosImage {
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;  // "mono8", "mono16", "rgb8", ...
  bool is_big_endian = false;
  std::uint32_t row_bytes = 0;
  std::span<const std::byte> data;
};
RosImage ReadRosImage(MessageStream& stream);

// sensor_msgs/CompressedImage.
struct RosCompressedImage {
  RosHeader header;
  std::string format;  // "png", "jpeg", "mono8; png compressed ", ...
  std::span<const std::byte> data;
};
RosCompressedImage ReadRosCompressedImage(MessageStream& stream);

// sonar_oculus/OculusPing. The package has changed the message. First the raw picture followed the header.
// Later it came last, compressed in one version and raw in another, and the environment was dropped.
struct RosOculusPing {
  RosHeader header;
  std::uint8_t mode = 0;
  std::uint8_t gamma = 0;
  std::uint8_t flags = 0;
  double range_setting = 0.0;
  double gain_percent = 0.0;
  double fire_sound_speed_m_per_s = 0.0;  // requested; 0 = the sonar's own estimate
  double salinity_ppt = 0.0;
  std::uint32_t ping_id = 0;
  bool has_environment = false;  // the members from frequency to sound speed are set
  double frequency_hz = 0.0;
  double temperature_c = 0.0;
  double pressure_bar = 0.0;
  double sound_speed_m_per_s = 0.0;
  std::vector<std::int16_t> bearing_centideg;
  double range_resolution_m = 0.0;
  std::uint32_t ranges = 0;
  std::uint32_t beams = 0;
  bool is_compressed = false;
  RosImage image;                 // if raw
  RosCompressedImage compressed;  // if compressed
};

// Tries the known versions and accepts the one that ends with the message's last byte and has consistent
// sizes.
RosOculusPing ReadRosOculusPing(std::span<const std::byte> bytes, MessageEncoding encoding,
                                const std::string& where);

// One pose of a message that contains poses.
struct RosPose {
  std::int64_t stamp_ns = 0;
  std::string parent_frame;
  std::string child_frame;  // empty for geometry_msgs/PoseStamped
  Pose parent_from_child;   // as sent; see CheckedPose
};

// parent_from_child with a rotation of unit length. Throws DataError, beginning with `where`, if the length
// of the rotation differs from 1 by more than 1e-3, or the position is not finite.
Pose CheckedPose(const RosPose& pose, const std::string& where);

RosPose ReadOdometry(MessageStream& stream);                 // nav_msgs/Odometry
RosPose ReadPoseStamped(MessageStream& stream);              // geometry_msgs/PoseStamped
std::vector<RosPose> ReadTransforms(MessageStream& stream);  // tf2_msgs/TFMessage, tf/tfMessage

}  // namespace sonarcal::data_io
