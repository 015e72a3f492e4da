// Writes recordings as bags of ROS 1, format 2.0. They contain the message definitions, so that
// `rosbag info`, `rosbag play` and rqt_bag know the content.
// The messages are those of data_io/bag_writers/recording_messages.h. Not contained in them: water, dB scale,
// gain, and a full scale that differs from that of the bits.
#pragma once

#include <filesystem>
#include <functional>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Writes `file`, which must not exist, frame by frame. Throws DataError if SampleTypeOf
// (data_io/bag_writers/recording_messages.h) refuses the scale of a frame, a time is outside the range of ROS
// (0 .. 2^32 s), two frames have one time but different poses, or the file cannot be written.
void WriteRos1Bag(const RecordingSource& recording, const std::filesystem::path& file,
                  const std::function<void(int frames_done)>& progress = {});

}  // namespace sonarcal::data_io
