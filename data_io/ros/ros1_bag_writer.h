// Recordings as bags of ROS 1, format 2.0, for users of ROS: written by librosbag, with the messages' own
// definitions in them, so that `rosbag info`, `rosbag play` and rqt_bag know what they hold.
//
//   /sonar/image  marine_acoustic_msgs/ProjectedSonarImage, a message a frame, samples beam by beam
//   /sonar/pose   geometry_msgs/PoseStamped, world_from_sonar of each frame that has one; the sonar's axes
//   are
//                 ours (X right, Y ahead, Z up), its frame "sonar", the world's "map"
//
// Beams have Z ahead and X up, as the message's definition says; ranges are centres of bins. Grey values are
// 8 or 16 bits, linear power is float. Not in such a message: water, dB scale, gain, a full scale other than
// that of the bits.
#pragma once

#include <filesystem>
#include <functional>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Writes `file`, which must not be there, frame by frame. Frames without a time have a stamp of 0 and are
// logged a second after the frame before. Time 0, which means "no time" in ROS, becomes 1 ns. Throws
// DataError where the recording's values are neither grey nor power, a time is none of ROS (0 .. 2^32 s), two
// frames have the same time but different poses, or the file cannot be written.
void WriteRos1Bag(const RecordingSource& recording, const std::filesystem::path& file,
                  const std::function<void(int frames_done)>& progress = {});

}  // namespace sonarcal::data_io
