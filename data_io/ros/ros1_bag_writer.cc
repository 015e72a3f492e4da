#include "data_io/ros/ros1_bag_writer.h"

#include <fmt/format.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/ros/ros1_message_text.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {

// Message as stored in a bag. librosbag accesses its parts by traits.
struct Ros1Message {
  const char* type = nullptr;
  const char* md5 = nullptr;
  const char* definition = nullptr;
  std::string bytes;
};

}  // namespace sonarcal::data_io

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<sonarcal::data_io::Ros1Message> {
  static const char* value(const sonarcal::data_io::Ros1Message& message) { return message.md5; }
};
template <>
struct DataType<sonarcal::data_io::Ros1Message> {
  static const char* value(const sonarcal::data_io::Ros1Message& message) { return message.type; }
};
template <>
struct Definition<sonarcal::data_io::Ros1Message> {
  static const char* value(const sonarcal::data_io::Ros1Message& message) { return message.definition; }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<sonarcal::data_io::Ros1Message> {
  template <typename Stream>
  static void write(Stream& stream, const sonarcal::data_io::Ros1Message& message) {
    std::memcpy(stream.advance(static_cast<std::uint32_t>(message.bytes.size())), message.bytes.data(),
                message.bytes.size());
  }
  static std::uint32_t serializedLength(const sonarcal::data_io::Ros1Message& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros

namespace sonarcal::data_io {
namespace {

constexpr const char* kImageTopic = "/sonar/image";
constexpr const char* kPoseTopic = "/sonar/pose";

// Serialises fields in sequence, little-endian, as in ROS 1.
class Fields {
 public:
  template <typename T>
  Fields& Number(T value) {
    if constexpr (std::endian::native == std::endian::big) {
      for (std::size_t i = sizeof(T); i > 0; --i) bytes_ += reinterpret_cast<const char*>(&value)[i - 1];
    } else {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    }
    return *this;
  }
  Fields& Count(std::size_t count) {
    if (count > std::numeric_limits<std::uint32_t>::max())
      throw DataError("a message of {} entries is too long for ROS", count);
    return Number(static_cast<std::uint32_t>(count));
  }
  Fields& Text(const std::string& text) {
    Count(text.size());
    bytes_ += text;
    return *this;
  }
  Fields& Header(std::uint32_t sequence, const ros::Time& stamp, const std::string& frame) {
    return Number(sequence).Number(stamp.sec).Number(stamp.nsec).Text(frame);
  }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

enum class SampleType : std::uint32_t { kByte = 0, kShort = 2, kFloat = 8 };

SampleType SampleTypeOf(const ImageScale& scale) {
  if (scale.quantity == Quantity::kPower) return SampleType::kFloat;
  if (scale.quantity != Quantity::kGrey) {
    throw DataError(
        "the recording's values are {}, expected grey or power: a ProjectedSonarImage says not "
        "what its numbers are",
        ToString(scale.quantity));
  }
  return scale.full_scale > 255.0 ? SampleType::kShort : SampleType::kByte;
}

std::string Samples(const PolarImage& image) {
  const SampleType type = SampleTypeOf(image.scale);
  Fields samples;
  for (int beam = 0; beam < image.value.cols(); ++beam) {
    for (int bin = 0; bin < image.value.rows(); ++bin) {
      const float value = image.value(bin, beam);
      switch (type) {
        case SampleType::kByte:
          samples.Number(static_cast<std::uint8_t>(std::lround(value)));
          break;
        case SampleType::kShort:
          samples.Number(static_cast<std::uint16_t>(std::lround(value)));
          break;
        case SampleType::kFloat:
          samples.Number(value);
      }
    }
  }
  return samples.Take();
}

void AddWidth(Fields& fields, double width_deg) {
  fields.Count(width_deg > 0.0 ? 1 : 0);
  if (width_deg > 0.0) fields.Number(static_cast<float>(RadFromDeg(width_deg)));
}

std::string ImageMessage(const Frame& frame, const SonarModel& sonar, std::uint32_t sequence,
                         const ros::Time& stamp) {
  const PolarAxes& axes = frame.image.axes;
  Fields fields;
  fields.Header(sequence, stamp, "sonar");
  fields.Number(static_cast<float>(sonar.frequency_hz));
  fields.Number(static_cast<float>(sonar.sound_speed_m_per_s));
  AddWidth(fields, sonar.elevation_beam_width_deg);  // one fan is transmitted
  AddWidth(fields, sonar.azimuth_beam_width_deg);
  fields.Count(axes.beam_azimuth_rad.size());
  for (const double azimuth_rad : axes.beam_azimuth_rad) {
    fields.Number(0.0).Number(std::sin(azimuth_rad)).Number(std::cos(azimuth_rad));
  }
  fields.Count(static_cast<std::size_t>(axes.range_bins));
  for (int bin = 0; bin < axes.range_bins; ++bin) fields.Number(static_cast<float>(axes.range_centre_m(bin)));
  fields.Number(std::uint8_t{0});
  fields.Number(static_cast<std::uint32_t>(SampleTypeOf(frame.image.scale)));
  fields.Count(axes.beam_azimuth_rad.size());
  fields.Text(Samples(frame.image));
  return fields.Take();
}

std::string PoseMessage(const Pose& world_from_sonar, std::uint32_t sequence, const ros::Time& stamp) {
  Fields fields;
  fields.Header(sequence, stamp, "map");
  for (int axis = 0; axis < 3; ++axis) fields.Number(double{world_from_sonar.position_m[axis]});
  const Eigen::Quaterniond& q = world_from_sonar.rotation;
  fields.Number(q.x()).Number(q.y()).Number(q.z()).Number(q.w());
  return fields.Take();
}

// Time of a frame, or 0, which means "no time" in ROS. Time 0 becomes the first nanosecond.
ros::Time StampOf(const FrameInfo& info) {
  if (!info.time_s) return {};
  const double time_s = *info.time_s;
  constexpr double kMaxS = 4294967295.0;
  if (!(time_s >= 0.0 && time_s < kMaxS))
    throw DataError("{}: time_s is {:g}, expected 0 .. 2^32 for ROS", info.name, time_s);
  const double whole_s = std::floor(time_s);
  auto seconds = static_cast<std::uint32_t>(whole_s);
  auto nanoseconds = static_cast<std::uint32_t>(std::llround((time_s - whole_s) * 1e9));
  if (nanoseconds == kNsPerS) {
    ++seconds;
    nanoseconds = 0;
  }
  return std::max(ros::Time(seconds, nanoseconds), ros::TIME_MIN);
}

struct FrameTimes {
  ros::Time stamp;  // time in the headers of its messages; 0 without a time
  // time in the bag, by which readers order messages, and the time of those without a stamp
  ros::Time logged;
};

// Readers find the pose of an image by its time, so no two poses may have the same time.
std::vector<FrameTimes> TimesOf(const RecordingSource& recording) {
  std::vector<FrameTimes> times;
  std::map<ros::Time, int> posed;
  ros::Time logged;
  for (int i = 0; i < recording.frame_count(); ++i) {
    const FrameInfo info = recording.frame_info(i);
    const ros::Time stamp = StampOf(info);
    logged = stamp.isZero() ? logged + ros::Duration(1.0) : stamp;
    times.push_back({stamp, logged});
    if (!info.world_from_sonar) continue;
    const auto [other, is_new] = posed.emplace(logged, i);
    if (is_new) continue;
    const Pose first = *recording.frame_info(other->second).world_from_sonar;
    const Pose& second = *info.world_from_sonar;
    if (first.position_m != second.position_m || first.rotation.coeffs() != second.rotation.coeffs()) {
      throw DataError(
          "{}: frames {} and {} have the same time, {:.9f} s, but different poses, expected different times: "
          "readers of a bag find the pose of a frame by its time",
          recording.info().source, other->second, i, logged.toSec());
    }
  }
  return times;
}

}  // namespace

void WriteRos1Bag(const RecordingSource& recording, const std::filesystem::path& file,
                  const std::function<void(int frames_done)>& progress) {
  try {
    const std::vector<FrameTimes> times = TimesOf(recording);
    rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    for (int i = 0; i < recording.frame_count(); ++i) {
      const Frame frame = recording.ReadFrame(i);
      const auto& [stamp, logged] = times[static_cast<std::size_t>(i)];
      const auto sequence = static_cast<std::uint32_t>(i);
      const auto write = [&](const char* topic, const char* type, const char* md5, const char* definition,
                             std::string bytes) {
        bag.write(topic, logged, Ros1Message{type, md5, definition, std::move(bytes)});
      };
      write(kImageTopic, kProjectedSonarImageType, kProjectedSonarImageMd5, kProjectedSonarImageText,
            ImageMessage(frame, recording.info().sonar, sequence, stamp));
      if (frame.info.world_from_sonar) {
        write(kPoseTopic, kPoseStampedType, kPoseStampedMd5, kPoseStampedText,
              PoseMessage(*frame.info.world_from_sonar, sequence, stamp));
      }
      if (progress) progress(i + 1);
    }
    bag.close();
  } catch (const rosbag::BagException& error) {
    throw DataError("{}: cannot be written: {}", file.string(), error.what());
  }
}

}  // namespace sonarcal::data_io
