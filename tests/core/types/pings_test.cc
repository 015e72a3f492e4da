#include "core/types/pings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/types/units.h"

namespace sonarcal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

PingPattern ThreePings() {
  return {.of_beam = {0, 1, 2, 0, 1, 2, 0}, .period_s = 0.01, .first_s = -0.005};
}

Motion Turning(double deg_per_s) {
  return {.velocity_m_per_s = {0.5, 0.0, 0.0}, .turn_rate_rad_per_s = {0.0, 0.0, RadFromDeg(deg_per_s)}};
}

TEST(Pings, EachPingHasItsBeamsAndItsPose) {
  const std::vector<PingPose> pings = PosesOfPings(ThreePings(), Turning(30.0));
  ASSERT_THAT(pings, SizeIs(3));
  EXPECT_THAT(pings[0].beams, ElementsAre(0, 3, 6));
  EXPECT_THAT(pings[2].beams, ElementsAre(2, 5));
  const double times_s[] = {-0.005, 0.005, 0.015};
  for (int ping = 0; ping < 3; ++ping) {
    const Pose& pose = pings[ping].frame_from_ping;
    EXPECT_NEAR(pose.position_m.x(), 0.5 * times_s[ping], 1e-12);
    EXPECT_NEAR(DegFromRad(YawPitchRollFromRotation(pose.rotation)(0)), 30.0 * times_s[ping], 1e-9);
  }
}

TEST(Pings, WithoutKnownMotionAllBeamsShareAPose) {
  EXPECT_THAT(PosesOfPings(ThreePings(), std::nullopt), IsEmpty());
  EXPECT_THAT(PosesOfPings(ThreePings(), Motion()), IsEmpty());
  EXPECT_THAT(PosesOfPings(PingPattern(), Turning(30.0)), IsEmpty());
  PingPattern untimed = ThreePings();
  untimed.period_s = 0.0;
  EXPECT_THAT(PosesOfPings(untimed, Turning(30.0)), IsEmpty());
}

TEST(Pings, APingWithoutBeamsIsLeftOut) {
  PingPattern pattern = ThreePings();
  pattern.of_beam = {0, 2, 0, 2};
  const std::vector<PingPose> pings = PosesOfPings(pattern, Turning(30.0));
  ASSERT_THAT(pings, SizeIs(2));
  EXPECT_NEAR(pings[1].frame_from_ping.position_m.x(), 0.5 * 0.015, 1e-12);
}

// Position on the straight line and rotation by the shortest turn, from the pose in the middle.
TEST(Pings, AMotionLeadsFromOnePoseToTheOther) {
  const Pose first{RotationFromYawPitchRoll(0.3, -0.2, 0.1), {1.0, 2.0, 3.0}};
  const Pose last{RotationFromYawPitchRoll(0.5, -0.1, 0.2), {1.2, 2.1, 2.9}};
  const Pose middle{first.rotation.slerp(0.5, last.rotation), 0.5 * (first.position_m + last.position_m)};
  const Motion motion = MotionBetween(first, last, middle, 0.4);
  EXPECT_TRUE((middle * motion.After(-0.2)).position_m.isApprox(first.position_m, 1e-12));
  EXPECT_LT((middle * motion.After(-0.2)).rotation.angularDistance(first.rotation), 1e-9);
  EXPECT_TRUE((middle * motion.After(0.2)).position_m.isApprox(last.position_m, 1e-12));
  EXPECT_LT((middle * motion.After(0.2)).rotation.angularDistance(last.rotation), 1e-9);
  EXPECT_THAT(PosesOfPings(ThreePings(), MotionBetween(first, first, first, 0.4)), IsEmpty());
}

TEST(Pings, BeamsComeFromTheImageOfTheirPing) {
  const std::vector<PingPose> pings = PosesOfPings(ThreePings(), Turning(30.0));
  const auto at_pose = [](const Pose& pose) {
    return Grid<float>(2, 7, static_cast<float>(pose.position_m.x()));
  };
  const Grid<float> image = RenderByPing(Pose(), pings, at_pose);
  for (int beam = 0; beam < 7; ++beam)
    EXPECT_FLOAT_EQ(image(1, beam), static_cast<float>(0.5 * (-0.005 + 0.01 * (beam % 3)))) << beam;
  EXPECT_EQ(RenderByPing(Pose(), {}, at_pose), at_pose(Pose()));
  Grid<float> other(3, 7);
  EXPECT_THROW(CopyBeams({0}, image, other), std::logic_error);
}

}  // namespace
}  // namespace sonarcal
