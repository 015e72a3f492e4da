// ROS bags as a user converts them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/recordings/recording_io.h"
#include "tests/apps/run_program.h"
#include "tests/data_io/made_up_mcap.h"
#include "tests/data_io/sonar_messages.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::MadeUpProjected;
using testing::MessageWriter;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::Wire;

std::string Odometry(Wire wire, std::uint32_t seconds, double x_m) {
  MessageWriter message(wire);
  message.Header(seconds, 0, "odom").String("base_link");
  message.F64(x_m).F64(0.0).F64(-2.0).F64(0.0).F64(0.0).F64(0.0).F64(1.0);
  for (int i = 0; i < 36 + 6 + 36; ++i) message.F64(0.0);
  return message.bytes();
}

std::string Transform(Wire wire, std::uint32_t seconds, double y_m) {
  MessageWriter message(wire);
  message.U32(1).Header(seconds, 0, "map").String("sonar").F64(0.0).F64(y_m).F64(0.0);
  message.F64(0.0).F64(0.0).F64(0.0).F64(1.0);
  return message.bytes();
}

// Two pings of /sonar at 100.25 and 101.25 s, one of /spare; odometry along X from 100 s on, 4 m a second;
// transforms along Y likewise, 1 m a second.
class ConvertBagTest : public ::testing::TestWithParam<Wire> {
 protected:
  ConvertBagTest() : bag_(dir_ / (GetParam() == Wire::kRos1 ? "dive.bag" : "dive.db3")) {
    const Wire wire = GetParam();
    const char* type = "marine_acoustic_msgs/ProjectedSonarImage";
    std::vector<testing::MadeUpMessage> messages = {
        {"/sonar", type, 1, MadeUpProjected{.seconds = 100}.Write(wire)},
        {"/sonar", type, 2, MadeUpProjected{.seconds = 101}.Write(wire)},
        {"/spare", type, 3, MadeUpProjected{}.Write(wire)}};
    for (const std::uint32_t time : {100U, 101U}) {
      messages.push_back({"/odom", "nav_msgs/Odometry", time, Odometry(wire, time, 4.0 * (time - 100))});
      messages.push_back({"/tf", "tf2_msgs/TFMessage", time, Transform(wire, time, time - 100.0)});
    }
    if (wire == Wire::kRos1) {
      testing::WriteFile(bag_, testing::Ros1BagBytes(messages, {.compression = "bz2"}));
    } else {
      testing::WriteRos2Bag(bag_, messages);
    }
    testing::WriteFile(dir_ / "mount.json", R"({"format": "sonar-mount/1", "body_from_sonar":
        {"position_m": [0.5, 0, 0], "quaternion_wxyz": [0.7071068, 0, 0, -0.7071068]}})");
  }

  Outcome Convert(const std::string& arguments) {
    return RunSonarcal("convert " + Quoted(bag_) + " --out " + Quoted(dir_ / "out") + " " + arguments);
  }

  testing::TempDir dir_;
  std::filesystem::path bag_;
};

TEST_P(ConvertBagTest, PosesComeFromATopicAndAMount) {
  const Outcome outcome = Convert("--topic /sonar --pose-topic /odom --mount " + Quoted(dir_ / "mount.json"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("2 frames, 1 with a pose"));
  const auto converted = data_io::OpenRecordingFolder(dir_ / "out");
  const auto pose = converted->frame_info(0).world_from_sonar;
  ASSERT_TRUE(pose);
  // A quarter of a second in, and half a metre ahead on a body whose X points ahead.
  EXPECT_LT((pose->position_m - Eigen::Vector3d(1.5, 0.0, -2.0)).norm(), 1e-6);
  EXPECT_LT((pose->rotation * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitX()).norm(), 1e-6);
  EXPECT_FALSE(converted->frame_info(1).world_from_sonar);  // after the last odometry
  EXPECT_THAT(testing::ReadFile(dir_ / "out" / "provenance.json"), HasSubstr("\"pose_topic\": \"/odom\""));
}

TEST_P(ConvertBagTest, PosesComeFromTransforms) {
  const Outcome outcome = Convert("--topic /sonar --pose-topic /tf --pose-frames map:sonar");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto pose = data_io::OpenRecordingFolder(dir_ / "out")->frame_info(0).world_from_sonar;
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->position_m - Eigen::Vector3d(0.0, 0.25, 0.0)).norm(), 1e-6);
}

TEST_P(ConvertBagTest, MissingTopicsAndFramesAreRefusedByName) {
  const Outcome several = Convert("");
  EXPECT_EQ(several.status, 1);
  EXPECT_THAT(several.err, HasSubstr("2 topics of sonars"));
  EXPECT_EQ(Convert("--topic /sonar --pose-topic /tf").status, 1);
  EXPECT_EQ(Convert("--topic /sonar --pose-topic /tf --pose-frames map").status, 2);
  EXPECT_EQ(Convert("--topic /sonar --pose-frames map:sonar").status, 2);
  EXPECT_EQ(Convert("--topic /sonar --pose-topic /odom --trajectory x.csv").status, 2);
  EXPECT_EQ(RunSonarcal("inspect --topic /sonar " + Quoted(dir_ / "mount.json")).status, 2);
  const Outcome page = RunSonarcal("inspect --topic /spare " + Quoted(bag_));
  EXPECT_EQ(page.status, 0) << page.err;
  EXPECT_THAT(page.out, HasSubstr("other topic /odom"));
}

// A recording that a crash ended in the middle of the third ping.
TEST(ConvertMcapTest, ATruncatedFileIsSalvaged) {
  const testing::TempDir dir;
  std::vector<testing::MadeUpMessage> messages;
  for (std::uint32_t i = 0; i < 4; ++i) {
    messages.push_back({"/sonar", "marine_acoustic_msgs/ProjectedSonarImage", i,
                        MadeUpProjected{.seconds = 100 + i}.Write(Wire::kCdrLittle)});
  }
  testing::MadeUpMcapPlaces places;
  const std::string bytes = testing::McapBytes(messages, {.messages_a_chunk = 1}, &places);
  testing::WriteFile(dir / "cut.mcap", bytes.substr(0, places.message_index[2] - 20));
  const std::string arguments = Quoted(dir / "cut.mcap") + " --out " + Quoted(dir / "out");
  const Outcome whole = RunSonarcal("convert " + arguments);
  EXPECT_EQ(whole.status, 1);
  EXPECT_THAT(whole.err, HasSubstr("are there: the file was cut off"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  const Outcome salvaged = RunSonarcal("convert --salvage " + arguments);
  EXPECT_EQ(salvaged.status, 0) << salvaged.err;
  EXPECT_THAT(salvaged.out, HasSubstr("2 frames, 1 left out that could not be read"));
  EXPECT_EQ(data_io::OpenRecordingFolder(dir / "out")->frame_count(), 2);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ConvertBagTest, ::testing::Values(Wire::kRos1, Wire::kCdrLittle));

}  // namespace
}  // namespace sonarcal::commands
