// Poses of a sonar from pictures of markers by a camera mounted beside it (Park 2024, Section 6).
//
// Each frame starts from marker_start.h. A marker that contradicts the others is left out. Then Ceres refines
// all frames together, with Huber's loss on the eight numbers of each marker. If the map states how far
// markers may be off, markers are refined too, with that as prior. On request the focal length is refined.
//
// Noise: the corners of a marker are whitened by their own covariance C (marker_corners.h), which is right up
// to a common factor s^2. s^2 makes the sum of weight |r|^2 / s^2 over all markers equal to the number of
// degrees of freedom: 8 per marker, minus 6 per frame, minus the focal length, minus the share of the
// residuals of the priors. Other model errors (an inexact map taken as exact, lens, port) raise s and the
// covariance, but as if they were independent for every marker and frame.
//
// Covariance: the inverse of the information of all parameters, including other frames, map and focal length.
// Six by six of (x, y, z: position error in world axes, metres; a, b, c: rotation error about the axes of
// camera or sonar, radians): true = (position + (x, y, z), rotation * Exp(a, b, c)). The sigma of the mount
// is added to the covariance of the sonar. It is one error common to all frames, as are those of map, focal
// length and port.
//
// Throws DataError if the frames do not determine the free parameters. The same input gives the same output,
// to the bit.
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
  double most_rms_px = 2.0;  // max; a frame with more is refused
  bool refine_focal = false;
  // Min difference of log-likelihood between two poses. Below it both are reported.
  double ambiguous_nats = 8.0;
};

struct MarkerResidual {
  int id = 0;
  double rms_px = 0.0;  // over the distances of its four corners
  bool left_out = false;
  MarkerObservation observation;
  std::array<Eigen::Vector2d, 4> projected_px;
};

struct OtherMarkerPose {
  Pose world_from_sonar;
  double nats = 0.0;  // log-likelihood of the kept pose minus that of this one
};

struct MarkerFramePose {
  std::string refused;  // reason why there is no pose; empty: there is one
  Pose world_from_camera;
  Pose world_from_sonar;
  Matrix6d camera_covariance = Matrix6d::Zero();
  Matrix6d sonar_covariance = Matrix6d::Zero();
  double rms_px = 0.0;  // over the distances of all used corners
  std::vector<MarkerResidual> markers;
  std::optional<OtherMarkerPose> other;
};

struct MarkerPoses {
  std::vector<MarkerFramePose> frames;  // in the given order
  double noise_factor = 0.0;            // s
  double degrees_of_freedom = 0.0;
  double rms_px = 0.0;  // over all frames with a pose
  double focal_scale = 1.0;
  double focal_scale_sigma = 0.0;  // 0 if it is fixed
  MarkerMap map;                   // refined if it has a sigma
};

// `frames`: one list of observations per frame, each of a marker of the map, each marker at most once. A
// frame with an empty list is refused as one without markers. `port`: null for no refraction.
MarkerPoses FindMarkerPoses(const std::vector<std::vector<MarkerObservation>>& frames, const MarkerMap& map,
                            const Camera& camera, const FlatPort* port, const CameraMount& mount,
                            const MarkerPoseOptions& options = {});

// Covariance of the sonar from that of the camera, in the convention above.
Matrix6d SonarCovariance(const Matrix6d& camera_covariance, const Pose& world_from_camera,
                         const CameraMount& mount);

}  // namespace sonarcal::calib
