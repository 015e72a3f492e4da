// Joint refinement behind marker_poses.h: all frames, and on request markers and focal length, by Ceres.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/markers/marker_corners.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"

namespace sonarcal::calib {

struct AdjustedFrame {
  std::vector<MarkerObservation> seen;
  Pose world_from_camera;
  // Position in world axes, rotation about the axes of the camera (marker_poses.h).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

struct Adjustment {
  std::vector<AdjustedFrame> frames;
  MarkerMap map;
  double noise_factor2 = 1.0;
  double degrees_of_freedom = 0.0;
  double focal_scale = 1.0;
  double focal_scale_sigma = 0.0;
};

// Needs start poses near the solution; `noise_factor2` is a first guess. Throws DataError if the frames do
// not determine the free parameters.
Adjustment Adjust(std::vector<AdjustedFrame> frames, const MarkerMap& map, const Camera& camera,
                  const FlatPort* port, bool refine_focal, double noise_factor2);

}  // namespace sonarcal::calib
