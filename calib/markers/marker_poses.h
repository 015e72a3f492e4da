// Where a sonar was, from pictures that a camera beside it took of markers (Park 2024, Section 6).
//
// Each frame starts from marker_start.h; a marker that the others contradict is left out; then Ceres refines
// all frames together, with Huber's loss on each marker's eight numbers, and, where the map says how far
// markers may be off, the markers with that as their prior, and on request the focal length.
//
// Noise: a marker's corners are whitened by their own covariance C (marker_corners.h), which is right up to a
// factor s^2 common to all. s^2 is found so that the sum of weight |r|^2 / s^2 over all markers is the number
// of degrees of freedom: 8 a marker, less 6 a frame, less the focal length, less what the priors' own
// residuals took. Whatever else the model has wrong (an inexact map taken for exact, lens, port) raises s and
// so the covariance, but as if it were new for every marker and frame.
//
// Covariance: the inverse of the information of all parameters, other frames, map and focal length included.
// Six by six of (x, y, z: position error in the world's axes, metres; a, b, c: rotation error about the axes
// of camera or sonar, radians): true = (position + (x, y, z), rotation * Exp(a, b, c)). The mount's sigma is
// added to the sonar's; it is one and the same error in all frames, as are those of map, focal length and
// port.
//
// Throws DataError where the frames do not determine what is free. Same input, same output, to the bit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/markers/marker_corners.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"
#include "core/types/pose.h"

namespace sonarcal::calib {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct MarkerPoseOptions {
  double most_rms_px = 2.0;  // a frame with more is refused
  bool refine_focal = false;
  // Two poses whose log-likelihoods differ by less are both named.
  double ambiguous_nats = 8.0;
};

struct MarkerResidual {
  int id = 0;
  double rms_px = 0.0;  // of the distances of its four corners
  bool left_out = false;
  MarkerObservation observation;
  std::array<Eigen::Vector2d, 4> projected_px;
};

struct OtherMarkerPose {
  Pose world_from_sonar;
  double nats = 0.0;  // by which the one that was kept is more likely
};

struct MarkerFramePose {
  std::string refused;  // why there is no pose; empty: there is one
  Pose world_from_camera;
  Pose world_from_sonar;
  Matrix6d camera_covariance = Matrix6d::Zero();
  Matrix6d sonar_covariance = Matrix6d::Zero();
  double rms_px = 0.0;  // of the distances of all corners that count
  std::vector<MarkerResidual> markers;
  std::optional<OtherMarkerPose> other;
};

struct MarkerPoses {
  std::vector<MarkerFramePose> frames;  // as given
  double noise_factor = 0.0;            // s
  double degrees_of_freedom = 0.0;
  double rms_px = 0.0;  // of all frames with a pose
  double focal_scale = 1.0;
  double focal_scale_sigma = 0.0;  // 0 where it is held
  MarkerMap map;                   // refined where it has a sigma
};

// One list of observations a frame, each of a marker of the map and each marker at most once a frame; an
// empty list is refused as a frame without markers. `port` null: no refraction.
MarkerPoses FindMarkerPoses(const std::vector<std::vector<MarkerObservation>>& frames, const MarkerMap& map,
                            const Camera& camera, const FlatPort* port, const CameraMount& mount,
                            const MarkerPoseOptions& options = {});

// The sonar's covariance from the camera's, in the convention above.
Matrix6d SonarCovariance(const Matrix6d& camera_covariance, const Pose& world_from_camera,
                         const CameraMount& mount);

}  // namespace sonarcal::calib
