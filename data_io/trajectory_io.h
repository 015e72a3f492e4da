// Trajectory of a body, as written by trackers, gantries and SLAM, and the pose of a sonar on that body at
// the time of a frame.
//
//   tum    Lines "time tx ty tz qx qy qz qw", in seconds and metres, separated by blanks.
//   euroc  Lines "time, px, py, pz, qw, qx, qy, qz, ...", time in integer NANOseconds; further columns are
//          ignored.
//   csv    A first line with the column names, in any order: time_s, x_m, y_m, z_m, and either qw, qx, qy, qz
//          or yaw_deg, pitch_deg, roll_deg (axes and signs of core/types/pose.h); others are ignored.
//
// Lines that begin with '#' are comments, except the first of a csv. All poses are world_from_body; the world
// has Z up. Times must increase strictly, every number must be finite, and quaternions must be within 1e-3 of
// unit length; otherwise DataError with file and line. Times are stored as double seconds: accurate to 0.3
// microseconds for times since 1970.
//
// A mount gives the pose of the sonar on the body:
//
//   {"format": "sonar-mount/1",
//    "body_from_sonar": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}}
//
// The sonar's own axes are X right, Y forward, Z up. On a body whose X points forward and Y to the left, a
// sonar that looks forward has the quaternion [0.7071068, 0, 0, -0.7071068].
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/pose.h"
#include "core/types/words.h"

namespace sonarcal::data_io {

// Columns of each format, in words.
inline constexpr std::string_view kTrajectoryColumns =
    "csv: the first line names time_s, x_m, y_m, z_m and either qw, qx, qy, qz or yaw_deg, pitch_deg, "
    "roll_deg; "
    "tum: time in s, x, y, z, qx, qy, qz, qw, separated by blanks; "
    "euroc: time in ns, x, y, z, qw, qx, qy, qz, separated by commas";

enum class TrajectoryFormat { kTum, kEuroc, kCsv };
constexpr auto WordsOf(std::type_identity<TrajectoryFormat>) {
  return Words<TrajectoryFormat, 3>{{{"tum", TrajectoryFormat::kTum},
                                     {"euroc", TrajectoryFormat::kEuroc},
                                     {"csv", TrajectoryFormat::kCsv}}};
}

// Detects the format from the first lines. Throws DataError if they match no format.
TrajectoryFormat GuessTrajectoryFormat(const std::filesystem::path& file);

struct TrajectoryPose {
  double time_s = 0.0;
  Pose world_from_body;
};

// At least one pose, in ascending order of time.
std::vector<TrajectoryPose> ReadTrajectory(const std::filesystem::path& file, TrajectoryFormat format);

// Interpolates between the two poses around a time: position on the straight line, rotation by the shortest
// turn. Returns nothing before the first pose, after the last, or between two that are more than `most_gap_s`
// apart.
std::optional<Pose> PoseAt(const std::vector<TrajectoryPose>& trajectory, double time_s, double most_gap_s);

// body_from_sonar. Throws DataError with file, line and key.
Pose ReadMount(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
