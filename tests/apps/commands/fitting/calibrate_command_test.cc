// `calibrate` on a tiny SYNTHETIC recording whose sonar is declared a little wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/workflow/calibration/calibrate.h"
#include "apps/workflow/calibration/calibration_plan.h"
#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOneSentence;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;

constexpr double kTrueOffsetM = -0.06;  // of the sonar that records

// Recorded by the acoustic model with a sonar whose window starts elsewhere than the declared one.
class CalibrateCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    world_ = new TinyWorld();
    ParameterSet truth = testing::TinyAcousticParameters();
    data_io::WriteParameters(world_->params(), truth);
    data_io::WritePoses(world_->poses(), Around());
    nlohmann::json sonar = ReadJsonFile(world_->sonar());
    const nlohmann::json declared = sonar;
    for (const char* key : {"range_min_m", "range_max_m"})
      sonar["sonar"][key] = sonar["sonar"][key].get<double>() + kTrueOffsetM;
    testing::WriteFile(world_->sonar(), sonar.dump());
    ASSERT_EQ(
        RunSonarcal(world_->SimulateArguments() + " -q --noise --seed 3 --out " + Quoted(*world_ / "real"))
            .status,
        0);
    nlohmann::ordered_json recording =
        nlohmann::ordered_json::parse(testing::ReadFile(*world_ / "real/recording.json"));
    for (const char* key : {"range_min_m", "range_max_m"}) recording["sonar"][key] = declared["sonar"][key];
    testing::WriteFile(*world_ / "real/recording.json", recording.dump());
  }
  // Places around the box, in different directions and heights: three of them do not tell the sonar from its
  // poses.
  static std::vector<data_io::TimedPose> Around() {
    std::vector<data_io::TimedPose> poses;
    for (int i = 0; i < kPoses; ++i) {
      const double turn_rad = RadFromDeg(360.0 * i / kPoses);
      poses.push_back({static_cast<double>(i),
                       {RotationFromYawPitchRoll(turn_rad, RadFromDeg(-15.0 - 5.0 * (i % 3)), 0.0),
                        {2.4 * std::sin(turn_rad), -2.4 * std::cos(turn_rad), 0.8 + 0.2 * (i % 3)}}});
    }
    return poses;
  }
  static constexpr int kPoses = 9;

  static void TearDownTestSuite() { delete world_; }

  static std::string Arguments(const std::string& out, const std::string& extra = "",
                               const std::string& real = "real") {
    return "calibrate -q --rays 96x200 --real " + Quoted(*world_ / real) + " --scene " +
           Quoted(world_->scene()) + " --out " + Quoted(*world_ / out) + " " + extra;
  }

  static TinyWorld* world_;
};

TinyWorld* CalibrateCommand::world_ = nullptr;

TEST_F(CalibrateCommand, FindsTheOffsetOfTheWindowAndRepeatsItselfFromItsPlan) {
  const Outcome outcome = RunSonarcal(Arguments("out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("which is the lowest error possible"));
  const RecordingInfo sonar = data_io::ReadSonarFile(*world_ / "out/sonar.json");
  EXPECT_NEAR(sonar.sonar.axes.range_min_m, 0.5 + kTrueOffsetM, 0.02);
  EXPECT_EQ(testing::HtmlFault(testing::ReadFile(*world_ / "out/report.html")), "");
  EXPECT_EQ(data_io::ReadPoses(*world_ / "out/poses.json").size(), static_cast<std::size_t>(kPoses));
  // The search sees a wrong window, and still keeps the pattern that recorded, which is the default.
  EXPECT_EQ(data_io::ReadParameters(*world_ / "out/params.json").beam.elevation_pattern,
            testing::TinyAcousticParameters().beam.elevation_pattern);
  EXPECT_FALSE(std::filesystem::exists(*world_ / "out/started.json"));

  // Its plan names every stage with a reason, and gives the same values again.
  const workflow::CalibrationPlan plan = workflow::ReadCalibrationPlan(*world_ / "out/plan.json");
  EXPECT_EQ(plan.decided.size(), 6U);
  for (const workflow::CalibrationDecision& decision : plan.decided) EXPECT_FALSE(decision.reason.empty());
  const Outcome again = RunSonarcal(Arguments("again", "--plan " + Quoted(*world_ / "out/plan.json")));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(testing::ReadFile(*world_ / "again/params.json"), testing::ReadFile(*world_ / "out/params.json"));
  EXPECT_EQ(testing::ReadFile(*world_ / "again/sonar.json"), testing::ReadFile(*world_ / "out/sonar.json"));

  // The other commands take the calibrated sonar.
  const std::string calibrated = " --sonar " + Quoted(*world_ / "out/sonar.json");
  ASSERT_EQ(RunSonarcal("convert -q " + Quoted(*world_ / "real") + calibrated + " --out " +
                        Quoted(*world_ / "corrected"))
                .status,
            0);
  const auto corrected = data_io::OpenRecording(*world_ / "corrected");
  EXPECT_TRUE(corrected->info().sonar.axes.Matches(sonar.sonar.axes));
}

// The poses, the box and the window of this recording are declared rightly. They could move to make up for
// ghosts, if ghosts were looked for afterwards.
TEST_F(CalibrateCommand, GhostsMoveNothing) {
  const TinyWorld world;
  ParameterSet truth = testing::TinyAcousticParameters();
  truth.mirrors["floor"].loss_db = 3.0;
  data_io::WriteParameters(world.params(), truth);
  data_io::WritePoses(world.poses(), Around());
  const Outcome simulated =
      RunSonarcal(world.SimulateArguments() + " -q --noise --seed 3 --out " + Quoted(world / "real"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto calibrate = [&](const char* out, const std::string& extra) {
    return RunSonarcal("calibrate -q --rays 96x200 --real " + Quoted(world / "real") + " --scene " +
                       Quoted(world.scene()) + " --out " + Quoted(world / out) + extra);
  };
  const Outcome outcome = calibrate("out", "");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const workflow::CalibrationPlan plan = workflow::ReadCalibrationPlan(world / "out/plan.json");
  EXPECT_THAT(plan.decided.back().choice, HasSubstr("floor"));
  const PolarAxes declared = data_io::OpenRecording(world / "real")->info().sonar.axes;
  const PolarAxes found = data_io::ReadSonarFile(world / "out/sonar.json").sonar.axes;
  EXPECT_NEAR(found.range_min_m, declared.range_min_m, 0.01);
  EXPECT_NEAR(found.range_max_m, declared.range_max_m, 0.01);
  EXPECT_NEAR(data_io::ReadParameters(world / "out/params.json").mirrors.at("floor").loss_db, 3.0, 1.0);

  testing::WriteFile(world / "no_mirrors.json", R"({"format": "sonar-calibration-plan/1",
    "decided": [{"stage": "mirrors", "choice": "none"}]})");
  const Outcome without = calibrate("without", " --plan " + Quoted(world / "no_mirrors.json"));
  ASSERT_EQ(without.status, 0) << without.err;
  EXPECT_TRUE(data_io::ReadParameters(world / "without/params.json").mirrors.empty());
}

// The recording has another elevation pattern than the one from which calibrations start.
TEST_F(CalibrateCommand, APatternOfTheBeamMovesNothing) {
  const TinyWorld world;
  nlohmann::json sonar = ReadJsonFile(world.sonar());
  sonar["sonar"]["elevation_beam_width_deg"] = 16;
  testing::WriteFile(world.sonar(), sonar.dump());
  ParameterSet truth = testing::TinyAcousticParameters();
  truth.beam.elevation_pattern = ElevationPattern::kGaussian;
  data_io::WriteParameters(world.params(), truth);
  data_io::WritePoses(world.poses(), Around());
  const Outcome simulated =
      RunSonarcal(world.SimulateArguments() + " -q --noise --seed 3 --out " + Quoted(world / "real"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const Outcome outcome =
      RunSonarcal("calibrate -q --rays 96x200 --real " + Quoted(world / "real") + " --scene " +
                  Quoted(world.scene()) + " --out " + Quoted(world / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(data_io::ReadParameters(world / "out/params.json").beam.elevation_pattern,
            ElevationPattern::kGaussian);
  const workflow::CalibrationPlan plan = workflow::ReadCalibrationPlan(world / "out/plan.json");
  const auto placement = std::ranges::find(plan.decided, workflow::CalibrationStage::kPlacement,
                                           &workflow::CalibrationDecision::stage);
  ASSERT_NE(placement, plan.decided.end());
  EXPECT_THAT(placement->choice, HasSubstr("as declared"));
}

// What a picture of a viewer leaves: no frequency, no widths of the beam, no scale, a single frame.
TEST_F(CalibrateCommand, AFrameOfWhichNothingIsKnownIsCalibrated) {
  nlohmann::json recording = ReadJsonFile(*world_ / "real/recording.json");
  for (const char* key : {"frequency_hz", "azimuth_beam_width_deg", "elevation_beam_width_deg"})
    recording["sonar"].erase(key);
  for (const char* key : {"db_min", "db_max"}) recording["image"].erase(key);
  recording["frames"].erase(recording["frames"].begin() + 1, recording["frames"].end());
  std::filesystem::copy(*world_ / "real", *world_ / "bare");
  testing::WriteFile(*world_ / "bare/recording.json", recording.dump());
  const Outcome outcome = RunSonarcal(Arguments("of_bare", "", "bare"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("beam.azimuth_width_deg: neither the recording nor the parameters state it"));
  EXPECT_THAT(outcome.out, HasSubstr("states no frequency"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("nats a pixel"))) << "no frame is held out";
  const nlohmann::json fit = ReadJsonFile(*world_ / "of_bare/fit.json");
  const auto& values = fit["parameters"];
  EXPECT_TRUE(std::ranges::any_of(values, [](const nlohmann::json& value) {
    return value["name"] == "beam.azimuth_width_deg" && value["status"] != "fixed";
  }));
}

TEST_F(CalibrateCommand, SaysThatHeldOutFramesOfFittedPosesTestLittle) {
  nlohmann::json recording = ReadJsonFile(*world_ / "real/recording.json");
  for (nlohmann::json& frame : recording["frames"])
    frame["world_from_sonar"] = recording["frames"][0]["world_from_sonar"];
  std::filesystem::copy(*world_ / "real", *world_ / "still");
  testing::WriteFile(*world_ / "still/recording.json", recording.dump());
  testing::WriteFile(*world_ / "later.json", R"({"format": "sonar-calibration-plan/1",
    "decided": [{"stage": "placement"}, {"stage": "beam"}, {"stage": "mirrors"}]})");
  const std::string plan = "--plan " + Quoted(*world_ / "later.json");
  const Outcome still = RunSonarcal(Arguments("of_still", plan, "still"));
  ASSERT_EQ(still.status, 0) << still.err;
  EXPECT_THAT(still.out, HasSubstr("whether the choices hold elsewhere"));
  const Outcome around = RunSonarcal(Arguments("of_real", plan));
  ASSERT_EQ(around.status, 0) << around.err;
  EXPECT_THAT(around.out, Not(HasSubstr("whether the choices hold elsewhere")));
}

TEST_F(CalibrateCommand, APlanDecidesAndTheRestIsDecidedAnew) {
  testing::WriteFile(*world_ / "plan.json", R"({"format": "sonar-calibration-plan/1",
    "decided": [{"stage": "frames"}, {"stage": "placement", "choice": "as declared"},
                {"stage": "beam"}, {"stage": "mirrors", "choice": "none"}],
    "fit": {"format": "sonar-fit-config/1", "used": [0, 1], "held_out": [2]}})");
  const Outcome outcome = RunSonarcal(Arguments("planned", "--plan " + Quoted(*world_ / "plan.json")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json fit = ReadJsonFile(*world_ / "planned/fit.json");
  EXPECT_EQ(fit["frames_used"], (std::vector<int>{0, 1, 2}));
  EXPECT_NEAR(data_io::ReadSonarFile(*world_ / "planned/sonar.json").sonar.axes.range_min_m, 0.5, 1e-9);
}

TEST_F(CalibrateCommand, ALongRecordingIsFittedByChosenFramesAndItsPlanKeepsThem) {
  testing::WriteFile(*world_ / "long.json", R"({"format": "sonar-calibration-plan/1",
    "decided": [{"stage": "placement"}, {"stage": "beam"}, {"stage": "mirrors"}]})");
  const Outcome outcome = RunSonarcal(
      Arguments("chosen", "--max-frames 4 --max-held-out 2 --plan " + Quoted(*world_ / "long.json")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const workflow::CalibrationPlan plan = workflow::ReadCalibrationPlan(*world_ / "chosen/plan.json");
  EXPECT_EQ(plan.fit.used->size(), 4U);
  EXPECT_EQ(plan.fit.held_out->size(), 2U);
  const auto frames = std::ranges::find(plan.decided, workflow::CalibrationStage::kFrames,
                                        &workflow::CalibrationDecision::stage);
  ASSERT_NE(frames, plan.decided.end());
  EXPECT_EQ(frames->choice, "4 of 9 frames are fitted, 2 held out");
  EXPECT_THAT(frames->reason, HasSubstr("would lower the standard errors by"));
  const Outcome again = RunSonarcal(Arguments("rechosen", "--plan " + Quoted(*world_ / "chosen/plan.json")));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(testing::ReadFile(*world_ / "rechosen/params.json"),
            testing::ReadFile(*world_ / "chosen/params.json"));
}

// The frames show the floor behind the box, and the plan frees the curve of the box alone.
TEST_F(CalibrateCommand, WithoutASolutionItEndsWithStatusThreeAndWritesNoParameters) {
  const TinyWorld world;
  data_io::WriteParameters(world.params(), testing::TinyAcousticParameters());
  std::vector<data_io::TimedPose> poses;
  for (int i = 0; i < 3; ++i) {
    poses.push_back(
        {static_cast<double>(i),
         {RotationFromYawPitchRoll(RadFromDeg(5.0 * i), RadFromDeg(-25.0), 0.0), {0.3 * i, 1.5, 1.0}}});
  }
  data_io::WritePoses(world.poses(), poses);
  const Outcome simulated =
      RunSonarcal(world.SimulateArguments() + " -q --noise --seed 3 --out " + Quoted(world / "real"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  nlohmann::json plan = nlohmann::json::parse(R"({"format": "sonar-calibration-plan/1",
    "decided": [{"stage": "frames"}, {"stage": "water"}, {"stage": "noise"}, {"stage": "placement"},
                {"stage": "beam"}, {"stage": "mirrors"}],
    "fit": {"format": "sonar-fit-config/1", "free": ["material.box.gsab.C"],
            "used": [0, 1], "held_out": [2]}})");
  plan["parameters"] = ReadJsonFile(world.params());
  testing::WriteFile(world / "plan.json", plan.dump());
  const Outcome outcome = RunSonarcal("calibrate -q --rays 96x200 --real " + Quoted(world / "real") +
                                      " --scene " + Quoted(world.scene()) + " --plan " +
                                      Quoted(world / "plan.json") + " --out " + Quoted(world / "out"));
  EXPECT_EQ(outcome.status, 3);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("without a usable solution"));
  EXPECT_TRUE(std::filesystem::exists(world / "out/fit.json"));
  EXPECT_TRUE(std::filesystem::exists(world / "out/plan.json"));
  EXPECT_FALSE(std::filesystem::exists(world / "out/params.json"));
  EXPECT_FALSE(std::filesystem::exists(world / "out/report.html"));
}

TEST_F(CalibrateCommand, WhatCannotBeUsedIsRefusedInOneSentence) {
  const auto refuses = [&](const std::string& extra, const std::string& part,
                           const std::string& real = "real") {
    const Outcome outcome = RunSonarcal(Arguments("refused", extra, real));
    EXPECT_EQ(outcome.status, 1) << extra;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
  };
  testing::WriteFile(*world_ / "bad.json", R"({"format": "sonar-calibration-plan/1",
    "decided": [{"stage": "weather"}]})");
  refuses("--plan " + Quoted(*world_ / "bad.json"), "is \"weather\", expected one of frames, water");
  const auto refuses_plan = [&](const std::string& stages, const std::string& fit, const std::string& part) {
    testing::WriteFile(*world_ / "bad.json",
                       R"({"format": "sonar-calibration-plan/1", "decided": [{"stage": ")" + stages +
                           R"("}], "fit": {"format": "sonar-fit-config/1")" + fit + "}}");
    refuses("--plan " + Quoted(*world_ / "bad.json"), part);
  };
  refuses_plan("frames", "", "fit.used names no frame");
  refuses_plan("frames", R"(, "used": [], "held_out": [1])", "fit.used names no frame");
  refuses_plan("frames", R"(, "used": [0, 1])", "has no fit.held_out");
  refuses_plan("frames", R"(, "used": [0, 99], "held_out": [1])", "used frame 99");
  refuses_plan("frames", R"(, "used": [0, 1], "held_out": [9])", "held-out frame 9");
  refuses_plan("frames", R"(, "used": [1], "held_out": [1])", "none is left to fit");
  const std::string all = R"(frames"}, {"stage": "water"}, {"stage": "noise"}, {"stage": "placement"},
    {"stage": "beam"}, {"stage": "mirrors)";
  refuses_plan(all, R"(, "used": [0, 1], "held_out": [2], "start": {"pose.first.x_m": 1})",
               "start value of 'pose.first.x_m', which is no parameter");
  nlohmann::json recording = ReadJsonFile(*world_ / "real/recording.json");
  for (nlohmann::json& frame : recording["frames"]) frame.erase("world_from_sonar");
  std::filesystem::copy(*world_ / "real", *world_ / "blind");
  testing::WriteFile(*world_ / "blind/recording.json", recording.dump());
  refuses("", "has no 'world_from_sonar'", "blind");
  nlohmann::json far = ReadJsonFile(*world_ / "real/recording.json");
  for (nlohmann::json& frame : far["frames"]) {
    for (nlohmann::json& along_m : frame["world_from_sonar"]["position_m"])
      along_m = 1000.0 * along_m.get<double>();  // in millimetres
  }
  std::filesystem::copy(*world_ / "real", *world_ / "far");
  testing::WriteFile(*world_ / "far/recording.json", far.dump());
  refuses("", "the recording's poses do not show the scene: no ray hits", "far");
  refuses("--target lighthouse --poses " + Quoted(world_->poses()), "no object 'lighthouse' in the scene",
          "blind");
  refuses("--target lighthouse", "no object 'lighthouse' in the scene, expected one of floor, box");
}

TEST(MovableObjects, StandInsideTheSceneAndAreNotFlat) {
  const TinyWorld world;
  EXPECT_THAT(workflow::MovableObjects(data_io::ReadGltf(world.scene())), ElementsAre("box"));
}

}  // namespace
}  // namespace sonarcal::commands
