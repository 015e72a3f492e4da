// Place of a fixed point target in the world, from its range and azimuth in frames of different pose.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/types/pose.h"

namespace sonarcal::calib {

struct TargetSight {
  Pose world_from_sonar;
  double range_m = 0.0;
  double azimuth_rad = 0.0;
};

struct TargetPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // world
  double range_error_m = 0.0;                            // RMS of recorded minus predicted
  double azimuth_error_rad = 0.0;                        // likewise
  std::vector<double> elevation_rad = {};                // of each sight
};

// Least squares, starting from both sides of the image plane. Errors weigh as a thousandth of the range and
// as a milliradian. Absent if there are fewer than three sights, or if the poses leave the position open: the
// standard error of an elevation would exceed a degree.
std::optional<TargetPosition> LocateTarget(const std::vector<TargetSight>& sights);

}  // namespace sonarcal::calib
