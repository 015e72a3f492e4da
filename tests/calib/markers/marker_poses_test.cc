// Poses from made-up corners: what the refinement does with them, and how often its covariances hold.
#include "calib/markers/marker_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "calib/markers/camera.h"
#include "calib/markers/marker_start.h"
#include "core/types/units.h"
#include "tests/support/marker_field.h"

namespace sonarcal::calib {
namespace {

using testing::FieldCamera;
using ::testing::HasSubstr;
using testing::LookingDown;
using testing::MarkerField;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kClaimedPx = 0.05;

FlatPort SomePort() {
  FlatPort port{.distance_m = 0.03, .thickness_m = 0.01};
  port.normal = Eigen::Vector3d(0.02, -0.01, 1.0).normalized();
  return port;
}

// All markers that are wholly in the image, corners off by `noise_px` an axis.
std::vector<MarkerObservation> Look(const MarkerMap& map, const Camera& camera, const FlatPort* port,
                                    const Pose& world_from_camera, double noise_px, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<MarkerObservation> seen;
  const Pose camera_from_world = world_from_camera.Inverse();
  for (const Marker& marker : map.markers) {
    MarkerObservation observation{.id = marker.id, .corners_px = {}, .covariance_px2 = {}};
    observation.covariance_px2 = kClaimedPx * kClaimedPx * Matrix8d::Identity();
    bool inside = true;
    const auto corners_m = MarkerCorners(marker.size_m);
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector2d& pixel = observation.corners_px[k];
      const Eigen::Vector3d in_camera = camera_from_world * (marker.world_from_marker * corners_m[k]);
      inside = inside && PixelOfPoint(camera, port, 1.0, in_camera, pixel) && pixel.minCoeff() > 5.0 &&
               pixel.x() < camera.cols - 5 && pixel.y() < camera.rows - 5;
      pixel += noise_px * Eigen::Vector2d(noise(random), noise(random));
    }
    if (inside) seen.push_back(observation);
  }
  return seen;
}

Pose RandomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double height_m = 1.4 + 0.2 * unit(random);
  const Eigen::Vector2d aside(0.6 * unit(random), 0.6 * unit(random));
  return LookingDown(height_m, aside, {0.2 * unit(random), 0.2 * unit(random)}, 3.0 * unit(random));
}

// True less found, in the convention of the covariance.
Vector6d ErrorOf(const Pose& truth, const Pose& found) {
  const Eigen::AngleAxisd turn(found.rotation.conjugate() * truth.rotation);
  const double angle = std::remainder(turn.angle(), 2.0 * std::acos(-1.0));
  Vector6d error;
  error << truth.position_m - found.position_m, angle * turn.axis();
  return error;
}

double Normalised(const Vector6d& error, const Matrix6d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

// The mean of `count` independent chi-square numbers with 6 degrees of freedom stays within this of 6 in all
// but one of 10,000 tries (3.9 standard deviations, sqrt(12 / count) each).
double Bound(int count) {
  return 3.9 * std::sqrt(12.0 / count);
}

TEST(MarkerPoses, WithoutNoiseThePoseIsExact) {
  const FlatPort port = SomePort();
  for (const FlatPort* window : {static_cast<const FlatPort*>(nullptr), &port}) {
    for (const bool flat : {true, false}) {
      const MarkerMap map = MarkerField({.flat = flat});
      std::mt19937 random(3);
      std::vector<Pose> truth;
      std::vector<std::vector<MarkerObservation>> frames;
      for (int i = 0; i < 5; ++i) {
        truth.push_back(RandomPose(random));
        frames.push_back(Look(map, FieldCamera(), window, truth.back(), 0.0, random));
        ASSERT_FALSE(frames.back().empty());
      }
      const MarkerPoses poses = FindMarkerPoses(frames, map, FieldCamera(), window, {});
      for (int i = 0; i < 5; ++i) {
        ASSERT_EQ(poses.frames[i].refused, "");
        EXPECT_LT(ErrorOf(truth[i], poses.frames[i].world_from_camera).norm(), 1e-6);
      }
    }
  }
}

// 100 frames, corners twice as noisy as their covariance says: the factor is found, and the errors are as
// large as the covariance scaled by it.
TEST(MarkerPoses, ErrorsAreAsLargeAsTheScaledCovariance) {
  const MarkerMap map = MarkerField();
  const FlatPort port = SomePort();
  CameraMount mount;
  mount.camera_from_sonar = {RotationFromYawPitchRoll(0.3, -1.2, 0.1), {0.25, -0.4, 0.1}};
  std::mt19937 random(5);
  std::vector<Pose> truth;
  std::vector<std::vector<MarkerObservation>> frames;
  constexpr int kCount = 100;
  for (int i = 0; i < kCount; ++i) {
    truth.push_back(RandomPose(random));
    frames.push_back(Look(map, FieldCamera(), &port, truth.back(), 2.0 * kClaimedPx, random));
  }
  const MarkerPoses poses = FindMarkerPoses(frames, map, FieldCamera(), &port, mount);
  EXPECT_NEAR(poses.noise_factor, 2.0, 0.05);
  EXPECT_NEAR(poses.rms_px, std::sqrt(2.0) * 2.0 * kClaimedPx, 0.01);
  double camera_sum = 0.0;
  double sonar_sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const MarkerFramePose& frame = poses.frames[i];
    camera_sum += Normalised(ErrorOf(truth[i], frame.world_from_camera), frame.camera_covariance);
    sonar_sum += Normalised(ErrorOf(truth[i] * mount.camera_from_sonar, frame.world_from_sonar),
                            frame.sonar_covariance);
  }
  EXPECT_NEAR(camera_sum / kCount, 6.0, Bound(kCount));
  std::cout << "mean squared normalised error " << camera_sum / kCount << " (6), noise factor "
            << poses.noise_factor << "\n";
  // The same errors seen from the sonar: only a wrong lever or axis would change them.
  EXPECT_NEAR(sonar_sum / kCount, camera_sum / kCount, 0.01);
}

// In each of 40 worlds the markers are not where the map has them, by what it says: covariances take that in.
// Without the map's sigma the errors are far beyond them.
TEST(MarkerPoses, AnInexactMapIsInTheCovariance) {
  constexpr int kWorlds = 40;
  constexpr int kWorldsWithout = 10;
  double with_sum = 0.0;
  double without_sum = 0.0;
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int world = 0; world < kWorlds; ++world) {
    MarkerMap map = MarkerField();
    map.sigma = MarkerMapSigma{.position_m = 0.003, .angle_rad = RadFromDeg(0.5)};
    MarkerMap truth_map = map;
    for (Marker& marker : truth_map.markers) {
      Pose& pose = marker.world_from_marker;
      for (int k = 0; k < 3; ++k) pose.position_m(k) += map.sigma->position_m * normal(random);
      const Eigen::Vector3d turn =
          map.sigma->angle_rad * Eigen::Vector3d(normal(random), normal(random), normal(random));
      pose.rotation = pose.rotation * Eigen::AngleAxisd(turn.norm(), turn.normalized());
    }
    std::vector<Pose> truth;
    std::vector<std::vector<MarkerObservation>> frames;
    for (int i = 0; i < 4; ++i) {
      truth.push_back(RandomPose(random));
      frames.push_back(Look(truth_map, FieldCamera(), nullptr, truth.back(), kClaimedPx, random));
    }
    const MarkerPoses with = FindMarkerPoses(frames, map, FieldCamera(), nullptr, {}, {.most_rms_px = 10.0});
    // One frame a world, as the map's error is common to all of a world's.
    with_sum +=
        Normalised(ErrorOf(truth[0], with.frames[0].world_from_camera), with.frames[0].camera_covariance);
    EXPECT_NEAR(with.noise_factor, 1.0, 0.25);
    if (world >= kWorldsWithout) continue;
    map.sigma.reset();
    const MarkerPoses without =
        FindMarkerPoses(frames, map, FieldCamera(), nullptr, {}, {.most_rms_px = 10.0});
    without_sum += Normalised(ErrorOf(truth[0], without.frames[0].world_from_camera),
                              without.frames[0].camera_covariance);
  }
  EXPECT_NEAR(with_sum / kWorlds, 6.0, Bound(kWorlds));
  std::cout << "mean squared normalised error with the map's sigma " << with_sum / kWorlds << " (6), without "
            << without_sum / kWorldsWithout << "\n";
  EXPECT_GT(without_sum / kWorldsWithout, 6.0 + Bound(kWorldsWithout));
}

TEST(MarkerPoses, TheFocalLengthIsFoundOnRequest) {
  const MarkerMap map = MarkerField({.flat = false});
  Camera told = FieldCamera();
  told.fx_px /= 1.01;
  told.fy_px /= 1.01;
  std::mt19937 random(9);
  std::vector<Pose> truth;
  std::vector<std::vector<MarkerObservation>> frames;
  for (int i = 0; i < 20; ++i) {
    truth.push_back(RandomPose(random));
    frames.push_back(Look(map, FieldCamera(), nullptr, truth.back(), kClaimedPx, random));
  }
  const MarkerPoses held = FindMarkerPoses(frames, map, told, nullptr, {});
  const MarkerPoses freed = FindMarkerPoses(frames, map, told, nullptr, {}, {.refine_focal = true});
  EXPECT_GT(held.noise_factor, 1.5);
  EXPECT_EQ(held.focal_scale, 1.0);
  EXPECT_NEAR(freed.noise_factor, 1.0, 0.1);
  EXPECT_GT(freed.focal_scale_sigma, 0.0);
  EXPECT_LT(std::abs(freed.focal_scale - 1.01), 4.0 * freed.focal_scale_sigma);
  EXPECT_LT(freed.focal_scale_sigma, 1e-3);
}

TEST(MarkerPoses, AWrongMarkerIsLeftOut) {
  const MarkerMap map = MarkerField();
  std::mt19937 random(11);
  const Pose truth = LookingDown(1.5, {0.1, 0.0}, {0.0, 0.0}, 0.4);
  std::vector<MarkerObservation> seen = Look(map, FieldCamera(), nullptr, truth, kClaimedPx, random);
  ASSERT_GE(seen.size(), 8U);
  // Two of them under each other's names, as when someone swapped the plates.
  std::swap(seen[1].corners_px, seen[4].corners_px);
  const MarkerPoses poses = FindMarkerPoses({seen, seen}, map, FieldCamera(), nullptr, {});
  const MarkerFramePose& frame = poses.frames[0];
  ASSERT_EQ(frame.refused, "");
  for (const MarkerResidual& marker : frame.markers) {
    const bool swapped = marker.id == seen[1].id || marker.id == seen[4].id;
    EXPECT_EQ(marker.left_out, swapped) << marker.id;
  }
  EXPECT_LT(Normalised(ErrorOf(truth, frame.world_from_camera), frame.camera_covariance), 33.0);
}

// Two markers that contradict each other: nobody can say which is right.
TEST(MarkerPoses, FramesThatFitNoPoseAndEmptyOnesAreRefused) {
  const MarkerMap map = MarkerField();
  std::mt19937 random(13);
  const std::vector<MarkerObservation> seen =
      Look(map, FieldCamera(), nullptr, LookingDown(1.5, {0.1, 0.0}, {0.0, 0.0}, 0.4), kClaimedPx, random);
  std::vector<MarkerObservation> contradiction = {seen[0], seen[3]};
  for (Eigen::Vector2d& corner : contradiction[1].corners_px) corner.x() += 60.0;
  const MarkerPoses poses = FindMarkerPoses({seen, {}, contradiction}, map, FieldCamera(), nullptr, {});
  EXPECT_EQ(poses.frames[0].refused, "");
  EXPECT_THAT(poses.frames[1].refused, HasSubstr("no marker"));
  EXPECT_THAT(poses.frames[2].refused, HasSubstr("off one pose"));
  EXPECT_THAT(FindMarkerPoses({{}}, map, FieldCamera(), nullptr, {}).frames[0].refused,
              HasSubstr("no marker"));
}

// One small marker straight below: seen from two sides it looks the same to within the noise. Whichever pose
// is kept, the other is named; where it is seen slantwise and large, none is.
TEST(MarkerPoses, AnAmbiguousFrameIsMarked) {
  MarkerMap map = MarkerField({.rows = 1, .cols = 1, .size_m = 0.1});
  const Camera camera = FieldCamera();
  std::mt19937 random(17);
  const Pose far = LookingDown(2.5, {0.6, 0.0}, {0.0, 0.0}, 0.0);
  const Pose near = LookingDown(0.4, {0.3, 0.0}, {0.0, 0.0}, 0.0);
  std::vector<std::vector<MarkerObservation>> frames;
  for (int i = 0; i < 20; ++i) frames.push_back(Look(map, camera, nullptr, far, 2.0 * kClaimedPx, random));
  for (int i = 0; i < 20; ++i) frames.push_back(Look(map, camera, nullptr, near, 2.0 * kClaimedPx, random));
  const MarkerPoses poses = FindMarkerPoses(frames, map, camera, nullptr, {});
  int ambiguous = 0;
  for (int i = 0; i < 20; ++i) {
    const MarkerFramePose& frame = poses.frames[i];
    double closest_m = (frame.world_from_camera.position_m - far.position_m).norm();
    if (frame.other) {
      ++ambiguous;
      closest_m = std::min(closest_m, (frame.other->world_from_sonar.position_m - far.position_m).norm());
    }
    EXPECT_LT(closest_m, 0.6);  // nearer than to the one 1.2 m away
    EXPECT_FALSE(poses.frames[20 + i].other);
  }
  EXPECT_GE(ambiguous, 5);
}

TEST(MarkerPoses, SameInputSameBits) {
  const MarkerMap map = MarkerField();
  std::mt19937 random(19);
  std::vector<std::vector<MarkerObservation>> frames;
  for (int i = 0; i < 4; ++i)
    frames.push_back(Look(map, FieldCamera(), nullptr, RandomPose(random), kClaimedPx, random));
  const MarkerPoses one = FindMarkerPoses(frames, map, FieldCamera(), nullptr, {});
  const MarkerPoses two = FindMarkerPoses(frames, map, FieldCamera(), nullptr, {});
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(one.frames[i].world_from_sonar.position_m, two.frames[i].world_from_sonar.position_m);
    EXPECT_EQ(one.frames[i].sonar_covariance, two.frames[i].sonar_covariance);
  }
}

// A lever and a turn by hand: 1 mm of angle noise at 2 m.
TEST(MarkerPoses, TheMountsLeverAndSigmaAreInTheSonarsCovariance) {
  Matrix6d camera = Matrix6d::Zero();
  camera(3, 3) = 1e-6;  // about the camera's X
  CameraMount mount;
  mount.camera_from_sonar = {
      Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(-1.0) / 2.0, Eigen::Vector3d::UnitZ())),
      {0.0, 2.0, 0.0}};
  mount.sigma_position_m = 0.01;
  mount.sigma_angle_rad = 0.02;
  const Matrix6d sonar = SonarCovariance(camera, Pose{}, mount);
  EXPECT_NEAR(sonar(2, 2), 4e-6 + 1e-4, 1e-12);  // X turns Y towards Z
  EXPECT_NEAR(sonar(0, 0), 1e-4, 1e-12);
  // The camera's X is the sonar's -Y.
  EXPECT_NEAR(sonar(4, 4), 1e-6 + 4e-4, 1e-12);
  EXPECT_NEAR(sonar(3, 3), 4e-4, 1e-12);
  EXPECT_NEAR(sonar(2, 4), -2e-6, 1e-12);
}

}  // namespace
}  // namespace sonarcal::calib
