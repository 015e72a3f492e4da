// Choice of frames by information: cases in closed form, and the small tank. No image is read.
#include "calib/selection/frame_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "calib/selection/frame_information.h"
#include "core/math/pose_groups.h"
#include "core/types/units.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAre;

// A line a + b x, measured at x with a standard deviation of 0.1, priors of 1.
Eigen::MatrixXd OfLine(double x) {
  const Eigen::Vector2d slope(1.0, x);
  return slope * slope.transpose() / 0.01;
}

// Nats of measurements of the line at several x.
double NatsOfLine(const std::vector<double>& at) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(2, 2);
  for (const double x : at) sum += OfLine(x);
  return InformationNats(sum);
}

TEST(FrameChoice, NatsAreHalfTheLogDeterminant) {
  // det(1 + [[100, 0], [0, 0]]) = 101.
  EXPECT_NEAR(NatsOfLine({0.0}), 0.5 * std::log(101.0), 1e-12);
  // Both ends of -1..1: 1 + 200 on the diagonal, 0 beside it.
  EXPECT_NEAR(NatsOfLine({-1.0, 1.0}), std::log(201.0), 1e-12);
}

TEST(FrameChoice, TakesTheEndsOfALineAndBeatsAnEvenSpread) {
  std::vector<double> x;
  for (int i = 0; i <= 100; ++i) x.push_back(-1.0 + 0.02 * i);
  const std::vector<int> one_each(x.size(), 1);
  const InformationChoice choice = ChooseByInformation(
      one_each, [&](int pose, int) { return OfLine(x[pose]); }, {.max_frames = 4, .min_gain = 0.0});
  // The best design of a line has half its points at either end.
  EXPECT_THAT(choice.poses, UnorderedElementsAre(0, 1, 99, 100));
  std::vector<double> chosen;
  for (const int pose : choice.poses) chosen.push_back(x[pose]);
  EXPECT_GT(NatsOfLine(chosen), NatsOfLine({-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0}) + 0.2);
  EXPECT_NEAR(std::accumulate(choice.gains.begin(), choice.gains.end(), 0.0), NatsOfLine(chosen), 1e-12);
  EXPECT_FALSE(choice.ended_by_gain);
}

TEST(FrameChoice, EndsWhenAnotherFrameGainsLittle) {
  // Equal frames of one parameter: the gain of frame n + 1 is half of log((1 + (n + 1) i) / (1 + n i)), about
  // 1 / 2n. It falls below 0.02 at n = 25.
  const std::vector<int> frames(100, 1);
  const auto equal = [](int, int) { return Eigen::MatrixXd::Constant(1, 1, 1e6); };
  const InformationChoice choice = ChooseByInformation(frames, equal, {.max_frames = 100, .min_gain = 0.02});
  EXPECT_TRUE(choice.ended_by_gain);
  EXPECT_EQ(choice.poses.size(), 25U);
  EXPECT_NEAR(choice.next_gain, 0.5 * std::log(26.0 / 25.0), 1e-6);
  EXPECT_EQ(ChooseByInformation(frames, equal, {.max_frames = 8}).poses.size(), 8U);
  EXPECT_EQ(ChooseByInformation({1, 1}, equal).poses.size(), 2U);
  EXPECT_TRUE(ChooseByInformation({}, equal).poses.empty());
}

TEST(FrameChoice, HeldOutFramesLieAwayFromFittedPoses) {
  std::vector<Pose> poses;
  for (int i = 0; i < 9; ++i) poses.push_back({Eigen::Quaterniond::Identity(), {0.1 * i, 0.0, 0.0}});
  poses.push_back(poses[0]);
  // Frames 4 to 8 are farther from frame 0 than 1 to 3; the last frame repeats its pose.
  EXPECT_THAT(FramesAwayFrom({0}, poses, 5.0), ElementsAre(5, 6, 7, 8));
  // Only repeats are left.
  EXPECT_THAT(FramesAwayFrom({0}, {poses[0], poses[0]}, 5.0), ElementsAre(1));
}

ParameterSet Start() {
  ParameterSet start = testing::SmallTankAcousticTruth();
  start.receiver.noise_db.reset();
  return start;
}

class SmallTankFrames : public ::testing::Test {
 protected:
  SmallTankFrames() : simulator_(testing::SmallTank(), testing::SmallSonar(), testing::SmallTankOptions()) {}

  sim::Simulator simulator_;
};

TEST_F(SmallTankFrames, InformationNamesCurvesGeometryAndPoses) {
  const FrameInformation information(simulator_, Start(), testing::SmallTankPoses());
  EXPECT_THAT(information.names(),
              IsSupersetOf({"material.floor.gsab.A", "material.box.gsab.F_deg", "receiver.noise_db",
                            "geometry.range_offset_m", "geometry.range_scale", "geometry.azimuth_offset_deg",
                            "geometry.azimuth_scale", "pose.mount.yaw_deg"}));
  const std::vector<Eigen::MatrixXd> of = information.Of({0, 2});
  ASSERT_EQ(of.size(), 2U);
  EXPECT_EQ(of[0].rows(), static_cast<Eigen::Index>(information.names().size()));
  EXPECT_TRUE(of[0].isApprox(of[0].transpose(), 1e-9));
  // Positive semidefinite, and informative.
  EXPECT_EQ((of[0] + Eigen::MatrixXd::Identity(of[0].rows(), of[0].cols())).llt().info(), Eigen::Success);
  EXPECT_GT(InformationNats(of[0]), 5.0);
  // A repeat adds less than another frame of the same information, because it shares the speckle.
  const double gain_of_repeat = InformationNats(of[0] + information.Of({0}, {1}).front());
  EXPECT_LT(gain_of_repeat, InformationNats(2.0 * of[0]) - 1.0);
  EXPECT_GT(gain_of_repeat, InformationNats(of[0]));
}

TEST_F(SmallTankFrames, ManyRepeatsOfOnePoseLeaveTheOtherPoses) {
  const std::vector<Pose> four = testing::SmallTankPoses();
  std::vector<Pose> poses(60, four[0]);
  poses[13] = four[1];
  poses[30] = four[2];
  poses[47] = four[3];
  const std::vector<std::vector<int>> groups = GroupByPose(poses);
  ASSERT_EQ(groups.size(), 4U);
  std::vector<Pose> distinct;
  std::vector<int> counts;
  for (const std::vector<int>& group : groups) {
    distinct.push_back(poses[group.front()]);
    counts.push_back(static_cast<int>(group.size()));
  }
  const FrameInformation information(simulator_, Start(), distinct);
  const InformationChoice choice = ChooseByInformation(counts, information, {.max_frames = 4});
  EXPECT_THAT(choice.poses, UnorderedElementsAre(0, 1, 2, 3));
}

TEST_F(SmallTankFrames, TheChoiceIsDeterministicAndBeatsAnEvenSpread) {
  // Most of a path shows the floor alone; its end turns to the box.
  std::vector<Pose> path;
  for (int i = 0; i < 48; ++i) {
    const double along = i / 47.0;
    path.push_back({RotationFromYawPitchRoll(RadFromDeg(i < 40 ? 180.0 : 0.0), RadFromDeg(-25.0), 0.0),
                    {0.8 * along, -2.8 + 0.3 * along, 1.2}});
  }
  const std::vector<int> one_each(path.size(), 1);
  const FrameInformation information(simulator_, Start(), path);
  const InformationChoice choice = ChooseByInformation(one_each, information, {.max_frames = 6});
  const FrameInformation again(simulator_, Start(), path);
  const InformationChoice second = ChooseByInformation(one_each, again, {.max_frames = 6});
  EXPECT_EQ(choice.poses, second.poses);
  EXPECT_EQ(choice.gains, second.gains);
  const auto nats = [&](const std::vector<int>& poses) {
    const std::vector<Eigen::MatrixXd> of = information.Of(poses);
    Eigen::MatrixXd sum = of.front();
    for (std::size_t i = 1; i < of.size(); ++i) sum += of[i];
    return InformationNats(sum);
  };
  ASSERT_EQ(choice.poses.size(), 6U);
  EXPECT_GT(nats(choice.poses), nats({0, 9, 18, 28, 37, 47}) + 1.0);
}

}  // namespace
}  // namespace sonarcal::calib
