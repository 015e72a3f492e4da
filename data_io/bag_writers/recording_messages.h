// Frames of a recording as messages of ROS 1 and ROS 2:
//
//   kImageTopic  marine_acoustic_msgs/ProjectedSonarImage, one message per frame, samples beam by beam
//   kPoseTopic   geometry_msgs/PoseStamped, world_from_sonar of each frame that has one; sonar axes as in
//                core/types/pose.h (X right, Y forward, Z up), its frame kSonarFrame, the world's kWorldFrame
//
// Beams have Z forward and X up, as the message's definition requires; ranges are centres of bins. Grey
// values have 8 or 16 bits, linear power is float.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types/recording.h"
#include "data_io/ros/message_stream.h"

namespace sonarcal::data_io {

inline constexpr const char* kImageTopic = "/sonar/image";
inline constexpr const char* kPoseTopic = "/sonar/pose";
inline constexpr const char* kSonarFrame = "sonar";
inline constexpr const char* kWorldFrame = "map";

struct FrameTimes {
  std::int64_t stamp_ns = 0;  // time in the headers of its messages; 0 without a time
  // time in the bag, by which readers order messages, and the time of those without a stamp
  std::int64_t logged_ns = 0;
};

// Times of all frames. Frames without a time have a stamp of 0. They are logged one second apart after the
// previous frame, or closer together so that they lie before the next frame with a time. Time 0, which means
// "no time" in ROS, becomes 1 ns. Readers find the pose of an image by its time.
// Throws DataError if two frames have one time but different poses, or a time is outside 0 .. `max_s`.
std::vector<FrameTimes> FrameTimesOf(const RecordingSource& recording, double max_s);

// Throws DataError if SampleTypeOf does.
std::string ImageMessage(MessageEncoding encoding, const Frame& frame, const SonarModel& sonar,
                         std::uint32_t sequence, std::int64_t stamp_ns);

std::string PoseMessage(MessageEncoding encoding, const Pose& world_from_sonar, std::uint32_t sequence,
                        std::int64_t stamp_ns);

// Type of the samples of an image: u8 or u16 for grey, f32 for power. Throws DataError for other quantities,
// and for grey unless its full scale is a whole number from 2 to 65535.
enum class SampleType : std::uint32_t { kByte = 0, kShort = 2, kFloat = 8 };
SampleType SampleTypeOf(const ImageScale& scale);

// Bytes of one sample, little-endian. Grey values are rounded.
void AppendSample(std::string& bytes, SampleType type, float value);

}  // namespace sonarcal::data_io
