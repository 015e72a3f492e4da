// --object: fit, compare and explain score the same images of the same object alike.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOneSentence;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;

class ObjectRegion : public ::testing::Test {
 protected:
  void MakeRecording(const ParameterSet& truth) {
    data_io::WriteParameters(world_.params(), truth);
    real_ = world_.WriteSimulated("real", true);
  }

  static void Run(const std::string& arguments) {
    const Outcome outcome = RunSonarcal(arguments + " -q");
    ASSERT_EQ(outcome.status, 0) << arguments << '\n' << outcome.err;
  }

  std::string Compare(const std::string& simulated, const std::string& extra) const {
    return fmt::format(
        "compare --real {} --sim {} --out {} --as-displayed --pictures 0 --sweep-steps 0 -q {}",
        Quoted(real_), Quoted(world_ / simulated), Quoted(world_ / "compared"), extra);
  }

  // Figures of the fit's held-out frames against those of `simulate` with `extra` and `compare`.
  void ExpectFitScoresAs(const std::string& key, const std::string& extra) const {
    Run(
        fmt::format("simulate --scene {} --sonar {} --params {} --poses {} --sampling beams --rays 96x200 "
                    "--bits 12 --out {} {}",
                    Quoted(world_.scene()), Quoted(real_), Quoted(world_ / "fit/params.json"), Quoted(real_),
                    Quoted(world_ / key), extra));
    Run(Compare(key, "--object box"));
    const Json fit = ReadJsonFile(world_ / "fit/fit.json")[key];
    const Json compared = ReadJsonFile(world_ / "compared/metrics.json");
    EXPECT_EQ(fit["segmentation"], compared["segmentation"]);
    for (const Json& frame : fit["frames"]) {
      const Json& same = compared["frames"][frame["index"].get<int>()];
      EXPECT_EQ(frame["object_region"], same["object_region"]);
      EXPECT_EQ(frame["nr"], same["nr"]);
      EXPECT_NEAR(frame["iou"].get<double>(), same["iou"].get<double>(), 0.01) << key << frame["index"];
      for (const char* view : {"polar", "fan"}) {
        EXPECT_NEAR(frame["intensity_error"][view].get<double>(), same["intensity_error"][view].get<double>(),
                    0.003)
            << key << frame["index"];
      }
    }
  }

  std::string FitArguments(const std::string& free = "material.*.gsab.C") const {
    ParameterSet start = data_io::ReadParameters(world_.params());
    for (auto& [name, material] : start.materials) material.gsab.c *= 3.0;
    data_io::WriteParameters(world_ / "start.json", start);
    return fmt::format(
        "fit --real {} --scene {} --params {} --out {} --rays 96x200 --starts 1 "
        "--max-iterations 10 --free '{}' --held-out 1,3 --object box",
        Quoted(real_), Quoted(world_.scene()), Quoted(world_ / "start.json"), Quoted(world_ / "fit"), free);
  }

  TinyWorld world_;
  std::filesystem::path real_;
};

TEST_F(ObjectRegion, CompareGivesTheFiguresOfAPaperFitFromItsExpectedImage) {
  MakeRecording(testing::TinyParameters());
  Run(FitArguments());
  ExpectFitScoresAs("metrics_after", "--expected");
}

TEST_F(ObjectRegion, CompareGivesTheFiguresOfAnAcousticFitFromItsExpectedImageAndSample) {
  MakeRecording(testing::TinyAcousticParameters());
  Run(FitArguments());
  ExpectFitScoresAs("metrics_after", "--expected");
  ExpectFitScoresAs("sample_metrics_after", "--noise --seed 1000000001");  // docs/reference/fit_json.md
}

// Frames 0 and 1 have one recorded pose. Their fitted poses differ.
TEST_F(ObjectRegion, AFitWithFreePosesHasAFloorOfFramesWithOneRecordedPose) {
  std::vector<data_io::TimedPose> poses = data_io::ReadPoses(world_.poses());
  poses[1].world_from_sonar = poses[0].world_from_sonar;
  data_io::WritePoses(world_.poses(), poses);
  MakeRecording(testing::TinyAcousticParameters());
  Run(FitArguments("pose,material.*.gsab.C"));
  const Json floor =
      ReadJsonFile(world_ / "fit/fit.json")["metrics_after"]["noise_floor"]["real_against_real"];
  EXPECT_EQ(floor["pairs"], 1) << floor;
}

TEST_F(ObjectRegion, CompareTakesThePosesOfTheSimulationForBoxAndResiduals) {
  MakeRecording(testing::TinyParameters());
  world_.WriteSimulated("sim");
  Json json = ReadJsonFile(real_ / "recording.json");
  for (Json& frame : json["frames"]) frame.erase("world_from_sonar");
  testing::WriteFile(real_ / "recording.json", json.dump());
  Run(Compare("sim", "--object box --scene " + Quoted(world_.scene())));
  const Json compared = ReadJsonFile(world_ / "compared/metrics.json");
  EXPECT_THAT(compared["notes"].dump(), Not(HasSubstr("state no pose")));
  EXPECT_TRUE(compared["frames"][0].contains("object_region"));

  json = ReadJsonFile(world_ / "sim/recording.json");
  json["frames"][2].erase("world_from_sonar");
  testing::WriteFile(world_ / "sim/recording.json", json.dump());
  const Outcome outcome = RunSonarcal(Compare("sim", "--object box --scene " + Quoted(world_.scene())));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("frame 2 has no 'world_from_sonar' in "));
}

TEST_F(ObjectRegion, ExplainScoresItsLastStepAsCompareDoes) {
  MakeRecording(testing::TinyAcousticParameters());
  Run(fmt::format(
      "explain --real {} --scene {} --params {} --out {} --rays 96x200 --max-iterations 5 "
      "--held-out 1,3 --object box",
      Quoted(real_), Quoted(world_.scene()), Quoted(world_.params()), Quoted(world_ / "explained")));
  Run(fmt::format(
      "simulate --scene {} --sonar {} --params {} --poses {} --sampling beams --rays 96x200 --bits 12 "
      "--expected --out {}",
      Quoted(world_.scene()), Quoted(real_), Quoted(world_ / "explained/params.json"), Quoted(real_),
      Quoted(world_ / "expected")));
  Run(Compare("expected", "--object box"));
  const Json explained = ReadJsonFile(world_ / "explained/explain.json")["metrics_after"];
  const Json compared = ReadJsonFile(world_ / "compared/metrics.json");
  ASSERT_EQ(explained["frames"].size(), 2U);
  EXPECT_EQ(explained["segmentation"], compared["segmentation"]);
  for (const Json& frame : explained["frames"]) {
    const Json& same = compared["frames"][frame["index"].get<int>()];
    EXPECT_EQ(frame["object_region"], same["object_region"]);
    EXPECT_NEAR(frame["iou"].get<double>(), same["iou"].get<double>(), 0.01);
    EXPECT_NEAR(frame["intensity_error"]["polar"].get<double>(),
                same["intensity_error"]["polar"].get<double>(), 0.003);
  }
}

TEST_F(ObjectRegion, TheBoxItsMarginAndItsSourceAreStated) {
  MakeRecording(testing::TinyParameters());
  world_.WriteSimulated("sim");
  Run(Compare("sim", "--object box --object-margin 3x2"));
  const Json narrow = ReadJsonFile(world_ / "compared/metrics.json");
  EXPECT_EQ(narrow["segmentation"]["object_region"],
            (Json{{"source", "model"}, {"object", "box"}, {"margin_bins", 3}, {"margin_beams", 2}}));
  const std::string html = testing::ReadFile(world_ / "compared/report.html");
  EXPECT_THAT(
      html, AllOf(HasSubstr("3 range bins and 2 beams wider on each side"),
                  HasSubstr("The box comes from the model"), Not(HasSubstr("The whole image is searched"))));
  Run(Compare("sim", "--object box"));
  const Json wide = ReadJsonFile(world_ / "compared/metrics.json");
  for (int frame = 0; frame < 4; ++frame) {
    const Json& inner = narrow["frames"][frame]["object_region"];
    const Json& outer = wide["frames"][frame]["object_region"];
    EXPECT_EQ(std::max(0, inner["range_bins"][0].get<int>() - 9), outer["range_bins"][0]);
    EXPECT_EQ(std::min(60, inner["range_bins"][1].get<int>() + 9), outer["range_bins"][1]);
    EXPECT_EQ(std::max(0, inner["beams"][0].get<int>() - 10), outer["beams"][0]);
    EXPECT_EQ(std::min(24, inner["beams"][1].get<int>() + 10), outer["beams"][1]);
  }
  Run(Compare("sim", ""));
  const Json whole = ReadJsonFile(world_ / "compared/metrics.json");
  EXPECT_FALSE(whole["segmentation"].contains("object_region"));
  EXPECT_FALSE(whole["frames"][0].contains("object_region"));
}

// Pixels of the object outside the box count nowhere, in neither image and not in the floor.
TEST_F(ObjectRegion, NothingOutsideTheBoxIsObject) {
  MakeRecording(testing::TinyParameters());
  world_.WriteSimulated("sim");
  Run(Compare("sim",
              "--object box --object-margin 0x0 --segmentation fixed_threshold --threshold 0 --closing 0x0"));
  const Json metrics = ReadJsonFile(world_ / "compared/metrics.json");
  for (const Json& frame : metrics["frames"]) {
    const Json& box = frame["object_region"];
    const int pixels = (box["range_bins"][1].get<int>() - box["range_bins"][0].get<int>()) *
                       (box["beams"][1].get<int>() - box["beams"][0].get<int>());
    EXPECT_GT(pixels, 0);
    EXPECT_LE(frame["nr"].get<int>(), pixels);
    EXPECT_LE(frame["ns"].get<int>(), pixels);
  }
}

TEST_F(ObjectRegion, InvalidOptionsAreRefusedInOneSentence) {
  MakeRecording(testing::TinyParameters());
  world_.WriteSimulated("sim");
  const auto expect_failure = [&](const std::string& extra, int status, const std::string& part) {
    const Outcome outcome = RunSonarcal(Compare("sim", extra));
    EXPECT_EQ(outcome.status, status) << extra;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
  };
  expect_failure("--object lighthouse", 1,
                 "no material 'lighthouse' to be the object, expected one of floor, box");
  expect_failure("--object-margin 3x3", 2, "--object-margin has no effect without --object");
  expect_failure("--object box --object-margin 3", 2, "--object-margin '3'");
  expect_failure("--all-components --largest-component", 2, "--all-components");
  auto json = ReadJsonFile(world_ / "sim/recording.json");
  json.erase("scene");
  testing::WriteFile(world_ / "sim/recording.json", json.dump());
  json = ReadJsonFile(real_ / "recording.json");
  json.erase("scene");
  testing::WriteFile(real_ / "recording.json", json.dump());
  expect_failure("--object box", 2, "--object needs --scene, because neither recording names its scene");
}

}  // namespace
}  // namespace sonarcal::commands
