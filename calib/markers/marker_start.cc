#include "calib/markers/marker_start.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "calib/markers/marker_cost.h"
#include "core/types/error.h"
#include "core/types/rotation.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

using CvPoints3 = std::vector<cv::Point3d>;
using CvPoints2 = std::vector<cv::Point2d>;

constexpr std::size_t kMarkersTriedAlone = 4;

const Marker& MarkerOf(const MarkerMap& map, int id) {
  const Marker* marker = map.Find(id);
  SONARCAL_CHECK(marker != nullptr, "marker {} is not in the map", id);
  return *marker;
}

// Poses object-from-camera that OpenCV finds. Its camera is the straight coordinates.
std::vector<Pose> Solutions(const CvPoints3& object, const CvPoints2& image, int method) {
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  try {
    cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations,
                        false, static_cast<cv::SolvePnPMethod>(method));
  } catch (const cv::Exception&) {
    return {};  // no plane matches the corners; other methods are tried
  }
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    cv::Mat r;
    cv::Mat t;
    rotations[i].convertTo(r, CV_64F);
    translations[i].convertTo(t, CV_64F);
    const Eigen::Vector3d vector(r.at<double>(0), r.at<double>(1), r.at<double>(2));
    const Eigen::Vector3d position_m(t.at<double>(0), t.at<double>(1), t.at<double>(2));
    if (!vector.allFinite() || !position_m.allFinite()) continue;
    poses.push_back(Pose{Turned(Eigen::Quaterniond::Identity(), vector), position_m}.Inverse());
  }
  return poses;
}

struct Corners {
  CvPoints3 object;
  CvPoints2 image;

  void Add(const Pose& object_from_marker, double size_m, const std::array<Eigen::Vector2d, 4>& straight) {
    const auto corners_m = MarkerCorners(size_m);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d p = object_from_marker * corners_m[k];
      object.emplace_back(p.x(), p.y(), p.z());
      image.emplace_back(straight[k].x(), straight[k].y());
    }
  }

  // Returns true if the points deviate from a plane by at most 1/50 of their extent, which is enough for a
  // start.
  bool LieInAPlane() const {
    Eigen::Matrix3Xd points(3, object.size());
    for (std::size_t i = 0; i < object.size(); ++i) points.col(i) << object[i].x, object[i].y, object[i].z;
    points.colwise() -= points.rowwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(points * points.transpose(),
                                                                 Eigen::EigenvaluesOnly);
    constexpr double kMaxRatio = 0.02;
    return moments.eigenvalues()(0) < kMaxRatio * kMaxRatio * moments.eigenvalues()(1);
  }
};

double AreaPx2(const MarkerObservation& seen) {
  double area = 0.0;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d& a = seen.corners_px[k];
    const Eigen::Vector2d& b = seen.corners_px[(k + 1) % 4];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return std::abs(area);
}

std::vector<Pose> Guesses(const std::vector<MarkerObservation>& seen, const MarkerMap& map,
                          const Camera& camera, const FlatPort* port) {
  Corners all;
  std::vector<std::pair<double, std::size_t>> by_area;
  std::vector<std::array<Eigen::Vector2d, 4>> straight(seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Marker& marker = MarkerOf(map, seen[i].id);
    const double depth_m = MarkerDepthM({seen[i].id, seen[i].corners_px}, marker.size_m, camera, port);
    for (int k = 0; k < 4; ++k) {
      const auto point = StraightFromPixel(camera, port, depth_m, seen[i].corners_px[k]);
      SONARCAL_CHECK(point.has_value(), "a corner of marker {} left the camera's image", seen[i].id);
      straight[i][k] = *point;
    }
    all.Add(marker.world_from_marker, marker.size_m, straight[i]);
    by_area.emplace_back(-AreaPx2(seen[i]), i);
  }
  std::vector<Pose> guesses =
      Solutions(all.object, all.image, all.LieInAPlane() ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP);
  std::ranges::sort(by_area);
  for (std::size_t n = 0; n < std::min(kMarkersTriedAlone, seen.size()); ++n) {
    const std::size_t i = by_area[n].second;
    const Marker& marker = MarkerOf(map, seen[i].id);
    Corners alone;
    alone.Add(Pose{}, marker.size_m, straight[i]);
    for (const Pose& marker_from_camera : Solutions(alone.object, alone.image, cv::SOLVEPNP_IPPE_SQUARE)) {
      guesses.push_back(marker.world_from_marker * marker_from_camera);
    }
  }
  return guesses;
}

bool AreSame(const Pose& a, const Pose& b, double apart_m, double apart_deg) {
  return (a.position_m - b.position_m).norm() <= apart_m &&
         DegFromRad(a.rotation.angularDistance(b.rotation)) <= apart_deg;
}

std::vector<MarkerCost> CostsOf(const std::vector<MarkerObservation>& seen, const MarkerMap& map,
                                const Camera& camera, const FlatPort* port,
                                const Eigen::Quaterniond& reference) {
  std::vector<MarkerCost> costs;
  for (const MarkerObservation& observation : seen) {
    costs.push_back({.camera = &camera,
                     .port = port,
                     .marker = MarkerOf(map, observation.id),
                     .world_from_camera_reference = &reference,
                     .corners_px = observation.corners_px,
                     .whiten = WhiteningOf(observation.covariance_px2)});
  }
  return costs;
}

constexpr std::array<double, 6> kNoStep{};
constexpr double kNoScale = 1.0;

// Cost with a fixed marker and camera: only the frame is free.
struct FrameOnlyCost {
  MarkerCost cost;

  template <typename T>
  bool operator()(const T* frame, T* residual) const {
    const std::array<T, 6> step{};
    const T focal(kNoScale);
    return cost(frame, step.data(), &focal, residual);
  }
};

// Refines the pose from a guess. Nullopt if a marker leaves the visible region.
std::optional<MarkerPoseCandidate> Refined(const std::vector<MarkerObservation>& seen, const MarkerMap& map,
                                           const Camera& camera, const FlatPort* port, const Pose& guess) {
  Pose pose = guess;
  MarkerPoseCandidate candidate;
  // Refines twice, the second time about a reference that is nearly the solution.
  for (int round = 0; round < 2; ++round) {
    const Eigen::Quaterniond reference = pose.rotation;
    std::array<double, 6> frame{pose.position_m.x(), pose.position_m.y(), pose.position_m.z()};
    ceres::Problem problem;
    for (const MarkerCost& cost : CostsOf(seen, map, camera, port, reference)) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<FrameOnlyCost, 8, 6>(new FrameOnlyCost{cost}),
                               new ceres::HuberLoss(kMarkerHuber), frame.data());
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable() || summary.termination_type == ceres::FAILURE) return std::nullopt;
    pose = {Turned(reference, {frame[3], frame[4], frame[5]}), {frame[0], frame[1], frame[2]}};
    candidate.cost = summary.final_cost;
  }
  if (!pose.position_m.allFinite() || !pose.rotation.coeffs().allFinite()) return std::nullopt;
  candidate.world_from_camera = pose;
  return candidate;
}

}  // namespace

std::vector<double> MarkerMisfits(const std::vector<MarkerObservation>& seen, const MarkerMap& map,
                                  const Camera& camera, const FlatPort* port, const Pose& world_from_camera) {
  const Eigen::Vector3d& p = world_from_camera.position_m;
  const std::array<double, 6> frame{p.x(), p.y(), p.z()};
  std::vector<double> misfits;
  for (const MarkerCost& cost : CostsOf(seen, map, camera, port, world_from_camera.rotation)) {
    Eigen::Matrix<double, 8, 1> residual;
    const bool is_seen = cost(frame.data(), kNoStep.data(), &kNoScale, residual.data());
    misfits.push_back(is_seen ? residual.squaredNorm() : std::numeric_limits<double>::infinity());
  }
  return misfits;
}

std::vector<MarkerPoseCandidate> FindPoseCandidates(const std::vector<MarkerObservation>& seen,
                                                    const MarkerMap& map, const Camera& camera,
                                                    const FlatPort* port) {
  // Guesses in one valley need one refinement.
  constexpr double kGuessesApartM = 0.03;
  constexpr double kGuessesApartDeg = 3.0;
  constexpr double kApartM = 0.01;
  constexpr double kApartDeg = 0.5;
  std::vector<Pose> guesses;
  for (const Pose& guess : Guesses(seen, map, camera, port)) {
    const bool is_known = std::ranges::any_of(
        guesses, [&](const Pose& other) { return AreSame(guess, other, kGuessesApartM, kGuessesApartDeg); });
    if (!is_known) guesses.push_back(guess);
  }
  std::vector<MarkerPoseCandidate> candidates;
  for (const Pose& guess : guesses) {
    const auto refined = Refined(seen, map, camera, port, guess);
    if (refined) candidates.push_back(*refined);
  }
  std::ranges::stable_sort(candidates, {}, &MarkerPoseCandidate::cost);
  std::vector<MarkerPoseCandidate> different;
  for (const MarkerPoseCandidate& candidate : candidates) {
    const bool is_known = std::ranges::any_of(different, [&](const MarkerPoseCandidate& other) {
      return AreSame(candidate.world_from_camera, other.world_from_camera, kApartM, kApartDeg);
    });
    if (!is_known) different.push_back(candidate);
  }
  return different;
}

}  // namespace sonarcal::calib
