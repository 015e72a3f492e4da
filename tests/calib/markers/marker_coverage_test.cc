// From pictures to poses: SYNTHETIC pictures of a marker field, rendered by a second implementation of the
// camera (tests/support/marker_field.h) with blur, noise and occluders, and errors of the poses against what
// their covariances say.
//
// With n frames, the mean of the squared normalised errors of 6 numbers is 6, give or take sqrt(12 / n); the
// bounds are 3.9 of these. Means of the normalised errors by axis are 0, give or take 1 / sqrt(n).
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "calib/markers/camera.h"
#include "calib/markers/marker_detector.h"
#include "calib/markers/marker_poses.h"
#include "data_io/parameters/marker_map_io.h"
#include "tests/support/marker_field.h"

namespace sonarcal::calib {
namespace {

using testing::FieldCamera;
using testing::FieldOptions;
using testing::FieldRenderer;
using testing::LookingDown;
using testing::PictureOptions;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Coverage {
  MarkerPoses poses;
  std::vector<Pose> truth;
  std::vector<std::vector<MarkerObservation>> seen;
  double mean_squared = 0.0;
  double most_squared = 0.0;
  Vector6d mean = Vector6d::Zero();
  double outward_px = 0.0;  // mean of the corners' errors away from their marker's middle
};

FlatPort TankPort() {
  FlatPort port{.distance_m = 0.03, .thickness_m = 0.01};
  port.normal = Eigen::Vector3d(0.02, -0.01, 1.0).normalized();
  return port;
}

constexpr int kSupersampling = 3;

Coverage Measure(const FieldOptions& field, const FlatPort* rendered, const FlatPort* assumed, int count,
                 const PictureOptions& picture, const MarkerPoseOptions& pose_options = {}) {
  const MarkerMap map = testing::MarkerField(field);
  const Camera camera = FieldCamera();
  const FieldRenderer renderer(map, camera, rendered, kSupersampling);
  const MarkerDetector detector(field.dictionary);
  const int cells = data_io::FindMarkerDictionary(field.dictionary)->cells;
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Coverage coverage;
  double corners = 0.0;
  for (int i = 0; i < count; ++i) {
    const double height_m = 1.5 + 0.3 * unit(random);
    const Eigen::Vector2d aside(0.6 * unit(random), 0.6 * unit(random));
    const Eigen::Vector2d target(0.25 * unit(random), 0.25 * unit(random));
    coverage.truth.push_back(LookingDown(height_m, aside, target, 3.0 * unit(random)));
    PictureOptions options = picture;
    options.seed = 100 + static_cast<unsigned>(i);
    const Grid<std::uint8_t> grey = renderer.Render(coverage.truth.back(), options);
    std::vector<MarkerObservation> seen;
    for (const MarkerQuad& quad : detector.Detect(grey).markers) {
      const Marker* marker = map.Find(quad.id);
      if (marker == nullptr) continue;
      const auto refined = RefineMarkerCorners(grey, quad, {cells, marker->size_m}, camera, assumed);
      if (!refined) continue;
      seen.push_back(*refined);
      const auto corners_m = MarkerCorners(marker->size_m);
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& corner : refined->corners_px) middle += 0.25 * corner;
      for (int k = 0; k < 4; ++k) {
        Eigen::Vector2d pixel;
        EXPECT_TRUE(PixelOfPoint<double>(
            camera, rendered, 1.0,
            coverage.truth.back().Inverse() * (marker->world_from_marker * corners_m[k]), pixel));
        coverage.outward_px += (refined->corners_px[k] - pixel).dot((pixel - middle).normalized());
        corners += 1.0;
      }
    }
    coverage.seen.push_back(std::move(seen));
  }
  coverage.outward_px /= corners;
  coverage.poses = FindMarkerPoses(coverage.seen, map, camera, assumed, {}, pose_options);
  int posed = 0;
  for (int i = 0; i < count; ++i) {
    const MarkerFramePose& frame = coverage.poses.frames[i];
    if (!frame.refused.empty()) continue;
    const Pose& found = frame.world_from_camera;
    const Eigen::AngleAxisd turn(found.rotation.conjugate() * coverage.truth[i].rotation);
    Vector6d error;
    error << coverage.truth[i].position_m - found.position_m,
        std::remainder(turn.angle(), 2.0 * std::acos(-1.0)) * turn.axis();
    const double squared = error.dot(frame.camera_covariance.ldlt().solve(error));
    coverage.mean_squared += squared;
    coverage.most_squared = std::max(coverage.most_squared, squared);
    coverage.mean += error.cwiseQuotient(frame.camera_covariance.diagonal().cwiseSqrt());
    ++posed;
  }
  EXPECT_EQ(posed, count);
  coverage.mean_squared /= posed;
  coverage.mean /= posed;
  return coverage;
}

void ExpectCovered(const Coverage& coverage, int count) {
  EXPECT_NEAR(coverage.mean_squared, 6.0, 3.9 * std::sqrt(12.0 / count));
  EXPECT_LT(coverage.most_squared, 33.0);  // one in 100,000 frames has more
  EXPECT_LT(coverage.mean.cwiseAbs().maxCoeff(), 3.9 / std::sqrt(count));
  // Blur must not move edges: 0.01 px is a third of a corner's own noise.
  EXPECT_LT(std::abs(coverage.outward_px), 0.003);
  ::testing::Test::RecordProperty("mean_squared", std::to_string(coverage.mean_squared));
  std::cout << "mean squared normalised error " << coverage.mean_squared << " (6), most "
            << coverage.most_squared << ", means by axis " << coverage.mean.transpose() << ", outward "
            << coverage.outward_px << " px, noise factor " << coverage.poses.noise_factor << ", rms "
            << coverage.poses.rms_px << " px\n";
}

TEST(MarkerCoverage, ArucoWithoutAPort) {
  constexpr int kFrames = 24;
  ExpectCovered(Measure({}, nullptr, nullptr, kFrames, {}), kFrames);
}

TEST(MarkerCoverage, AprilTagsThroughAPortWithOcclusion) {
  constexpr int kFrames = 24;
  const FlatPort port = TankPort();
  const Coverage coverage =
      Measure({.dictionary = "DICT_APRILTAG_36h11"}, &port, &port, kFrames, {.occluders = 3});
  ExpectCovered(coverage, kFrames);
}

TEST(MarkerCoverage, BlurredAndNoisyOnSeveralHeights) {
  constexpr int kFrames = 16;
  ExpectCovered(
      Measure({.flat = false, .seed = 2}, nullptr, nullptr, kFrames, {.blur_px = 1.2, .noise_grey = 8.0}),
      kFrames);
}

// Seen through a port that nobody told of: positions are centimetres off, and the residuals say that
// something is wrong.
TEST(MarkerCoverage, APortThatIsLeftOutShows) {
  constexpr int kFrames = 4;
  const FlatPort port = TankPort();
  const Coverage told = Measure({}, &port, &port, kFrames, {});
  const Coverage untold = Measure({}, &port, nullptr, kFrames, {}, {.most_rms_px = 50.0});
  for (int i = 0; i < kFrames; ++i) {
    const Eigen::Vector3d& truth_m = told.truth[i].position_m;
    EXPECT_LT((told.poses.frames[i].world_from_camera.position_m - truth_m).norm(), 0.001);
    EXPECT_GT((untold.poses.frames[i].world_from_camera.position_m - truth_m).norm(), 0.05);
  }
  EXPECT_LT(told.poses.noise_factor, 2.0);
  EXPECT_GT(untold.poses.noise_factor, 5.0);
}

}  // namespace
}  // namespace sonarcal::calib
