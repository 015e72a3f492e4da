#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "apps/workflow/locate.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/fan_pictures.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"
#include "sim/scenes/scenes.h"
#include "sim/simulator.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"
#include "tests/calib/small_body.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TempDir;

// A body of revolution, recorded by the coherent model in two frames that state no pose.
class LocateCommandTest : public ::testing::Test {
 protected:
  LocateCommandTest() {
    const Scene body = sim::MakeBody({.max_edge_m = 0.04});
    data_io::WriteGltf(body, dir_ / "body.gltf");
    ParameterSet parameters = testing::BodyParameters();
    parameters.model = EchoModel::kCoherent;
    sim::SimulationOptions recorder;
    recorder.fan = {
        .sampling = sim::Sampling::kBeams, .cols = 56 * 4, .rows = 400, .elevation_span_deg = 28.0};
    const sim::Simulator simulator(body, testing::CoarseSonar(), recorder);
    RecordingInfo info;
    info.sonar = testing::CoarseSonar();
    info.scale.db_min = 0.0;
    info.scale.db_max = 40.0;
    info.synthetic = true;
    std::vector<Frame> frames;
    for (int i = 0; i < 2; ++i) {
      frames.push_back({{.name = "", .time_s = 1.0 * i, .world_from_sonar = {}},
                        simulator.Render(testing::BodyPose().WorldFromSonar(), parameters, i)});
      frames.back().image.scale = info.scale;
    }
    data_io::WriteRecording(MemoryRecording(info, frames), dir_ / "rec");
  }

  std::string Arguments(const std::string& more, const std::string& real = "rec") const {
    return "locate --real " + Quoted(dir_ / real) + " --target " + Quoted(dir_ / "body.gltf") +
           " --spacing 30 --starts 2 --ray-height 0.15 --max-iterations 10 --out " + Quoted(dir_ / "out") +
           more;
  }

  TempDir dir_;
};

TEST_F(LocateCommandTest, WritesFilesThatOtherCommandsRead) {
  const Outcome outcome = RunSonarcal(Arguments(" --frame 1"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("best"));
  EXPECT_THAT(outcome.out, HasSubstr("roll: the target is a body of revolution"));
  EXPECT_THAT(outcome.err, HasSubstr("start 1 of 2"));
  const data_io::TimedPose found = data_io::ReadPoses(dir_ / "out/poses.json").at(0);
  EXPECT_EQ(found.frame, 1);
  EXPECT_EQ(found.time_s, 1.0);
  ASSERT_FALSE(found.candidates.empty());
  EXPECT_EQ(found.candidates[0].what, "best");
  EXPECT_EQ(found.candidates[0].worse_by_nats, 0.0);
  EXPECT_NEAR(found.world_from_sonar.position_m.norm(), testing::BodyPose().range_m, 0.05);

  const auto posed = data_io::OpenRecording(dir_ / "out/recording");
  ASSERT_EQ(posed->frame_count(), 1);
  EXPECT_TRUE(posed->info().synthetic);
  EXPECT_TRUE(std::filesystem::exists(posed->info().scene_path.value()));
  EXPECT_TRUE(IsSamePose(posed->frame_info(0).world_from_sonar.value(), found.world_from_sonar));
  const std::string html = testing::ReadFile(dir_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_GT(testing::PicturesOf(html).size(), 6U);

  const Outcome simulated =
      RunSonarcal("simulate --expected --scene " + Quoted(dir_ / "out/scene.gltf") + " --sonar " +
                  Quoted(dir_ / "rec") + " --params " + Quoted(dir_ / "out/params.json") + " --poses " +
                  Quoted(dir_ / "out/poses.json") + " --out " + Quoted(dir_ / "sim"));
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const Outcome compared = RunSonarcal("compare --real " + Quoted(dir_ / "out/recording") + " --sim " +
                                       Quoted(dir_ / "sim") + " --out " + Quoted(dir_ / "cmp"));
  EXPECT_EQ(compared.status, 0) << compared.err;
}

// A picture of a viewer, of which only the farthest range is known.
TEST_F(LocateCommandTest, FindsTheTargetInABarePicture) {
  const auto recording = data_io::OpenRecording(dir_ / "rec");
  const data_io::FanPainter painter(recording->info(), {});
  data_io::WritePng(dir_ / "fan.png", painter.Paint(recording->ReadFrame(0)));
  testing::WriteFile(dir_ / "fan.png.geometry.json",
                     fmt::format(R"({{"format": "sonar-picture-geometry/1", "range_m": [{}]}})",
                                 recording->info().sonar.axes.range_max_m));
  const Outcome outcome = RunSonarcal(Arguments(" --frame 0", "fan.png"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("states no frequency"));
  const data_io::TimedPose found = data_io::ReadPoses(dir_ / "out/poses.json").at(0);
  EXPECT_NEAR(found.world_from_sonar.position_m.norm(), testing::BodyPose().range_m, 0.05);
}

TEST_F(LocateCommandTest, RefinesStartPosesOfAllFrames) {
  data_io::WritePoses(dir_ / "hand.json", {{{}, testing::BodyPose().WorldFromSonar()}});
  const Outcome outcome =
      RunSonarcal(Arguments(" --frame 0:2 --one-pose --json --poses " + Quoted(dir_ / "hand.json")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["poses"].size(), 2U);
  EXPECT_EQ(json["poses"][0]["world_from_sonar"], json["poses"][1]["world_from_sonar"]);
  const Outcome converted = RunSonarcal("convert " + Quoted(dir_ / "rec") + " --poses " +
                                        Quoted(dir_ / "out/poses.json") + " --out " + Quoted(dir_ / "posed"));
  ASSERT_EQ(converted.status, 0) << converted.err;
  EXPECT_THAT(converted.out, HasSubstr("2 frames, 2 with a pose"));
}

// A folder of DIDSON pings states a window with each ping.
TEST(LocateTest, RefusesAFrameWithOtherAxesThanTheRecording) {
  RecordingInfo info;
  info.sonar = testing::CoarseSonar();
  info.source = "rec";
  std::vector<Frame> frames;
  for (const int bins : {120, 60}) {
    PolarAxes axes = info.sonar.axes;
    axes.range_bins = bins;
    Grid<float> grey(bins, axes.beam_count(), 10.0F);
    frames.push_back({.info = {}, .image = {axes, info.scale, std::move(grey)}});
  }
  const MemoryRecording recording(info, std::move(frames));
  for (const bool one_pose : {false, true}) {
    workflow::LocateOptions options;
    options.one_pose = one_pose;
    try {
      workflow::Locate(recording, sim::MakeBody({.max_edge_m = 0.04}), {0, 1}, options);
      ADD_FAILURE() << "no error";
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), HasSubstr("rec: frame 1 and the recording have range bins 60 and 120"));
    }
  }
}

TEST_F(LocateCommandTest, AFailureIsOneSentence) {
  const auto refusal = [&](const std::string& more) {
    const Outcome outcome = RunSonarcal(Arguments(more));
    EXPECT_NE(outcome.status, 0) << more;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
    return outcome.err;
  };
  EXPECT_THAT(refusal(" --quiet --region-range 0.85:0.95 --region-azimuth 11:13"),
              HasSubstr("no pixel of the region of interest"));
  EXPECT_THAT(refusal(" --frame 7"), HasSubstr("7"));
  EXPECT_THAT(refusal(" --floor-material sand"), HasSubstr("no material 'sand'"));
  EXPECT_THAT(refusal(" --floor 1 --floor-material body"), HasSubstr("expected one of them"));
}

}  // namespace
}  // namespace sonarcal::commands
