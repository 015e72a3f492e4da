// The program as a shell sees it: exit statuses, what goes to stdout and what to stderr.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "apps/cli/run_output.h"
#include "data_io/recordings/recording_io.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using ::testing::StartsWith;

// Three frames of three beams and four bins.
void WriteSmallRecording(const std::filesystem::path& folder, bool synthetic) {
  RecordingInfo info;
  info.sonar.name = "test sonar";
  info.sonar.frequency_hz = 900e3;
  info.sonar.axes = {1.0, 3.0, 4, {-0.1, 0.0, 0.1}};
  info.sonar.sound_speed_m_per_s = 1500.0;
  info.synthetic = synthetic;
  std::vector<Frame> frames;
  for (int i = 0; i < 3; ++i) {
    frames.push_back(
        {{"", 0.5 * i, std::nullopt}, {info.sonar.axes, info.scale, {4, 3, 10.0F * static_cast<float>(i)}}});
  }
  data_io::WriteRecording(MemoryRecording(info, std::move(frames)), folder);
}

void ExpectOneSentence(const std::string& text) {
  EXPECT_THAT(text, StartsWith("sonarcal: "));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

TEST(CommandTest, HelpAndVersionGoToStdout) {
  for (const char* arguments : {"--help", "--version", "inspect --help", "convert --help"}) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, 0) << arguments;
    EXPECT_THAT(outcome.out, Not(IsEmpty())) << arguments;
    EXPECT_THAT(outcome.err, IsEmpty()) << arguments;
  }
  EXPECT_THAT(RunSonarcal("inspect --help").out, HasSubstr("Usage: sonarcal inspect [OPTIONS] FILE..."));
}

TEST(CommandTest, WrongUsageIsOneSentenceAndStatusTwo) {
  for (const char* arguments : {"", "inspekt x", "--frobnicate", "inspect", "inspect --frobnicate x",
                                "convert x", "convert x --out"}) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.out, IsEmpty()) << arguments;
    ExpectOneSentence(outcome.err);
  }
  EXPECT_THAT(RunSonarcal("inspekt x").err, HasSubstr("unknown command 'inspekt'"));
}

TEST(CommandTest, BadDataIsOneSentenceAndStatusOne) {
  const Outcome outcome = RunSonarcal("inspect /nowhere/at/all");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, IsEmpty());
  ExpectOneSentence(outcome.err);
  EXPECT_THAT(outcome.err, HasSubstr("/nowhere/at/all"));
}

TEST(CommandTest, NumbersMustBeFiniteAndWithinLimits) {
  const testing::TempDir dir;
  const std::string fit = "fit --real a --scene b --params c --out " + Quoted(dir / "out");
  for (const char* option :
       {"--level-sigma nan", "--level-sigma -5", "--reject-beyond nan", "--diameter-mm nan"}) {
    const Outcome outcome = RunSonarcal(fit + " " + option);
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_THAT(outcome.err, HasSubstr("expected")) << option;
    ExpectOneSentence(outcome.err);
  }
}

// `ulimit -f` sends a signal at the write that exceeds it, which would end the program without a word.
TEST(CommandTest, AFileAboveTheLimitOfItsSizeIsASentence) {
  const testing::TempDir dir;
  const Outcome outcome = RunSonarcal("scenes --only tank --out " + Quoted(dir / "out"), "ulimit -f 1;");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("cannot be written: File too large"));
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(CommandTest, AnEmptyArgumentIsRefused) {
  for (const std::string arguments : {"", "inspect", "scenes --out", "scenes --log", "scenes --options"}) {
    const Outcome outcome = RunSonarcal(arguments + " ''");
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("' is empty, expected a value")) << arguments;
  }
}

TEST(CommandTest, AnOutputFolderIsNoLinkToNothing) {
  const testing::TempDir dir;
  std::filesystem::create_symlink("nowhere", dir / "link");
  const Outcome outcome = RunSonarcal("scenes --only tank --out " + Quoted(dir / "link"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("it is a link to nothing"));
}

TEST(CommandTest, AFullDiskEndsWithAFailureStatus) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  EXPECT_EQ(WEXITSTATUS(std::system((std::string(SONARCAL_BINARY) + " --help >/dev/full 2>&1").c_str())), 1);
}

TEST(InspectTest, ReportsTheContentsOfTheRecording) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "real", false);
  const Outcome outcome = RunSonarcal("inspect " + Quoted(dir / "real"));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part : {"test sonar, 900 kHz", "1 .. 3 m, 4 bins of 500 mm", "3 over 1 s, 2 a second"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  EXPECT_THAT(outcome.out, Not(HasSubstr("SYNTHETIC")));
}

TEST(InspectTest, ASyntheticRecordingIsCalledSynthetic) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "made", true);
  EXPECT_THAT(RunSonarcal("inspect " + Quoted(dir / "made")).out, HasSubstr("SYNTHETIC"));
  EXPECT_THAT(RunSonarcal("inspect --json " + Quoted(dir / "made")).out, HasSubstr("\"synthetic\": true"));
}

TEST(InspectTest, OneBadFileDoesNotHideTheOthers) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "real", false);
  const Outcome outcome = RunSonarcal("inspect /nowhere " + Quoted(dir / "real"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("test sonar"));
  ExpectOneSentence(outcome.err);
}

TEST(ConvertTest, TakesTheFramesAskedForAndSaysWhereTheyCameFrom) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "in", true);
  const std::string input = Quoted(dir / "in");
  const Outcome outcome = RunSonarcal("convert " + input + " --frames 1:3 --out " + Quoted(dir / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto converted = data_io::OpenRecordingFolder(dir / "out");
  ASSERT_EQ(converted->frame_count(), 2);
  EXPECT_TRUE(converted->info().synthetic);
  EXPECT_EQ(converted->ReadFrame(0).image.value(0, 0), 10.0F);
  const std::string provenance = testing::ReadFile(dir / "out" / "provenance.json");
  EXPECT_THAT(provenance, HasSubstr("\"first_frame\": 1"));
  EXPECT_THAT(provenance, HasSubstr("\"sha256\": "));

  ASSERT_EQ(RunSonarcal("convert " + input + " --frames 2:,0 --out " + Quoted(dir / "turned")).status, 0);
  const auto turned = data_io::OpenRecordingFolder(dir / "turned");
  ASSERT_EQ(turned->frame_count(), 2);
  EXPECT_EQ(turned->ReadFrame(0).image.value,
            data_io::OpenRecordingFolder(dir / "in")->ReadFrame(2).image.value);
  EXPECT_EQ(turned->ReadFrame(1).image.value,
            data_io::OpenRecordingFolder(dir / "in")->ReadFrame(0).image.value);
}

TEST(ConvertTest, FramesThatAreNotThereAreRefusedAndNothingIsWritten) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "in", false);
  const std::string arguments =
      "convert " + Quoted(dir / "in") + " --out " + Quoted(dir / "out") + " --frames ";
  EXPECT_EQ(RunSonarcal(arguments + "2:5").status, 1);
  EXPECT_EQ(RunSonarcal(arguments + "3").status, 1);
  EXPECT_EQ(RunSonarcal(arguments + "2:1").status, 2);
  EXPECT_EQ(RunSonarcal(arguments + "a:b").status, 2);
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

// Frames at 0, 0.5 and 1 s; the body moves along X by 2 m a second from 0.1 s of its own clock on.
TEST(ConvertTest, PosesComeFromATrajectoryAndAMount) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "in", true);
  testing::WriteFile(dir / "poses.csv",
                     "time_s,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n0.1,0,0,5,90,0,0\n"
                     "0.9,1.6,0,5,90,0,0\n");
  testing::WriteFile(dir / "mount.json", R"({"format": "sonar-mount/1", "body_from_sonar":
      {"position_m": [0, 0.25, 0], "quaternion_wxyz": [1, 0, 0, 0]}})");
  const std::string arguments =
      "convert " + Quoted(dir / "in") + " --trajectory " + Quoted(dir / "poses.csv") + " --out ";
  const Outcome outcome = RunSonarcal(arguments + Quoted(dir / "out") + " --mount " +
                                      Quoted(dir / "mount.json") + " --time-offset 0.1");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("3 frames, 2 with a pose"));
  const auto converted = data_io::OpenRecordingFolder(dir / "out");
  // The sonar lies 0.25 m ahead of the body, which looks along the world's -X.
  ASSERT_TRUE(converted->frame_info(1).world_from_sonar);
  EXPECT_LT((converted->frame_info(1).world_from_sonar->position_m - Eigen::Vector3d(0.75, 0.0, 5.0)).norm(),
            1e-9);
  EXPECT_FALSE(converted->frame_info(2).world_from_sonar);

  const Outcome apart = RunSonarcal(arguments + Quoted(dir / "apart") + " --time-offset 100");
  EXPECT_EQ(apart.status, 1);
  ExpectOneSentence(apart.err);
  EXPECT_THAT(apart.err, HasSubstr("the trajectory goes from 0.100 to 0.900 s"));
  EXPECT_FALSE(std::filesystem::exists(dir / "apart"));
  EXPECT_EQ(RunSonarcal("convert " + Quoted(dir / "in") + " --mount x --out y").status, 2);
}

TEST(RunOutputTest, AnInterruptionLeavesNothingBehind) {
  const testing::TempDir dir;
  RunOutput output(dir / "out", "convert", /*force=*/false);
  testing::WriteFile(output / "half.json", "{");
  ASSERT_FALSE(std::filesystem::is_empty(dir.path()));
  EXPECT_EQ(RemoveUnfinishedOutputs(), LeftOutputs::kRemoved);
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(RunOutputTest, AnInterruptionLeavesWhatIsKeptUntilItEnds) {
  const testing::TempDir dir;
  {
    RunOutput output(dir / "out", "calibrate", /*force=*/false, data_io::Aside::kAnew);
    testing::WriteFile(output / "half.json", "{");
    output.Keep();
    EXPECT_EQ(RemoveUnfinishedOutputs(), LeftOutputs::kKept);
    EXPECT_TRUE(std::filesystem::exists(output / "half.json"));
  }
  EXPECT_EQ(RemoveUnfinishedOutputs(), LeftOutputs::kNone) << "that run has ended";
  const RunOutput again(dir / "out", "calibrate", /*force=*/false, data_io::Aside::kFound);
  EXPECT_EQ(RemoveUnfinishedOutputs(), LeftOutputs::kKept) << "what a later run has found";
}

}  // namespace
}  // namespace sonarcal::cli
