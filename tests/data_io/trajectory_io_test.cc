#include "data_io/trajectory_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/types/error.h"
#include "core/types/units.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::TempDir;

class TrajectoryTest : public ::testing::Test {
 protected:
  std::vector<TrajectoryPose> Read(const std::string& text) {
    testing::WriteFile(path_, text);
    return ReadTrajectory(path_, GuessTrajectoryFormat(path_));
  }
  std::string Refusal(const std::string& text) {
    try {
      Read(text);
    } catch (const DataError& error) {
      return error.what();
    }
    return {};
  }

  TempDir dir_;
  std::filesystem::path path_ = dir_ / "trajectory.txt";
};

// A quarter turn to the left about Z: 1/sqrt 2.
constexpr const char* kHalf = "0.70710678118654752";

TEST_F(TrajectoryTest, TheThreeFormatsSayTheSame) {
  const std::string h = kHalf;
  const auto tum = Read("# timestamp tx ty tz qx qy qz qw\n100.5 1 -2  3.5 0 0 " + h + " " + h +
                        "\r\n101.5\t1 2 3 0 0 0 1\n");
  const auto euroc = Read("#timestamp [ns],p_RS_R_x [m],...\n100500000000,1,-2,3.5," + h + ",0,0," + h +
                          ",0.1,0.2,0.3\n101500000000,1,2,3,1,0,0,0\n");
  const auto csv = Read("x_m, y_m, z_m, time_s, quality, qw, qx, qy, qz\n1,-2,3.5,100.5,9," + h + ",0,0," +
                        h + "\n\n1,2,3,101.5,9,1,0,0,0\n");
  const auto angles =
      Read("#time_s,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n100.5,1,-2,3.5,90,0,0\n101.5,1,2,3,0,0,0");
  for (const auto* trajectory : {&tum, &euroc, &csv, &angles}) {
    ASSERT_EQ(trajectory->size(), 2U);
    const TrajectoryPose& first = trajectory->front();
    EXPECT_EQ(first.time_s, 100.5);
    EXPECT_EQ(first.world_from_body.position_m, Eigen::Vector3d(1.0, -2.0, 3.5));
    // Ahead (Y) points to the world's -X after a quarter turn to the left.
    EXPECT_LT((first.world_from_body.rotation * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitX()).norm(),
              1e-12);
  }
}

TEST_F(TrajectoryTest, PosesBetweenTwoAreOnTheLineAndTheTurn) {
  const auto trajectory = Read(
      "#time_s,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n10,0,0,0,170,0,0\n12,4,2,0,-170,0,0\n20,0,0,0,0,0,0");
  const Pose middle = PoseAt(trajectory, 10.5, 2.5).value();
  EXPECT_LT((middle.position_m - Eigen::Vector3d(1.0, 0.5, 0.0)).norm(), 1e-12);
  // The shorter way, over 180 degrees.
  EXPECT_NEAR(DegFromRad(YawPitchRollFromRotation(middle.rotation)(0)), 175.0, 1e-9);
  EXPECT_TRUE(PoseAt(trajectory, 12.0, 0.1));
  EXPECT_EQ(PoseAt(trajectory, 20.0, 0.1)->position_m, Eigen::Vector3d::Zero());
  EXPECT_FALSE(PoseAt(trajectory, 15.0, 2.5));  // a gap of 8 s
  EXPECT_FALSE(PoseAt(trajectory, 9.999, 2.5));
  EXPECT_FALSE(PoseAt(trajectory, 20.001, 2.5));
  EXPECT_FALSE(PoseAt(trajectory, std::nan(""), 2.5));
}

TEST_F(TrajectoryTest, InvalidRowsAreRefusedWithTheirLine) {
  EXPECT_THAT(Refusal("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), HasSubstr(":2: time 1.000000 s after"));
  EXPECT_THAT(Refusal("1 0 0 0 0 0 0 1\n2 0 nan 0 0 0 0 1\n"),
              HasSubstr(":2: y is 'nan', expected a finite"));
  EXPECT_THAT(Refusal("1 0 0 0 0 0 0 0.9\n"), HasSubstr(":1: the quaternion has length 0.9"));
  EXPECT_THAT(Refusal("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n"), HasSubstr("7 columns, expected qw in column 8"));
  EXPECT_THAT(Refusal("1.5,0,0,0,1,0,0,0\n"), HasSubstr("expected whole nanoseconds"));
  EXPECT_THAT(Refusal("time_s,x_m,y_m\n1,2,3\n"), HasSubstr("0 columns are named 'z_m'"));
  EXPECT_THAT(Refusal("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n"), HasSubstr("no pose"));
  EXPECT_THAT(Refusal(""), HasSubstr("no trajectory"));
}

TEST_F(TrajectoryTest, DamagedTextEndsInOneSentence) {
  const std::string text =
      "#time_s,x_m,y_m,z_m,qw,qx,qy,qz\n1,0.5,1e3,-2,1,0,0,0\n2,0.5,1e3,-2,1,0,0,0\n3,0,0,0,0,1,0,0\n";
  for (unsigned seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = text.substr(0, seed % 5 == 0 ? random() % text.size() : text.size());
    for (unsigned i = 0; i <= seed % 4 && !damaged.empty(); ++i)
      damaged[random() % damaged.size()] = static_cast<char>(random());
    try {
      for (const TrajectoryPose& pose : Read(damaged)) EXPECT_TRUE(std::isfinite(pose.time_s));
    } catch (const DataError& error) {
      EXPECT_STRNE(error.what(), "");
    }
  }
}

TEST_F(TrajectoryTest, AMountTurnsTheBodysAxesIntoTheSonars) {
  testing::WriteFile(path_, R"({"format": "sonar-mount/1", "body_from_sonar":
      {"position_m": [0.3, 0, -0.1], "quaternion_wxyz": [0.7071067811865476, 0, 0, -0.7071067811865476]}})");
  const Pose mount = ReadMount(path_);
  // Ahead of the sonar is the body's X, its right the body's -Y.
  EXPECT_LT((mount * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(1.3, 0, -0.1)).norm(), 1e-12);
  EXPECT_LT((mount * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.3, -1, -0.1)).norm(), 1e-12);
  testing::WriteFile(path_, R"({"format": "sonar-mount/2"})");
  EXPECT_THROW(ReadMount(path_), DataError);
}

}  // namespace
}  // namespace sonarcal::data_io
