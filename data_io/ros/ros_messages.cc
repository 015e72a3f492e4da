#include "data_io/ros/ros_messages.h"

#include "core/types/error.h"
#include "core/types/rotation.h"

namespace sonarcal::data_io {
namespace {

RosHeader ReadHeader(MessageStream& stream) {
  RosHeader header;
  header.stamp_ns = ReadStampNs(stream);
  header.frame_id = stream.String("header.frame_id");
  return header;
}

Eigen::Vector3d ReadVector(MessageStream& stream, std::string_view field) {
  Eigen::Vector3d vector;
  for (double& element : vector) element = stream.F64(field);
  return vector;
}

// Serialised order: x, y, z, w.
Pose ReadPose(MessageStream& stream, std::string_view position_field, std::string_view rotation_field) {
  Pose pose;
  pose.position_m = ReadVector(stream, position_field);
  const Eigen::Vector3d xyz = ReadVector(stream, rotation_field);
  pose.rotation = Eigen::Quaterniond(stream.F64(rotation_field), xyz.x(), xyz.y(), xyz.z());
  return pose;
}

void SkipF64s(MessageStream& stream, int count, std::string_view field) {
  for (int i = 0; i < count; ++i) stream.F64(field);
}

RosImage ReadRosImageBody(MessageStream& stream) {
  RosImage image;
  image.header = ReadHeader(stream);
  image.height = stream.U32("height");
  image.width = stream.U32("width");
  image.encoding = stream.String("encoding");
  image.is_big_endian = stream.U8("is_bigendian") != 0;
  image.row_bytes = stream.U32("step");
  image.data = stream.Bytes("data");
  return image;
}

RosCompressedImage ReadRosCompressedImageBody(MessageStream& stream) {
  RosCompressedImage image;
  image.header = ReadHeader(stream);
  image.format = stream.String("format");
  image.data = stream.Bytes("data");
  return image;
}

void ReadFire(MessageStream& stream, RosOculusPing& ping) {
  ReadHeader(stream);
  ping.mode = stream.U8("fire_msg.mode");
  ping.gamma = stream.U8("fire_msg.gamma");
  ping.flags = stream.U8("fire_msg.flags");
  ping.range_setting = stream.F64("fire_msg.range");
  ping.gain_percent = stream.F64("fire_msg.gain");
  ping.fire_sound_speed_m_per_s = stream.F64("fire_msg.speed_of_sound");
  ping.salinity_ppt = stream.F64("fire_msg.salinity");
}

void ReadOculusGeometry(MessageStream& stream, RosOculusPing& ping) {
  ping.bearing_centideg = stream.I16s("bearings");
  ping.range_resolution_m = stream.F64("range_resolution");
  ping.ranges = stream.U32("num_ranges");
  ping.beams = stream.U32("num_beams");
}

enum class OculusLayout { kImageFirst, kCompressedLast, kImageLast };

RosOculusPing ReadOculusPingAs(MessageStream& stream, OculusLayout layout) {
  RosOculusPing ping;
  ping.header = ReadHeader(stream);
  if (layout == OculusLayout::kImageFirst) ping.image = ReadRosImageBody(stream);
  ReadFire(stream, ping);
  ping.ping_id = stream.U32("ping_id");
  if (layout == OculusLayout::kImageFirst) {
    ping.has_environment = true;
    stream.U32("status");
    ping.frequency_hz = stream.F64("frequency");
    ping.temperature_c = stream.F64("temperature");
    ping.pressure_bar = stream.F64("pressure");
    ping.sound_speed_m_per_s = stream.F64("speed_of_sound");
  } else {
    stream.U16("part_number");
  }
  stream.U32("start_time");
  ReadOculusGeometry(stream, ping);
  if (layout == OculusLayout::kCompressedLast) {
    ping.is_compressed = true;
    ping.compressed = ReadRosCompressedImageBody(stream);
  } else if (layout == OculusLayout::kImageLast) {
    ping.image = ReadRosImageBody(stream);
  }
  if (ping.bearing_centideg.size() != ping.beams) {
    throw DataError("{}: {} beams and {} bearings, expected one per beam", stream.Where("num_beams"),
                    ping.beams, ping.bearing_centideg.size());
  }
  stream.Finish();
  return ping;
}

}  // namespace

double SecondsOfNs(std::int64_t time_ns) {
  const std::int64_t seconds = time_ns / kNsPerS;
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(time_ns % kNsPerS);
}

std::int64_t ReadStampNs(MessageStream& stream) {
  if (stream.encoding() == MessageEncoding::kRos1) stream.U32("header.seq");
  const std::uint32_t seconds = stream.U32("header.stamp.sec");
  const std::uint32_t nanoseconds = stream.U32("header.stamp.nanosec");
  // Signed in ROS 2; no recording was made before 1970.
  return static_cast<std::int64_t>(seconds) * kNsPerS + nanoseconds;
}

ProjectedSonarImage ReadProjectedSonarImage(MessageStream& stream) {
  constexpr std::uint64_t kVectorBytes = 3 * sizeof(double);
  ProjectedSonarImage image;
  image.header = ReadHeader(stream);
  image.frequency_hz = stream.F32("ping_info.frequency");
  image.sound_speed_m_per_s = stream.F32("ping_info.sound_speed");
  image.tx_beam_width_rad = stream.F32s("ping_info.tx_beamwidths");
  image.rx_beam_width_rad = stream.F32s("ping_info.rx_beamwidths");
  image.beam_direction.resize(stream.Count("beam_directions", kVectorBytes));
  for (Eigen::Vector3d& direction : image.beam_direction) direction = ReadVector(stream, "beam_directions");
  image.range_m = stream.F32s("ranges");
  image.is_big_endian = stream.U8("image.is_bigendian") != 0;
  image.sample_type = stream.U32("image.dtype");
  image.beam_count = stream.U32("image.beam_count");
  image.data = stream.Bytes("image.data");
  stream.Finish();
  return image;
}

RosImage ReadRosImage(MessageStream& stream) {
  RosImage image = ReadRosImageBody(stream);
  stream.Finish();
  return image;
}

RosCompressedImage ReadRosCompressedImage(MessageStream& stream) {
  RosCompressedImage image = ReadRosCompressedImageBody(stream);
  stream.Finish();
  return image;
}

RosOculusPing ReadRosOculusPing(std::span<const std::byte> bytes, MessageEncoding encoding,
                                const std::string& where) {
  std::string of_first;
  for (const OculusLayout layout :
       {OculusLayout::kImageFirst, OculusLayout::kCompressedLast, OculusLayout::kImageLast}) {
    MessageStream stream(bytes, encoding, where);
    try {
      return ReadOculusPingAs(stream, layout);
    } catch (const DataError& error) {
      if (of_first.empty()) of_first = error.what();
    }
  }
  throw DataError(of_first);
}

RosPose ReadOdometry(MessageStream& stream) {
  constexpr int kCovariance = 36;
  constexpr int kTwist = 6;
  const RosHeader header = ReadHeader(stream);
  RosPose pose{header.stamp_ns, header.frame_id, stream.String("child_frame_id"), {}};
  pose.parent_from_child = ReadPose(stream, "pose.pose.position", "pose.pose.orientation");
  SkipF64s(stream, kCovariance, "pose.covariance");
  SkipF64s(stream, kTwist, "twist.twist");
  SkipF64s(stream, kCovariance, "twist.covariance");
  stream.Finish();
  return pose;
}

RosPose ReadPoseStamped(MessageStream& stream) {
  const RosHeader header = ReadHeader(stream);
  RosPose pose{header.stamp_ns, header.frame_id, "", ReadPose(stream, "pose.position", "pose.orientation")};
  stream.Finish();
  return pose;
}

Pose CheckedPose(const RosPose& pose, const std::string& where) {
  const Eigen::Quaterniond& written = pose.parent_from_child.rotation;
  const auto rotation = UnitQuaternion(written);
  if (!rotation) throw DataError("{}: a quaternion of length {:g}, expected 1", where, written.norm());
  const Eigen::Vector3d& position_m = pose.parent_from_child.position_m;
  if (!position_m.allFinite()) {
    throw DataError("{}: position ({:g}, {:g}, {:g}), expected finite numbers", where, position_m.x(),
                    position_m.y(), position_m.z());
  }
  return {*rotation, position_m};
}

std::vector<RosPose> ReadTransforms(MessageStream& stream) {
  constexpr std::uint64_t kMinBytes = 7 * sizeof(double);
  std::vector<RosPose> transforms(stream.Count("transforms", kMinBytes));
  for (RosPose& transform : transforms) {
    const RosHeader header = ReadHeader(stream);
    transform = {header.stamp_ns, header.frame_id, stream.String("child_frame_id"), {}};
    transform.parent_from_child = ReadPose(stream, "transforms.translation", "transforms.rotation");
  }
  stream.Finish();
  return transforms;
}

}  // namespace sonarcal::data_io
