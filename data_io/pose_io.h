// Poses of a sonar over time, from a file of poses or from a recording.
//
//   {"format": "sonar-poses/1",
//    "poses": [{"time_s": 0.0, "world_from_sonar": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y,
//    z]}}]}
//
// or the list alone. `time_s` may be absent. Everything throws DataError with file, line and key.
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

// At least one pose. Unknown keys are refused.
std::vector<TimedPose> ReadPoses(const std::filesystem::path& file);

// The pose of every frame; refuses a recording of which a frame has none, for a pose left out would shift all
// that follow.
std::vector<TimedPose> PosesOfRecording(const RecordingSource& recording);

// Of a recording of any format that has them, or of a file of poses, whose name ends in .json.
std::vector<TimedPose> ReadPosesOrRecording(const std::filesystem::path& path);

// Whole or not at all.
void WritePoses(const std::filesystem::path& file, const std::vector<TimedPose>& poses);

}  // namespace sonarcal::data_io
