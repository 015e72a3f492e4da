// Writes recordings as bags of ROS 1, format 2.0. Uses librosbag and stores the message definitions, so
// `rosbag info`, `rosbag play` and rqt_bag know the content.
//
//   /sonar/image  marine_acoustic_msgs/ProjectedSonarImage, one message per frame, samples beam by beam
//   /sonar/pose   geometry_msgs/PoseStamped, world_from_sonar of each frame that has one; sonar axes as in
//                 core/types/pose.h (X right, Y forward, Z up), its frame "sonar", the world's "map"
//
// Beams have Z forward and X up, as the message's definition requires; ranges are centres of bins. Grey
// values have 8 or 16 bits, linear power is float. Not contained in such a message: water, dB scale, gain,
// and a full scale that differs from that of the bits.
#pragma once

#include <filesystem>
#include <functional>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Writes `file`, which must not exist, frame by frame. Frames without a time have a stamp of 0 and are logged
// one second after the previous frame. Time 0, which means "no time" in ROS, becomes 1 ns. Throws DataError
// if the recording's values are neither grey nor power, a time is outside the range of ROS (0 .. 2^32 s), two
// frames have one time but different poses, or the file cannot be written.
void WriteRos1Bag(const RecordingSource& recording, const std::filesystem::path& file,
                  const std::function<void(int frames_done)>& progress = {});

}  // namespace sonarcal::data_io
