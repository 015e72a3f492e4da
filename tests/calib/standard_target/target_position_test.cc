#include "calib/standard_target/target_position.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

using ::testing::HasSubstr;

constexpr SightTolerance kTolerance{.range_m = 0.05, .azimuth_rad = 0.01};

// Sights of a target at a place known, from poses about a place 3 m away. Range and azimuth are computed by
// hand, with errors.
class TargetPositionTest : public ::testing::Test {
 protected:
  TargetSight SightFrom(const Eigen::Vector3d& position_m, double yaw_deg, double pitch_deg) {
    const Pose pose{RotationFromYawPitchRoll(RadFromDeg(yaw_deg), RadFromDeg(pitch_deg), 0.0), position_m};
    const Eigen::Vector3d away_m = target_m_ - position_m;
    const double right_m = away_m.dot(pose.rotation * Eigen::Vector3d::UnitX());
    const double forward_m = away_m.dot(pose.rotation * Eigen::Vector3d::UnitY());
    return {pose, away_m.norm() + 0.003 * normal_(random_),
            std::atan2(right_m, forward_m) + 0.0005 * normal_(random_)};
  }

  // From places that differ by half a metre, looking up and down.
  std::vector<TargetSight> Sights(int count) {
    std::vector<TargetSight> sights;
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d from_m(uniform(random_), -3.0 + uniform(random_), uniform(random_));
      sights.push_back(SightFrom(from_m, 20.0 * uniform(random_), 10.0 * uniform(random_)));
    }
    return sights;
  }

  const Eigen::Vector3d target_m_{0.1, 0.2, 0.3};
  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_;
};

TEST_F(TargetPositionTest, FindsTheTargetAmongOtherEchoes) {
  std::vector<TargetSight> sights = Sights(30);
  for (int i = 0; i < 30; i += 3) {
    // Another echo, far or near.
    sights[i].range_m += (i % 2 == 0) ? 0.8 : -0.1;
    sights[i].azimuth_rad += 0.1;
  }
  const TargetLocation found = LocateTarget(sights, kTolerance);
  ASSERT_TRUE(found.position.has_value()) << found.why_not;
  EXPECT_LT((found.position->position_m - target_m_).norm(), 0.01);
  EXPECT_FALSE(found.position->mirror_m.has_value()) << "the sonar was raised and lowered";
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(found.position->agrees[i], i % 3 != 0) << i;
    const Pose& pose = sights[i].world_from_sonar;
    const double up_m = (target_m_ - pose.position_m).dot(pose.rotation * Eigen::Vector3d::UnitZ());
    EXPECT_NEAR(found.position->elevation_rad[i], std::asin(up_m / (target_m_ - pose.position_m).norm()),
                0.004);
  }
  // RMS of the errors put in, for 20 sights.
  EXPECT_NEAR(found.position->range_error_m, 0.003, 0.0015);
  EXPECT_NEAR(found.position->azimuth_error_rad, 0.0005, 0.00025);
}

// From half a metre below the plane z = 0, without looking up or down.
TEST_F(TargetPositionTest, ALevelSonarDoesNotTellAboveFromBelow) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<TargetSight> sights;
  for (int i = 0; i < 30; ++i)
    sights.push_back(
        SightFrom({uniform(random_), -3.0 + uniform(random_), -0.5}, 20.0 * uniform(random_), 0.0));
  const TargetLocation found = LocateTarget(sights, kTolerance);
  ASSERT_TRUE(found.position.has_value()) << found.why_not;
  ASSERT_TRUE(found.position->mirror_m.has_value());
  Eigen::Vector3d above_m = found.position->position_m;
  Eigen::Vector3d below_m = *found.position->mirror_m;
  if (above_m.z() < below_m.z()) std::swap(above_m, below_m);
  EXPECT_LT((above_m - target_m_).norm(), 0.05);
  EXPECT_LT((below_m - Eigen::Vector3d(0.1, 0.2, -1.3)).norm(), 0.05);
}

// A sonar that stays at one height and tilts, with the target always in the middle of its beams. Above and
// below differ in the elevations, not in range and azimuth.
TEST_F(TargetPositionTest, AMirrorImageWithOtherElevationsIsRefused) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<TargetSight> sights;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d from_m(uniform(random_), -3.0 + uniform(random_), -0.5);
    const Eigen::Vector3d away_m = target_m_ - from_m;
    sights.push_back(
        SightFrom(from_m, DegFromRad(std::atan2(-away_m.x(), away_m.y())), 10.0 * uniform(random_)));
  }
  const TargetLocation found = LocateTarget(sights, kTolerance);
  EXPECT_FALSE(found.position.has_value());
  EXPECT_THAT(found.why_not, HasSubstr("do not tell the elevation"));
}

TEST_F(TargetPositionTest, SaysWhyThereIsNone) {
  EXPECT_THAT(LocateTarget(Sights(2), kTolerance).why_not, HasSubstr("expected 3"));

  // One pose: the target may be anywhere on an arc.
  std::vector<TargetSight> fixed;
  for (int i = 0; i < 10; ++i) fixed.push_back(SightFrom({0.0, -3.0, 0.0}, 0.0, 0.0));
  EXPECT_THAT(LocateTarget(fixed, kTolerance).why_not, HasSubstr("do not tell the elevation"));

  // A target that moves.
  std::vector<TargetSight> moving = Sights(12);
  for (int i = 0; i < 12; ++i) moving[i].range_m += 0.2 * i;
  EXPECT_THAT(LocateTarget(moving, kTolerance).why_not, HasSubstr("stands still"));
}

}  // namespace
}  // namespace sonarcal::calib
