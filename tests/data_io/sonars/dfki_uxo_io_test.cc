#include "data_io/sonars/dfki_uxo_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/sonars/aris_beam_tables.h"
#include "data_io/images/pgm_codec.h"
#include "data_io/open_recording.h"
#include "data_io/sonars/frame_tree.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

constexpr int kRanges = 6;
constexpr int kBeams = 64;

// The chain of the published calibration.
constexpr const char* kTransforms = R"(setup:
  - frame_id: "setup/ar3"
    parent_frame_id: "setup/portal_crane"
    translation:
      x: 0.0
      y: 0.174
      z: -0.338
    rotation:
      x: 0.0
      y: 1.0
      z: 0.0
      w: 0.0
  - frame_id: "setup/aris"  # the housing
    parent_frame_id: "setup/ar3"
    translation:
      x: 0.0
      y: 0.0
      z: 0.0
    rotation:
      # x: 9.0
      x: 0.0
      y: 0.0
      z: 0.0
      w: 1.0
  - frame_id: "setup/sonar"
    parent_frame_id: "setup/aris"
    translation:
      x: -0.108725
      y: 0.0
      z: 0.0
    rotation:
      x: 0.5
      y: 0.5
      z: 0.5
      w: 0.5
targets:
  - frame_id: "target/100lbs"
    parent_frame_id: "world"
    translation:
      x: 1.251079
      y: 1.592704
      z: -1.489828
    rotation:
      x: 0.0
      y: 0.0
      z: 0.0
      w: 1.0)";

// Two rows that the data set's own notebook shows, and one frame that the arm's table does not have.
constexpr const char* kArm =
    "aris_frame_idx,pos.x,pos.y,pos.z,rot.x,rot.y,rot.z,rot.w\n"
    "622,0.165015,1.173479,-1.088,0.929728,0.314956,-0.180721,0.061221\n"
    "1339,2.149295,0.939294,-1.088,0.216127,0.957539,-0.042011,0.186127\n";

constexpr const char* kColumns =
    "FrameIndex,FrameTime,WindowStart,WindowLength,ReceiverGain,WaterTemp,PingMode,FrequencyHiLow,PulseWidth,"
    "SamplePeriod,FrameRate,SoundSpeed,SamplesPerBeam,SampleStartDelay,LargeLens,TheSystemType,Salinity,"
    "Other\n";

std::string Row(int index, double sound_speed_m_per_s = 1480.0) {
  return fmt::format("{},{},0.7,0.02664,12,15.5,6,1,20,6,15.0,{},{},1000,0,1,0,-1\n", index,
                     1'695'222'665'000'000 + 1000 * index, sound_speed_m_per_s, kRanges);
}

// Pixel (row, col) is 10 row + col + frame mod 256.
std::string Pgm(int frame) {
  std::string bytes = fmt::format("P5\n# made up\n{} {}\n255\n", kBeams, kRanges);
  for (int row = 0; row < kRanges; ++row) {
    for (int col = 0; col < kBeams; ++col) bytes += static_cast<char>(10 * row + col + frame);
  }
  return bytes;
}

class DfkiUxoTest : public ::testing::Test {
 protected:
  DfkiUxoTest() : recording_(dir_ / "recordings" / "100lbs" / "2023-09-20_171105") {
    for (const auto& folder : {recording_ / "aris_raw", dir_ / "calibration"})
      std::filesystem::create_directories(folder);
    testing::WriteFile(dir_ / "calibration" / "transforms.yaml", kTransforms);
    testing::WriteFile(recording_ / "aris_frame_meta.csv", kColumns + Row(622) + Row(1339) + Row(1340));
    testing::WriteFile(recording_ / "ar3.csv", kArm);
    testing::WriteFile(recording_ / "gantry.csv",
                       "aris_frame_idx,x,y,z\n622,0.165015,0.999479,-0.75\n1339,2.149295,0.765294,-0.75\n");
    for (const char* frame : {"0622", "1339", "1340"})
      testing::WriteFile(recording_ / "aris_raw" / (std::string(frame) + ".pgm"), Pgm(std::stoi(frame)));
  }

  testing::TempDir dir_;
  std::filesystem::path recording_;
};

TEST_F(DfkiUxoTest, FramesAndSettingsAreRead) {
  const auto recording = OpenRecording(recording_);
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.sonar.name, "ARIS 3000");
  EXPECT_EQ(info.sonar.frequency_hz, 3.0e6);
  EXPECT_EQ(*info.scale.db_span, 80.0);
  EXPECT_THAT(info.details, Contains(Pair("receiver gain", "12 dB")));
  ASSERT_EQ(recording->frame_count(), 3);
  EXPECT_EQ(recording->frame_info(1).name, "1339.pgm");
  EXPECT_NEAR(*recording->frame_info(0).time_s, 1'695'222'665.622, 1e-6);
  const Frame frame = recording->ReadFrame(1);
  // Start 1000 us and 6 us a sample, there and back at 1480 m/s.
  EXPECT_NEAR(frame.image.axes.range_min_m, 0.74, 1e-9);
  EXPECT_NEAR(frame.image.axes.range_max_m, 0.74 + kRanges * 0.00444, 1e-9);
  EXPECT_EQ(frame.image.axes.beam_azimuth_rad,
            ArisAzimuthsRad(ArisBeamCentresDeg(ArisSystem::kAris3000, kBeams, ArisLens::kStandard)));
  // Beams are stored from the right.
  EXPECT_EQ(frame.image.value(2, 0), (10 * 2 + (kBeams - 1) + 1339) % 256);
  EXPECT_EQ(frame.image.value(5, kBeams - 1), (10 * 5 + 1339) % 256);
}

// With the published numbers, the sonar stands upright and has its target within the 15 degrees to either
// side that it sees, from both ends of the trajectory.
TEST_F(DfkiUxoTest, ThePublishedPosesLookAtTheirTarget) {
  const auto recording = OpenRecording(recording_);
  const Eigen::Vector3d target_m(1.251079, 1.592704, -1.489828);
  for (const int frame : {0, 1}) {
    const auto pose = recording->frame_info(frame).world_from_sonar;
    ASSERT_TRUE(pose);
    const Eigen::Vector3d target_in_sonar_m = pose->Inverse() * target_m;
    EXPECT_GT(target_in_sonar_m.y(), 1.0);
    EXPECT_LT(std::abs(std::atan2(target_in_sonar_m.x(), target_in_sonar_m.y())), 0.33);
    EXPECT_GT((pose->rotation * Eigen::Vector3d::UnitZ()).z(), 0.9);
    EXPECT_NEAR((pose->rotation * Eigen::Vector3d::UnitX()).z(), 0.0, 1e-3);
  }
  // 0.108725 m behind the arm, along the axis that it looks along.
  const auto pose = recording->frame_info(0).world_from_sonar;
  const Eigen::Vector3d arm_m(0.165015, 1.173479, -1.088);
  EXPECT_LT((pose->position_m + 0.108725 * (pose->rotation * Eigen::Vector3d::UnitY()) - arm_m).norm(), 1e-6);
  EXPECT_FALSE(recording->frame_info(2).world_from_sonar);
  EXPECT_THAT(recording->info().notes, Contains("1 frames are not in ar3.csv: no pose."));
  EXPECT_THAT(recording->info().notes, Each(Not(HasSubstr("gantry.csv"))));
  EXPECT_THAT(recording->info().details,
              Contains(Pair("target", HasSubstr("100lbs at (1.25108, 1.5927, -1.48983)"))));
}

TEST_F(DfkiUxoTest, TheTargetIsFoundHoweverTheFolderIsNamed) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(recording_);
  for (const std::filesystem::path& path : {recording_, recording_ / "", std::filesystem::path("."),
                                            std::filesystem::path("./"), ".." / recording_.filename()}) {
    EXPECT_THAT(OpenRecording(path)->info().details, Contains(Pair("target", HasSubstr("100lbs at ("))))
        << path;
  }
  std::filesystem::current_path(before);
}

TEST_F(DfkiUxoTest, MissingAndContradictoryFilesAreNoted) {
  testing::WriteFile(recording_ / "gantry.csv", "aris_frame_idx,x,y,z\n622,0.165015,0.999479,-0.7\n");
  std::filesystem::remove(recording_ / "aris_raw" / "1340.pgm");
  const auto recording = OpenRecording(recording_);
  EXPECT_EQ(recording->frame_count(), 2);
  EXPECT_THAT(recording->info().notes,
              Contains(HasSubstr("In 1 frames the arm's position in gantry.csv differs")));
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("1 frames have no picture")));
  std::filesystem::remove_all(dir_ / "calibration");
  const auto without = OpenRecording(recording_);
  EXPECT_FALSE(without->frame_info(0).world_from_sonar);
  EXPECT_THAT(without->info().notes, Contains(HasSubstr("transforms.yaml: frames have no pose")));
}

TEST_F(DfkiUxoTest, DamageIsRefusedByName) {
  const auto refusal_with = [&](const std::filesystem::path& file, const std::string& bytes) {
    const std::string whole = testing::ReadFile(file);
    testing::WriteFile(file, bytes);
    std::string refusal = testing::RefusalOf(recording_);
    testing::WriteFile(file, whole);
    return refusal;
  };
  const auto table = recording_ / "aris_frame_meta.csv";
  EXPECT_THAT(refusal_with(table, kColumns + Row(622, 900.0)),
              HasSubstr("aris_frame_meta.csv:2: SoundSpeed is '900', expected a number within 1300..1700"));
  EXPECT_THAT(refusal_with(table, "FrameIndex\n622\n"), HasSubstr(":1: no column 'FrameTime'"));
  EXPECT_THAT(refusal_with(table, kColumns + Row(622) + "1,2\n"), HasSubstr(":3: 2 cells, expected 18"));
  EXPECT_THAT(refusal_with(table, kColumns + Row(7)), HasSubstr("none of the 1 frames"));
  const auto picture = recording_ / "aris_raw" / "1339.pgm";
  EXPECT_THAT(refusal_with(picture, "P5 64 7 255 "),
              HasSubstr("7 rows x 64 columns up to 255, expected 6 x 64"));
  EXPECT_THAT(refusal_with(picture, "P5 64 6 255 ..."), HasSubstr("3 bytes of pixels, expected 384"));
  EXPECT_THAT(refusal_with(recording_ / "ar3.csv",
                           "aris_frame_idx,pos.x,pos.y,pos.z,rot.x,rot.y,rot.z,rot.w\n"
                           "622,0,0,0,0,0,0,0.5\n"),
              HasSubstr("ar3.csv:2: a quaternion of length 0.5"));
  std::string yaml = kTransforms;
  yaml.replace(yaml.find("0.174"), 5, "south");
  EXPECT_THAT(refusal_with(dir_ / "calibration" / "transforms.yaml", yaml),
              HasSubstr("transforms.yaml:6: setup.translation.y is 'south'"));
}

TEST_F(DfkiUxoTest, DamagedFilesEndInOneSentence) {
  for (const auto& file :
       {recording_ / "aris_frame_meta.csv", recording_ / "ar3.csv", recording_ / "gantry.csv",
        dir_ / "calibration" / "transforms.yaml", recording_ / "aris_raw" / "1339.pgm"})
    testing::ExpectOnlyDataErrors(recording_, file, testing::ReadFile(file), 400);
}

TEST_F(DfkiUxoTest, FramesAreFoundThroughChainsButNotThroughCircles) {
  const FrameTree tree(dir_ / "calibration" / "transforms.yaml");
  // A half turn about Y: the housing's 0.1 m behind lie 0.1 m ahead of the crane.
  const auto pose = tree.Find("setup/portal_crane", "setup/sonar");
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->position_m - Eigen::Vector3d(0.108725, 0.174, -0.338)).norm(), 1e-9);
  EXPECT_FALSE(tree.Find("world", "setup/sonar"));
  const auto circle = dir_ / "circle.yaml";
  std::string yaml = kTransforms;
  yaml.replace(yaml.find("setup/portal_crane"), 18, "setup/sonar");
  testing::WriteFile(circle, yaml);
  EXPECT_FALSE(FrameTree(circle).Find("world", "setup/sonar"));
}

}  // namespace
}  // namespace sonarcal::data_io
