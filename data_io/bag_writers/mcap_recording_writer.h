// Writes recordings as MCAP files of ROS 2 messages, with the definitions of all messages. Foxglove, rosbag2
// and sonarcal read them.
//
//   /sonar/image          marine_acoustic_msgs/ProjectedSonarImage (data_io/bag_writers/recording_messages.h)
//   /sonar/polar          sensor_msgs/Image: the samples, far ranges at the top, one column per beam
//   /sonar/fan            sensor_msgs/Image: the fan, 8 bits of grey; only of grey recordings
//   /sonar/pose           geometry_msgs/PoseStamped
//   /tf                   tf2_msgs/TFMessage: the same pose
//   /sonar/field_of_view  visualization_msgs/MarkerArray: outline of the fan, in the frame of the sonar
//   /sonar/sonar_info     marine_interfaces/SonarInfo (data_io/bag_writers/sonar_info_message.h): with the
//                         first frame, with each change of the settings, and every 10 s
//   /scene                visualization_msgs/MarkerArray: triangles of a scene, one marker per material
//
// The record of metadata "recording" holds what the messages do not: recording.json without its frames.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/types/recording.h"
#include "core/types/scene.h"
#include "data_io/bag_writers/sonar_info_message.h"

namespace sonarcal::data_io {

// Largest scene that is written, so that the message stays within kMaxBagMessageBytes.
inline constexpr std::size_t kMaxMcapSceneTriangles = 2'000'000;

struct McapRecordingOptions {
  const Scene* scene = nullptr;  // written if given
  int fan_height_px = 0;         // height of the fan pictures; 0: one pixel per range bin, at most 800
  std::optional<SonarCalibration> calibration = {};  // written into SonarInfo
};

// Writes `file`, which must not exist, frame by frame. `library` names the writing program. Throws DataError
// if SampleTypeOf (data_io/bag_writers/recording_messages.h) refuses the scale, a time is outside the range
// of ROS 2 (0 .. 2^31 s), two frames have one time but different poses, axes or scale differ between frames,
// the scene has too many triangles, or the file cannot be written.
void WriteMcapRecording(const RecordingSource& recording, const McapRecordingOptions& options,
                        const std::string& library, const std::filesystem::path& file,
                        const std::function<void(int frames_done)>& progress = {});

}  // namespace sonarcal::data_io
