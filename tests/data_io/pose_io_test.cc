#include "data_io/pose_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"
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
  EXPECT_THAT(refusal_of(fmt::format("[\n{{{}, \"tiem_s\": 1}}]", kPose)),
              HasSubstr("p.json:2: unknown key '[0].tiem_s'; expected one of candidates, frame, open, "
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
