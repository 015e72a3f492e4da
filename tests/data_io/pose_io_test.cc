#include "data_io/pose_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/posed_recording.h"
#include "tests/data_io/refusal.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;
using testing::TempDir;
using testing::WriteFile;

constexpr std::string_view kPose =
    R"("world_from_sonar": {"position_m": [1, 2, 3], "quaternion_wxyz": [0, 0, 0, 1]})";

TEST(PoseIoTest, WrittenPosesReadBackExactly) {
  const TempDir dir;
  const std::vector<TimedPose> poses = {{0.5, {RotationFromYawPitchRoll(0.3, -0.2, 0.1), {1.0, -2.0, 3.0}}},
                                        {std::nullopt, Pose()}};
  WritePoses(dir / "poses.json", poses);
  const std::vector<TimedPose> read = ReadPosesOrRecording(dir / "poses.json");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].time_s, 0.5);
  EXPECT_EQ(read[0].world_from_sonar.position_m, poses[0].world_from_sonar.position_m);
  EXPECT_TRUE(read[0].world_from_sonar.rotation.isApprox(poses[0].world_from_sonar.rotation, 1e-15));
  EXPECT_FALSE(read[1].time_s);
}

TEST(PoseIoTest, CandidatesOfASearchReadBack) {
  const TempDir dir;
  TimedPose pose{.time_s = {}, .world_from_sonar = {}, .frame = 3};
  pose.candidates.push_back({.what = "the reversed target",
                             .world_from_sonar = {RotationFromYawPitchRoll(0.3, -0.2, 0.1), {1.0, -2.0, 3.0}},
                             .rms_difference = 0.00946,
                             .gain_db = -2.5,
                             .worse_by_nats = 1.5,
                             .worse_by_sigmas = 0.5,
                             .explains_as_well = true});
  pose.open = {"roll"};
  WritePoses(dir / "poses.json", {pose});
  const TimedPose read = ReadPoses(dir / "poses.json").at(0);
  EXPECT_EQ(read.frame, 3);
  EXPECT_EQ(read.open, pose.open);
  ASSERT_EQ(read.candidates.size(), 1u);
  EXPECT_EQ(read.candidates[0].what, "the reversed target");
  EXPECT_EQ(read.candidates[0].rms_difference, 0.00946);
  EXPECT_EQ(read.candidates[0].world_from_sonar.position_m, pose.candidates[0].world_from_sonar.position_m);
  EXPECT_TRUE(read.candidates[0].explains_as_well);
}

TEST(PoseIoTest, PosesReplaceThoseOfARecording) {
  RecordingInfo info;
  info.source = "rec";
  const auto recording = std::make_shared<MemoryRecording>(
      info, std::vector<Frame>{{{"a.png", 0.0, std::nullopt}, {}}, {{"b.png", 1.0, Pose()}, {}}});
  const Pose moved{Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0}};
  const auto posed = WithPoses(recording, {{{}, moved}, {{}, moved}}, "poses.json");
  EXPECT_EQ(posed->frame_info(0).world_from_sonar->position_m, moved.position_m);
  EXPECT_EQ(posed->ReadFrame(1).info.world_from_sonar->position_m, moved.position_m);
  EXPECT_EQ(MessageOf([&] {
              WithPoses(recording, {{{}, moved}}, "poses.json");
            }),
            "rec has 2 frames and poses.json has 1 poses, expected as many");
}

// Poses of a sonar that turns at 10 degrees per second while it moves along Y of the world.
std::vector<TimedPose> TurningPoses(int count) {
  std::vector<TimedPose> poses;
  for (int i = 0; i < count; ++i) {
    const double time_s = 0.1 * i;
    poses.push_back(
        {time_s, {RotationFromYawPitchRoll(RadFromDeg(10.0 * time_s), 0, 0), {0, 0.2 * time_s, 0}}});
  }
  return poses;
}

TEST(PoseIoTest, MotionFollowsFromThePosesBeforeAndAfter) {
  const PingPattern pings{.of_beam = {0, 1, 0, 1}, .period_s = 0.005};
  std::vector<TimedPose> poses = TurningPoses(5);
  poses[3].time_s = 5.0;
  poses[4].time_s = 5.1;
  const Motion stated{.velocity_m_per_s = {1.0, 0.0, 0.0}};
  poses[4].motion = stated;
  const std::vector<TimedPose> moving = WithMotion(poses, pings);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(moving[i].motion) << i;
    EXPECT_NEAR(DegFromRad(moving[i].motion->turn_rate_rad_per_s.z()), 10.0, 1e-9) << i;
    const Eigen::Vector3d in_world = poses[i].world_from_sonar.rotation * moving[i].motion->velocity_m_per_s;
    EXPECT_TRUE(in_world.isApprox(Eigen::Vector3d(0.0, 0.2, 0.0), 1e-9)) << i;
  }
  EXPECT_TRUE(moving[3].motion) << "from the pose after it";
  EXPECT_EQ(moving[4].motion, stated);
  EXPECT_FALSE(WithMotion({poses[0], poses[3]}, pings)[0].motion) << "too far apart";
  EXPECT_FALSE(WithMotion({poses[1], poses[0]}, pings)[0].motion) << "in reversed order";
  EXPECT_FALSE(WithMotion({poses[0]}, pings)[0].motion);
  EXPECT_FALSE(WithMotion(poses, {})[0].motion) << "frames of one ping";
}

// The trajectory stands still until 0.2 s. A frame at 0.195 s has its pings at 0.195 and 0.205 s.
TEST(PosedRecordingTest, GivesTheMotionBetweenThePingsOfAFrame) {
  RecordingInfo info;
  info.source = "rec";
  info.sonar.pings = {.of_beam = {0, 1, 0, 1}, .period_s = 0.01};
  const auto posed_at = [&](double time_s) {
    PosesOverTime poses{
        .world_from_body = {{0.0, Pose()}, {0.2, Pose()}, {0.4, {Pose().rotation, {0, 1, 0}}}}};
    const PosedRecording posed(
        std::make_unique<MemoryRecording>(info, std::vector<Frame>{{{"a", time_s, std::nullopt}, {}}}),
        poses);
    return posed.frame_info(0).motion;
  };
  EXPECT_NEAR(posed_at(0.1)->velocity_m_per_s.norm(), 0.0, 1e-9);
  EXPECT_NEAR(posed_at(0.195)->velocity_m_per_s.y(), 2.5, 1e-9);
  EXPECT_NEAR(posed_at(0.3)->velocity_m_per_s.y(), 5.0, 1e-9);
  EXPECT_EQ(posed_at(0.395), std::nullopt) << "the last ping lies beyond the trajectory";
  info.sonar.pings.period_s = 1e-9;
  EXPECT_NEAR(posed_at(0.3)->velocity_m_per_s.y(), 5.0, 1e-4);
  info.sonar.pings = {};
  EXPECT_EQ(posed_at(0.3), std::nullopt);
}

// Two poses of almost the same time are a mistake of the trajectory. The frame keeps its pose.
TEST(PosedRecordingTest, AMotionTooFastForAnySonarIsLeftOutWithANote) {
  RecordingInfo info;
  info.source = "rec";
  info.sonar.pings = {.of_beam = {0, 1, 0, 1}, .period_s = 0.01};
  const PosedRecording posed(
      std::make_unique<MemoryRecording>(
          info, std::vector<Frame>{{{"a", 0.1, std::nullopt}, {}}, {{"b", 0.195, std::nullopt}, {}}}),
      {.world_from_body = {{0.0, Pose()},
                           {0.2, Pose()},
                           {0.2001, {Pose().rotation, {0, 20, 0}}},
                           {0.4, {Pose().rotation, {0, 20, 0}}}}});
  EXPECT_TRUE(posed.frame_info(0).motion);
  EXPECT_TRUE(posed.frame_info(1).world_from_sonar);
  EXPECT_FALSE(posed.frame_info(1).motion);
  EXPECT_THAT(posed.info().notes, ::testing::Contains(HasSubstr("1 of 2 frames have a pose, but no motion")));
}

TEST(PosedRecordingTest, DropsTheMotionOfTheOldPoses) {
  RecordingInfo info;
  info.source = "rec";
  Frame frame{{"a", 0.1, Pose()}, {}};
  frame.info.motion = Motion{.velocity_m_per_s = {1.0, 0.0, 0.0}};
  const PosedRecording posed(std::make_unique<MemoryRecording>(info, std::vector<Frame>{frame}),
                             {.world_from_body = {{0.0, Pose()}, {0.4, Pose()}}});
  EXPECT_EQ(posed.frame_info(0).motion, std::nullopt);
  EXPECT_EQ(posed.ReadFrame(0).info.motion, std::nullopt);
}

TEST(PoseIoTest, MotionOfAPoseReadsBack) {
  const TempDir dir;
  std::vector<TimedPose> poses = TurningPoses(2);
  poses[1].motion =
      Motion{.velocity_m_per_s = {0.1, 0.0, 0.0}, .turn_rate_rad_per_s = {0, 0, RadFromDeg(7.5)}};
  WritePoses(dir / "poses.json", poses);
  const std::vector<TimedPose> read = ReadPoses(dir / "poses.json");
  EXPECT_EQ(read[0].motion, std::nullopt);
  EXPECT_EQ(read[1].motion, poses[1].motion);
}

TEST(PoseIoTest, AListAloneIsEnough) {
  const TempDir dir;
  WriteFile(dir / "p.json", fmt::format("[{{{}}}]", kPose));
  EXPECT_EQ(ReadPoses(dir / "p.json").at(0).world_from_sonar.rotation.z(), 1.0);
}

TEST(PoseIoTest, InvalidPosesAreRefusedWithLineAndKey) {
  const TempDir dir;
  const auto refusal_of = [&](const std::string& text) {
    WriteFile(dir / "p.json", text);
    return MessageOf([&] { ReadPoses(dir / "p.json"); });
  };
  EXPECT_THAT(refusal_of("[]"), HasSubstr("p.json:1: the document is empty, expected at least one pose"));
  EXPECT_THAT(refusal_of("{\"poses\": []}"), HasSubstr("required key 'format' is missing"));
  EXPECT_THAT(
      refusal_of(fmt::format("[\n{{{}, \"tiem_s\": 1}}]", kPose)),
      HasSubstr("p.json:2: unknown key '[0].tiem_s'; expected one of candidates, frame, motion, open, "
                "time_s, world_from_sonar"));
  EXPECT_THAT(
      refusal_of("[{\"world_from_sonar\": {\"position_m\": [0, 0], \"quaternion_wxyz\": [1, 0, 0, 0]}}]"),
      HasSubstr("'[0].world_from_sonar.position_m' has 2 numbers, expected 3"));
  EXPECT_THAT(
      refusal_of("[{\"world_from_sonar\": {\"position_m\": [0, 0, 0], \"quaternion_wxyz\": [0, 0, 0, 0]}}]"),
      HasSubstr("'[0].world_from_sonar.quaternion_wxyz' has length 0, expected a unit quaternion"));
}

TEST(PoseIoTest, ARecordingWithoutAPoseIsRefused) {
  RecordingInfo info;
  info.source = "rec";
  const MemoryRecording recording(info, {{{"a.png", 0.0, Pose()}, {}}, {{"b.png", 1.0, std::nullopt}, {}}});
  EXPECT_THAT(MessageOf([&] { PosesOfRecording(recording); }),
              HasSubstr("rec: frame 1 (b.png) has no 'world_from_sonar'"));
}

TEST(PoseIoTest, ATrajectoryIsReferredToConvert) {
  EXPECT_THAT(MessageOf([] { ReadPosesOrRecording("/gone/track.csv"); }), HasSubstr("convert --trajectory"));
}

TEST(PoseIoTest, TakesThePosesOfARecording) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
  const std::vector<TimedPose> poses = ReadPosesOrRecording(folder);
  ASSERT_EQ(poses.size(), 8u);
  EXPECT_EQ(poses[1].time_s, 1.0);
  EXPECT_NEAR(poses[0].world_from_sonar.position_m.x(), 9.156081083, 1e-12);
}

}  // namespace
}  // namespace sonarcal::data_io
