#include "data_io/bag_writers/ros1_bag_writer.h"

#include <cstdint>
#include <optional>
#include <vector>

#include "data_io/bag_writers/recording_messages.h"
#include "data_io/bag_writers/ros1_bag_file.h"
#include "data_io/bag_writers/ros1_message_text.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {
namespace {

constexpr double kMaxRos1S = 4294967295.0;  // largest time of ROS 1

Ros1Connection ImageConnection() {
  return {kImageTopic, kProjectedSonarImageType, kProjectedSonarImageMd5, kProjectedSonarImageText};
}

Ros1Connection PoseConnection() {
  return {kPoseTopic, kPoseStampedType, kPoseStampedMd5, kPoseStampedText};
}

}  // namespace

void WriteRos1Bag(const RecordingSource& recording, const std::filesystem::path& file,
                  const std::function<void(int frames_done)>& progress) {
  const std::vector<FrameTimes> times = FrameTimesOf(recording, kMaxRos1S);
  Ros1BagFile bag(file);
  const std::uint32_t images = bag.AddConnection(ImageConnection());
  std::optional<std::uint32_t> poses;  // once a frame has one
  for (int i = 0; i < recording.frame_count(); ++i) {
    const Frame frame = recording.ReadFrame(i);
    const FrameTimes& at = times[static_cast<std::size_t>(i)];
    const auto sequence = static_cast<std::uint32_t>(i);
    bag.Write(images, at.logged_ns,
              ImageMessage(MessageEncoding::kRos1, frame, recording.info().sonar, sequence, at.stamp_ns));
    if (frame.info.world_from_sonar) {
      if (!poses) poses = bag.AddConnection(PoseConnection());
      bag.Write(*poses, at.logged_ns,
                PoseMessage(MessageEncoding::kRos1, *frame.info.world_from_sonar, sequence, at.stamp_ns));
    }
    if (progress) progress(i + 1);
  }
  bag.Close();
}

}  // namespace sonarcal::data_io
