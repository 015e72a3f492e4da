// Place of a fixed point target in the world, from its range and azimuth in frames of different pose.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/types/pose.h"

namespace sonarcal::calib {

struct TargetSight {
  Pose world_from_sonar;
  double range_m = 0.0;
  double azimuth_rad = 0.0;
};

// How far a sight may lie from what a target that stands still shows. Larger errors are those of another
// object.
struct SightTolerance {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
};

struct TargetPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // world
  double range_error_m = 0.0;                            // RMS of the sights that agree
  double azimuth_error_rad = 0.0;                        // likewise
  std::vector<double> elevation_rad = {};                // of each sight
  std::vector<bool> agrees = {};                         // of each sight: within the tolerance
};

struct TargetLocation {
  std::optional<TargetPosition> position = {};
  std::string why_not = {};  // if there is no position
};

// The position that most sights agree with, by least squares among these. Not found if fewer than three
// sights or less than half of them agree, or if the poses leave the position open: the standard error of an
// elevation would exceed a degree. The standard error is that of the errors left, and of at least a tenth of
// the tolerance.
TargetLocation LocateTarget(const std::vector<TargetSight>& sights, const SightTolerance& tolerance);

}  // namespace sonarcal::calib
