#include "calib/markers/marker_poses.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/markers/camera.h"
#include "calib/markers/marker_adjustment.h"
#include "calib/markers/marker_start.h"
#include "core/math/statistics.h"
#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

constexpr double kMedianOfChi2With8 = 7.344;
// A marker beyond this multiple of the typical misfit is wrong: wrong ones are off by thousands.
constexpr double kMaxMisfit = 200.0;

struct StartedFrame {
  std::vector<MarkerObservation> seen;
  std::vector<MarkerPoseCandidate> candidates;
};

// Returns s^2 from the median of the markers' misfits, which wrong markers do not move. A frame with few
// markers partly fits itself: its misfits are smaller by its remaining degrees of freedom.
double TypicalFactor(const std::vector<StartedFrame>& frames, const MarkerMap& map, const Camera& camera,
                     const FlatPort* port) {
  std::vector<double> factors;
  for (const StartedFrame& frame : frames) {
    if (frame.candidates.empty()) continue;
    const double numbers = 8.0 * static_cast<double>(frame.seen.size());
    const double left = (numbers - 6.0) / numbers;
    const Pose& pose = frame.candidates.front().world_from_camera;
    for (const double misfit : MarkerMisfits(frame.seen, map, camera, port, pose))
      factors.push_back(misfit / (kMedianOfChi2With8 * left));
  }
  if (factors.empty()) return 1.0;
  return std::max(UpperMedian(std::move(factors)), 1e-6);
}

// Removes the worst marker and starts again, as long as one contradicts two or more others.
std::vector<MarkerObservation> WithoutContradictions(StartedFrame& frame, double factor, const MarkerMap& map,
                                                     const Camera& camera, const FlatPort* port) {
  std::vector<MarkerObservation> left_out;
  while (frame.seen.size() >= 3 && !frame.candidates.empty()) {
    const std::vector<double> misfits =
        MarkerMisfits(frame.seen, map, camera, port, frame.candidates.front().world_from_camera);
    const auto worst = std::ranges::max_element(misfits);
    if (*worst <= kMaxMisfit * factor) break;
    const auto marker = frame.seen.begin() + (worst - misfits.begin());
    left_out.push_back(*marker);
    frame.seen.erase(marker);
    frame.candidates = FindPoseCandidates(frame.seen, map, camera, port);
  }
  return left_out;
}

double RmsPx(const MarkerObservation& seen, const std::array<Eigen::Vector2d, 4>& projected_px) {
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) sum += (projected_px[k] - seen.corners_px[k]).squaredNorm();
  return std::sqrt(sum / 4.0);
}

void AddResiduals(const std::vector<MarkerObservation>& seen, bool left_out, const MarkerMap& map,
                  double focal_scale, const Camera& camera, const FlatPort* port, MarkerFramePose& frame) {
  Camera scaled = camera;
  scaled.fx_px *= focal_scale;
  scaled.fy_px *= focal_scale;
  const Pose camera_from_world = frame.world_from_camera.Inverse();
  for (const MarkerObservation& observation : seen) {
    MarkerResidual residual{
        .id = observation.id, .left_out = left_out, .observation = observation, .projected_px = {}};
    const Marker& marker = *map.Find(observation.id);
    const auto corners_m = MarkerCorners(marker.size_m);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d in_camera = camera_from_world * (marker.world_from_marker * corners_m[k]);
      if (!PixelOfPoint(scaled, port, 1.0, in_camera, residual.projected_px[k]))
        residual.projected_px[k].setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    residual.rms_px = RmsPx(observation, residual.projected_px);
    frame.markers.push_back(std::move(residual));
  }
  std::ranges::sort(frame.markers, {}, &MarkerResidual::id);
}

double RmsOf(const std::vector<MarkerResidual>& markers) {
  double sum = 0.0;
  int count = 0;
  for (const MarkerResidual& marker : markers) {
    if (marker.left_out) continue;
    sum += marker.rms_px * marker.rms_px;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

// RMS error at a start: shows whether its markers fit one pose at all.
double StartRmsPx(const StartedFrame& frame, const MarkerMap& map, const Camera& camera,
                  const FlatPort* port) {
  MarkerFramePose pose;
  pose.world_from_camera = frame.candidates.front().world_from_camera;
  AddResiduals(frame.seen, false, map, 1.0, camera, port, pose);
  return RmsOf(pose.markers);
}

}  // namespace

Matrix6d SonarCovariance(const Matrix6d& camera_covariance, const Pose& world_from_camera,
                         const CameraMount& mount) {
  const Eigen::Matrix3d r = world_from_camera.rotation.toRotationMatrix();
  const Eigen::Matrix3d sonar_from_camera = mount.camera_from_sonar.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d& lever = mount.camera_from_sonar.position_m;
  Eigen::Matrix3d cross;
  cross << 0.0, -lever.z(), lever.y(), lever.z(), 0.0, -lever.x(), -lever.y(), lever.x(), 0.0;
  Matrix6d slope = Matrix6d::Zero();
  slope.topLeftCorner<3, 3>().setIdentity();
  slope.topRightCorner<3, 3>() = -r * cross;
  slope.bottomRightCorner<3, 3>() = sonar_from_camera;
  Matrix6d covariance = slope * camera_covariance * slope.transpose();
  covariance.diagonal().head<3>().array() += mount.sigma_position_m * mount.sigma_position_m;
  covariance.diagonal().tail<3>().array() += mount.sigma_angle_rad * mount.sigma_angle_rad;
  return 0.5 * (covariance + covariance.transpose());
}

MarkerPoses FindMarkerPoses(const std::vector<std::vector<MarkerObservation>>& frames, const MarkerMap& map,
                            const Camera& camera, const FlatPort* port, const CameraMount& mount,
                            const MarkerPoseOptions& options) {
  MarkerPoses result;
  result.frames.resize(frames.size());
  result.map = map;
  std::vector<StartedFrame> started(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].empty()) {
      result.frames[i].refused = "no marker of the map is seen";
      continue;
    }
    started[i] = {frames[i], FindPoseCandidates(frames[i], map, camera, port)};
    if (started[i].candidates.empty())
      result.frames[i].refused = "no pose puts the markers in front of the camera";
  }

  const double typical = TypicalFactor(started, map, camera, port);
  std::vector<std::vector<MarkerObservation>> left_out(frames.size());
  std::vector<AdjustedFrame> adjusted;
  std::vector<std::size_t> place;  // index of each adjusted frame
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!result.frames[i].refused.empty()) continue;
    left_out[i] = WithoutContradictions(started[i], typical, map, camera, port);
    if (started[i].candidates.empty()) {
      result.frames[i].refused = "no pose puts the markers in front of the camera";
      continue;
    }
    const double rms_px = StartRmsPx(started[i], map, camera, port);
    if (!(rms_px <= options.most_rms_px)) {
      result.frames[i].refused =
          fmt::format("its {} markers are {:.2f} pixels (rms) off one pose, expected at most {:g}",
                      started[i].seen.size(), rms_px, options.most_rms_px);
      continue;
    }
    adjusted.push_back(
        {.seen = started[i].seen, .world_from_camera = started[i].candidates.front().world_from_camera});
    place.push_back(i);
  }
  if (adjusted.empty()) return result;

  const Adjustment adjustment = Adjust(std::move(adjusted), map, camera, port, options.refine_focal, typical);
  result.noise_factor = std::sqrt(adjustment.noise_factor2);
  result.degrees_of_freedom = adjustment.degrees_of_freedom;
  result.focal_scale = adjustment.focal_scale;
  result.focal_scale_sigma = adjustment.focal_scale_sigma;
  result.map = adjustment.map;
  std::vector<MarkerResidual> all;
  for (std::size_t n = 0; n < place.size(); ++n) {
    const std::size_t i = place[n];
    const AdjustedFrame& from = adjustment.frames[n];
    MarkerFramePose& frame = result.frames[i];
    frame.world_from_camera = from.world_from_camera;
    frame.world_from_sonar = from.world_from_camera * mount.camera_from_sonar;
    frame.camera_covariance = from.covariance;
    frame.sonar_covariance = SonarCovariance(from.covariance, from.world_from_camera, mount);
    AddResiduals(from.seen, false, result.map, result.focal_scale, camera, port, frame);
    AddResiduals(left_out[i], true, result.map, result.focal_scale, camera, port, frame);
    frame.rms_px = RmsOf(frame.markers);
    all.insert(all.end(), frame.markers.begin(), frame.markers.end());
    const std::vector<MarkerPoseCandidate>& candidates = started[i].candidates;
    if (candidates.size() < 2) continue;
    const double nats = (candidates[1].cost - candidates[0].cost) / adjustment.noise_factor2;
    if (nats < options.ambiguous_nats)
      frame.other = OtherMarkerPose{candidates[1].world_from_camera * mount.camera_from_sonar, nats};
  }
  result.rms_px = RmsOf(all);
  return result;
}

}  // namespace sonarcal::calib
