// Poses of a sonar over time, from a file of poses or from a recording.
//
//   {"format": "sonar-poses/1",
//    "poses": [{"time_s": 0.0,
//               "world_from_sonar": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}}]}
//
// or the list alone. `time_s` may be absent. All functions throw DataError with file, line and key.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/types/pose.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

struct TimedPose {
  std::optional<double> time_s;
  Pose world_from_sonar;
};

// At least one pose. Rejects unknown keys.
std::vector<TimedPose> ReadPoses(const std::filesystem::path& file);

// Pose of every frame. Rejects a recording with a frame that has no pose, because omitting one would shift
// all following poses.
std::vector<TimedPose> PosesOfRecording(const RecordingSource& recording);

// Reads a recording of any format that contains poses, or a file of poses, whose name ends in .json.
std::vector<TimedPose> ReadPosesOrRecording(const std::filesystem::path& path);

// Writes the whole file or nothing.
void WritePoses(const std::filesystem::path& file, const std::vector<TimedPose>& poses);

}  // namespace sonarcal::data_io
