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

// Largest error of a sight of the target. A sight with a larger error shows another object.
struct SightTolerance {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
};

struct TargetPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // world
  // Mirror image of the position in the image plane, if the sights agree with it as well: a sonar that stays
  // in its image plane does not see on which side the target is. Elevations then have the right size only.
  std::optional<Eigen::Vector3d> mirror_m = {};
  double range_error_m = 0.0;              // RMS of the sights that agree
  double azimuth_error_rad = 0.0;          // likewise
  std::vector<double> elevation_rad = {};  // of each sight
  std::vector<bool> agrees = {};           // of each sight: within the tolerance
};

struct TargetLocation {
  std::optional<TargetPosition> position = {};
  std::string why_not = {};  // if there is no position
};

// Finds the position that most sights agree with, by least squares among these. There is none in two cases:
//
// - Fewer than three sights agree, or less than half of them.
// - The poses do not determine it: the standard error of an elevation would exceed a degree, or the mirror
//   image agrees as well and has elevations of another size. Errors are taken as those that remain, and as at
//   least a tenth of the tolerance.
TargetLocation LocateTarget(const std::vector<TargetSight>& sights, const SightTolerance& tolerance);

}  // namespace sonarcal::calib
