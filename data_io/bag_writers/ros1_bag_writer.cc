#include "data_io/bag_writers/ros1_bag_writer.h"

#include <rosbag/bag.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/types/error.h"
#include "data_io/bag_writers/recording_messages.h"
#include "data_io/bag_writers/ros1_message_text.h"
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

constexpr double kMaxS = 4294967295.0;  // largest time of ROS 1

ros::Time RosTime(std::int64_t time_ns) {
  return {static_cast<std::uint32_t>(time_ns / kNsPerS), static_cast<std::uint32_t>(time_ns % kNsPerS)};
}

}  // namespace

void WriteRos1Bag(const RecordingSource& recording, const std::filesystem::path& file,
                  const std::function<void(int frames_done)>& progress) {
  try {
    const std::vector<FrameTimes> times = FrameTimesOf(recording, kMaxS);
    rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    for (int i = 0; i < recording.frame_count(); ++i) {
      const Frame frame = recording.ReadFrame(i);
      const FrameTimes& at = times[static_cast<std::size_t>(i)];
      const auto sequence = static_cast<std::uint32_t>(i);
      const auto write = [&](const char* topic, const char* type, const char* md5, const char* definition,
                             std::string bytes) {
        bag.write(topic, RosTime(at.logged_ns), Ros1Message{type, md5, definition, std::move(bytes)});
      };
      write(kImageTopic, kProjectedSonarImageType, kProjectedSonarImageMd5, kProjectedSonarImageText,
            ImageMessage(MessageEncoding::kRos1, frame, recording.info().sonar, sequence, at.stamp_ns));
      if (frame.info.world_from_sonar) {
        write(kPoseTopic, kPoseStampedType, kPoseStampedMd5, kPoseStampedText,
              PoseMessage(MessageEncoding::kRos1, *frame.info.world_from_sonar, sequence, at.stamp_ns));
      }
      if (progress) progress(i + 1);
    }
    bag.close();
  } catch (const rosbag::BagException& error) {
    throw DataError("{}: cannot be written: {}", file.string(), error.what());
  }
}

}  // namespace sonarcal::data_io
