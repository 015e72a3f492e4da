// Where a body was over time, as trackers, gantries and SLAM write it, and from it where a sonar on that body
// was when a frame was taken.
//
//   tum     lines "time tx ty tz qx qy qz qw", seconds and metres, apart by blanks
//   euroc   lines "time, px, py, pz, qw, qx, qy, qz, ...", time in whole NANOseconds; what follows is passed
//   over csv     a first line that names the columns, in any order: time_s, x_m, y_m, z_m, and either qw, qx,
//   qy,
//           qz or yaw_deg, pitch_deg, roll_deg (axes and signs of types/pose.h); others are passed over
//
// Lines that begin with '#' are comments, but for a csv's first. All are world_from_body: the world has Z up.
// Times increase strictly, every number is finite, quaternions are within 1e-3 of unit length: else DataError
// with file and line. Times are held as double seconds: to 0.3 microseconds for those since 1970.
//
// A mount says how the sonar sits on the body:
//
//   {"format": "sonar-mount/1",
//    "body_from_sonar": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}}
//
// The sonar's own axes are X right, Y ahead, Z up. On a body whose X points ahead and Y to the left, a sonar
// that looks ahead has the quaternion [0.7071068, 0, 0, -0.7071068].
#pragma once

#include <filesystem>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/types/pose.h"
#include "core/types/words.h"

namespace sonarcal::data_io {

enum class TrajectoryFormat { kTum, kEuroc, kCsv };
constexpr auto WordsOf(std::type_identity<TrajectoryFormat>) {
  return Words<TrajectoryFormat, 3>{{{"tum", TrajectoryFormat::kTum},
                                     {"euroc", TrajectoryFormat::kEuroc},
                                     {"csv", TrajectoryFormat::kCsv}}};
}

// What the first lines look like. Throws DataError where they are none of these.
TrajectoryFormat GuessTrajectoryFormat(const std::filesystem::path& file);

struct TrajectoryPose {
  double time_s = 0.0;
  Pose world_from_body;
};

// At least one pose, by increasing time.
std::vector<TrajectoryPose> ReadTrajectory(const std::filesystem::path& file, TrajectoryFormat format);

// Between the two poses around a time: position along the straight line, rotation along the shortest turn.
// Nothing before the first, after the last, and between two that are more than `most_gap_s` apart.
std::optional<Pose> PoseAt(const std::vector<TrajectoryPose>& trajectory, double time_s, double most_gap_s);

// body_from_sonar. Throws DataError with file, line and key.
Pose ReadMount(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
