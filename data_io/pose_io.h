// Poses of a sonar over time, from a file of poses or from a recording.
//
//   {"format": "sonar-poses/1",
//    "poses": [{"time_s": 0.0,
//               "world_from_sonar": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}}]}
//
// or the list alone. `time_s` may be absent. A pose may state the motion of the sonar, as in a recording:
//
//   "motion": {"velocity_m_per_s": [x, y, z], "turn_rate_deg_per_s": [x, y, z]}
//
// A pose that `sonarcal locate` found also states:
//
//   "frame": 3, "open": ["..."],
//   "candidates": [{"what": "best", "world_from_sonar", "rms_difference", "gain_db", "worse_by_nats",
//                   "worse_by_sigmas", "explains_as_well": true}]
//
// All functions throw DataError with file, line and key.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/types/pose.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

// Pose that a search considered, with its agreement with the image (calib/poses/pose_search.h).
struct PoseFound {
  std::string what;  // "best", "the reversed target"
  Pose world_from_sonar;
  double rms_difference = 0.0;  // of smoothed images, full scale 1
  double gain_db = 0.0;
  double worse_by_nats = 0.0;
  double worse_by_sigmas = 0.0;
  bool explains_as_well = true;
};

struct TimedPose {
  std::optional<double> time_s;
  Pose world_from_sonar;
  std::optional<Motion> motion = {};  // of the sonar during the frame
  // Only of poses that a search found.
  std::optional<int> frame = {};           // number of the frame in the recording that was searched
  std::vector<PoseFound> candidates = {};  // best first
  std::vector<std::string> open = {};      // properties that the image does not determine
};

// At least one pose. Rejects unknown keys.
std::vector<TimedPose> ReadPoses(const std::filesystem::path& file);

// The poses with the motion of the sonar during each frame, as WithMotion finds it for these pings.
//
// A pose that states a motion keeps it. Otherwise the motion is the constant one from the pose before to the
// pose after, or between the pose and its only neighbour. It is unknown if a time is absent, if times do not
// increase, or if neighbours are more than kMaxMotionGapS apart. Does nothing for frames of one ping.
inline constexpr double kMaxMotionGapS = 1.0;
std::vector<TimedPose> WithMotion(std::vector<TimedPose> poses, const PingPattern& pings);

// Pose of every frame, with its motion (WithMotion). Rejects a recording with a frame that has no pose,
// because omitting one would shift all following poses.
std::vector<TimedPose> PosesOfRecording(const RecordingSource& recording);

// Without times and motion.
std::vector<Pose> PosesAlone(const std::vector<TimedPose>& poses);

// Reads a recording of any format that contains poses, or a file of poses, whose name ends in .json.
std::vector<TimedPose> ReadPosesOrRecording(const std::filesystem::path& path);

// The recording with these poses, one per frame, in place of its own. Throws DataError, naming `source`, if
// their number differs from that of the frames.
std::unique_ptr<RecordingSource> WithPoses(std::shared_ptr<const RecordingSource> recording,
                                           const std::vector<TimedPose>& poses,
                                           const std::filesystem::path& source);

// Text of a file of poses.
std::string PosesText(const std::vector<TimedPose>& poses);

// Writes the whole file or nothing.
void WritePoses(const std::filesystem::path& file, const std::vector<TimedPose>& poses);

}  // namespace sonarcal::data_io
