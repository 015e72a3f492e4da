#include "apps/commands/fitting/fit_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/workflow/fit.h"
#include "calib/models/held_out_frames.h"
#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

// What a fit starts from: the truth with other levels.
ParameterSet StartingParameters() {
  ParameterSet start = testing::TinyParameters();
  start.display.db_max = 169.0;
  for (auto& [name, material] : start.materials) material.gsab.c *= 3.0;
  return start;
}

class FitCommand : public ::testing::Test {
 protected:
  FitCommand() { data_io::WriteParameters(world_ / "start.json", StartingParameters()); }

  std::string Arguments(const std::string& extra = "") const {
    return "fit --real " + Quoted(real_) + " --scene " + Quoted(world_.scene()) + " --params " +
           Quoted(world_ / "start.json") + " --out " + Quoted(world_ / "out") +
           " -q --rays 96x200 --starts 1 --free 'display.db_max,material.*.gsab.C' " + extra;
  }

  TinyWorld world_;
  std::filesystem::path real_ = world_.WriteSimulated("real", true);
};

TEST_F(FitCommand, FindsTheParametersAndEvaluatesThemOnHeldOutFrames) {
  const Outcome outcome = RunSonarcal(Arguments("--held-out 1,3"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("evaluated on frames 1 and 3"));

  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/fit.json");
  EXPECT_EQ(json["frames_used"], (std::vector<int>{0, 2}));
  EXPECT_EQ(json["frames_held_out"], (std::vector<int>{1, 3}));
  EXPECT_EQ(testing::ReadJsonFile(world_ / "out/provenance.json")["configuration"]["held_out"],
            (std::vector<int>{1, 3}));
  EXPECT_EQ(json["rays_cast"], 4 * 96 * 200) << "each frame is traced once";
  EXPECT_LT(json["cost_final"].get<double>(), json["cost_initial"].get<double>());
  for (const char* key : {"parameters", "gauge", "unidentifiable_directions", "correlation", "residuals",
                          "iterations", "termination", "metrics_before", "metrics_after"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_TRUE(json["timing_s"].contains("trace"));
  EXPECT_TRUE(json["timing_s"].contains("solve"));
  for (const nlohmann::json& parameter : json["parameters"]) {
    for (const char* key :
         {"name", "value", "sigma", "unit", "initial", "lower", "upper", "status", "truth"}) {
      EXPECT_TRUE(parameter.contains(key)) << key;
    }
    if (parameter["name"] == "material.box.gsab.B_deg") {
      EXPECT_EQ(parameter["truth"], 3.0) << "the recording is simulated";
    }
  }
  EXPECT_THAT(outcome.out, HasSubstr("truth"));
  EXPECT_LT(json["metrics_after"]["macro"]["intensity_error"]["polar"].get<double>(),
            json["metrics_before"]["macro"]["intensity_error"]["polar"].get<double>());
  EXPECT_EQ(json["metrics_after"]["frames"][0]["index"], 1);

  const ParameterSet fitted = data_io::ReadParameters(world_ / "out/params.json");
  EXPECT_NEAR(fitted.display.db_max, testing::TinyParameters().display.db_max, 0.3);
  EXPECT_EQ(fitted.materials.at("box").gsab.b_deg, 3.0) << "what is not free stays";
}

// A pinhole's frustum gives the outer beams fewer rays than even angles do.
TEST_F(FitCommand, ALongRecordingIsFittedByChosenFramesUnlessTheUserNamesThem) {
  const auto frames = [&](const std::string& options) {
    const Outcome outcome = RunSonarcal(Arguments(options + " --force"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json json = testing::ReadJsonFile(world_ / "out/fit.json");
    return std::pair(json["frames_used"].get<std::vector<int>>(),
                     json["frames_held_out"].get<std::vector<int>>());
  };
  const auto [used, held_out] = frames("--max-frames 2 --max-held-out 1");
  EXPECT_EQ(used.size(), 2U);
  ASSERT_EQ(held_out.size(), 1U);
  EXPECT_FALSE(std::ranges::binary_search(used, held_out.front()));
  EXPECT_EQ(testing::ReadJsonFile(world_ / "out/provenance.json")["configuration"]["used"], used);
  using Lists = std::pair<std::vector<int>, std::vector<int>>;
  EXPECT_EQ(frames("--max-frames 2 --max-held-out 1 --frames all"), (Lists{{0, 1, 2}, {3}}));
  EXPECT_EQ(frames("--frames 0,2:4"), (Lists{{0, 2}, {3}}));
  EXPECT_EQ(frames("--frames 0:3 --held-out 1"), (Lists{{0, 2}, {1}}));
  // Held-out frames that the user names stay.
  EXPECT_EQ(frames("--max-frames 1 --max-held-out 1 --held-out 0,3").second, (std::vector<int>{0, 3}));
}

TEST_F(FitCommand, ARecordingOfFrustumRaysIsFittedWithItsRaysUnlessAskedOtherwise) {
  ASSERT_EQ(RunSonarcal("simulate -q --noise --seed 5 --sampling frustum --rays 300x240 --scene " +
                        Quoted(world_.scene()) + " --sonar " + Quoted(world_.sonar()) + " --params " +
                        Quoted(world_.params()) + " --poses " + Quoted(world_.poses()) + " --out " +
                        Quoted(world_ / "frustum"))
                .status,
            0);
  const std::string fit = "fit -q --real " + Quoted(world_ / "frustum") + " --scene " +
                          Quoted(world_.scene()) + " --params " + Quoted(world_ / "start.json") +
                          " --starts 1 --free 'display.db_max,material.*.gsab.C' --out ";
  ASSERT_EQ(RunSonarcal(fit + Quoted(world_ / "as_recorded")).status, 0);
  const nlohmann::json json = testing::ReadJsonFile(world_ / "as_recorded/fit.json");
  EXPECT_EQ(json["rays_cast"], 4 * 300 * 240);
  int compared = 0;
  for (const nlohmann::json& parameter : json["parameters"]) {
    if (parameter["sigma"].is_null()) continue;
    ++compared;
    EXPECT_NEAR(parameter["value"].get<double>(), parameter["truth"].get<double>(),
                4.0 * parameter["sigma"].get<double>())
        << parameter["name"];
  }
  EXPECT_GE(compared, 2);

  const Outcome other = RunSonarcal(fit + Quoted(world_ / "other") + " --sampling beams --rays 96x200");
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_THAT(testing::ReadJsonFile(world_ / "other/fit.json")["warnings"].dump(),
              HasSubstr("simulated with frustum rays"));
}

TEST_F(FitCommand, FramesOfDifferentSettingsAreNotFittedTogether) {
  nlohmann::json json = testing::ReadJsonFile(real_ / "recording.json");
  json["frames"][0]["settings"] = {{"gain_db", 18}};
  json["frames"][2]["settings"] = {{"gain_db", 24}};
  testing::WriteFile(real_ / "recording.json", json.dump());
  const Outcome outcome = RunSonarcal(Arguments("--held-out 1,3"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("gain_db is 18 and 24 in frame_0000.png and frame_0002.png"));
  EXPECT_EQ(RunSonarcal(Arguments("--held-out 0,1,3")).status, 1) << "nor judged";
}

TEST_F(FitCommand, TheReportShowsBeforeAndAfter) {
  ASSERT_EQ(RunSonarcal(Arguments("--object box")).status, 0);
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  for (const char* part : {"before the fit", "after the fit", "Gauge", "material.box.gsab.C", "<svg",
                           "evaluated on the held-out frame 3.", "Both sides are synthetic", "Truth"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_LT(html.find("Backscatter curves"), html.find("material.box.gsab.C")) << "the curve comes first";
  EXPECT_EQ(testing::PictureFault(html), "");
  EXPECT_FALSE(testing::PicturesOf(html).empty());
  for (const char* caption : {"</b> Recorded<", "alt=\"Recorded", "recorded only", ">Recorded<"})
    EXPECT_THAT(html, ::testing::Not(HasSubstr(caption))) << "the recording is synthetic";
  EXPECT_THAT(html, HasSubstr("</b> Synthetic<"));
}

TEST_F(FitCommand, TheCommandLineWinsOverTheConfiguration) {
  testing::WriteFile(world_ / "config.json",
                     R"({"format": "sonar-fit-config/1", "free": ["materials"], "held_out": [0]})");
  ASSERT_EQ(RunSonarcal(Arguments("--held-out 3 --config " + Quoted(world_ / "config.json"))).status, 0);
  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/provenance.json")["configuration"];
  EXPECT_EQ(json["held_out"], std::vector<int>{3});
  EXPECT_EQ(json["free"], (std::vector<std::string>{"display.db_max", "material.*.gsab.C"}));
}

TEST_F(FitCommand, InvalidOptionsAreRefusedInOneSentence) {
  const auto expect_failure = [&](const std::string& arguments, const std::string& part) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
    EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
  };
  expect_failure(Arguments("--held-out 9"), "held-out frame 9");
  expect_failure(Arguments("--held-out 0,1,2,3"), "all 4 frames are held out");
  expect_failure(Arguments("--object lighthouse"),
                 "the scene has no material 'lighthouse' to be the object, expected one of floor, box");

  ParameterSet coherent = StartingParameters();
  coherent.model = EchoModel::kCoherent;
  data_io::WriteParameters(world_ / "start.json", coherent);
  expect_failure(Arguments(), "only 'paper' and 'acoustic' can be fitted");
}

TEST_F(FitCommand, ARecordingWithoutPosesIsRefused) {
  const auto recording = data_io::OpenRecording(real_);
  std::vector<Frame> frames;
  for (int i = 0; i < recording->frame_count(); ++i) {
    frames.push_back(recording->ReadFrame(i));
    frames.back().info.world_from_sonar.reset();
  }
  data_io::WriteRecording(MemoryRecording(recording->info(), std::move(frames)), world_ / "blind");
  real_ = world_ / "blind";
  const Outcome outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("world_from_sonar"));
}

// A recording whose poses are off by a few centimetres, and a fit that has found them.
class FitFromPoses : public FitCommand {
 protected:
  void SetUp() override {
    data_io::WriteParameters(world_.params(), testing::TinyAcousticParameters());
    ASSERT_EQ(
        RunSonarcal(world_.SimulateArguments() + " -q --noise --seed 3 --out " + Quoted(world_ / "true"))
            .status,
        0);
    nlohmann::ordered_json json =
        nlohmann::ordered_json::parse(testing::ReadFile(world_ / "true/recording.json"));
    for (nlohmann::ordered_json& frame : json["frames"]) {
      nlohmann::ordered_json& y_m = frame["world_from_sonar"]["position_m"][1];
      y_m = y_m.get<double>() + 0.04;
    }
    testing::WriteFile(world_ / "true/recording.json", json.dump());
    ASSERT_EQ(
        RunSonarcal(Fit("true", "found") + " --params " + Quoted(world_.params()) + " --free pose").status,
        0);
  }

  std::string Fit(const std::string& real, const std::string& out) const {
    return "fit -q --rays 96x200 --starts 1 --max-iterations 8 --held-out 3 --real " + Quoted(world_ / real) +
           " --scene " + Quoted(world_.scene()) + " --out " + Quoted(world_ / out);
  }

  // Metrics at the start of a fit of one curve, which begins with the parameters of the first fit.
  nlohmann::json MetricsAtStart(const std::string& real, const std::string& extra = "") const {
    const Outcome outcome = RunSonarcal(Fit(real, "again") + " --force --free material.box.gsab.C --params " +
                                        Quoted(world_ / "found/params.json") + " " + extra);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return testing::ReadJsonFile(world_ / "again/fit.json")["metrics_before"]["macro"];
  }
};

TEST_F(FitFromPoses, AFitBeginsAtThePosesThatAnotherFitWrote) {
  const nlohmann::json found = testing::ReadJsonFile(world_ / "found/fit.json");
  ASSERT_NE(found["metrics_before"], found["metrics_after"]);
  const std::string poses = " --poses " + Quoted(world_ / "found/poses.json");
  const nlohmann::json at_start = MetricsAtStart("true", poses);
  const auto error = [](const nlohmann::json& metrics) {
    return metrics["intensity"]["whole"]["mean_absolute"].get<double>();
  };
  EXPECT_NEAR(error(at_start), error(found["metrics_after"]["macro"]), 1e-9);
  EXPECT_NE(at_start, MetricsAtStart("true"));

  // The same by way of a converted recording, and with that recording as poses.
  ASSERT_EQ(
      RunSonarcal("convert -q " + Quoted(world_ / "true") + poses + " --out " + Quoted(world_ / "posed"))
          .status,
      0);
  EXPECT_EQ(MetricsAtStart("posed"), at_start);
  EXPECT_EQ(MetricsAtStart("true", "--poses " + Quoted(world_ / "posed")), at_start);
  EXPECT_EQ(testing::ReadJsonFile(world_ / "again/provenance.json")["configuration"]["poses"],
            (world_ / "posed").string());

  nlohmann::json few = testing::ReadJsonFile(world_ / "found/poses.json");
  few["poses"].erase(0);
  testing::WriteFile(world_ / "few.json", few.dump());
  const Outcome outcome = RunSonarcal(Fit("true", "refused") + " --params " + Quoted(world_.params()) +
                                      " --poses " + Quoted(world_ / "few.json"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("few.json"));
}

// The tiny scene with one more triangle, of material "buoy", which no frame shows.
void WriteSceneWithBuoy(const TinyWorld& world) {
  Scene scene = data_io::ReadGltf(world.scene());
  const auto first = static_cast<int>(scene.vertices_m.size());
  scene.vertices_m.insert(scene.vertices_m.end(), {{50, 50, 50}, {51, 50, 50}, {50, 51, 50}});
  scene.triangles.emplace_back(first, first + 1, first + 2);
  scene.triangle_material.push_back(scene.MaterialIndex("buoy"));
  data_io::WriteGltf(scene, world.scene());
}

TEST_F(FitCommand, AFitThatNothingDeterminesEndsWithStatusThree) {
  WriteSceneWithBuoy(world_);
  ParameterSet start = StartingParameters();
  start.materials["buoy"] = start.materials.begin()->second;
  data_io::WriteParameters(world_ / "start.json", start);
  const Outcome outcome =
      RunSonarcal("fit --real " + Quoted(real_) + " --scene " + Quoted(world_.scene()) + " --params " +
                  Quoted(world_ / "start.json") + " --out " + Quoted(world_ / "out") +
                  " -q --rays 96x200 --starts 1 --free 'material.buoy.gsab.C'");
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(world_ / "out/fit.json"));
  EXPECT_FALSE(std::filesystem::exists(world_ / "out/params.json"));
}

TEST_F(FitCommand, PosesThatDoNotShowTheSceneAreRefused) {
  data_io::WriteGltf(Scene{.vertices_m = {{50, 50, 50}, {51, 50, 50}, {50, 51, 50}},
                           .triangles = {{0, 1, 2}},
                           .triangle_material = {0},
                           .material_names = {"box"}},
                     world_.scene());
  for (const EchoModel model : {EchoModel::kPaper, EchoModel::kAcoustic}) {
    ParameterSet start = StartingParameters();
    start.model = model;
    data_io::WriteParameters(world_ / "start.json", start);
    const Outcome outcome = RunSonarcal(Arguments());
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("the recording's poses do not show the scene: no ray hits"));
    EXPECT_THAT(outcome.err, HasSubstr("check the unit of the scene and the positions"));
  }
}

// The tiny world with more noise, 50 dB and a pattern of another shape.
ParameterSet TinyAcoustic() {
  ParameterSet parameters = testing::TinyAcousticParameters();
  parameters.receiver.noise_db = 120.0;
  parameters.display = {.db_min = 110.0, .db_max = 160.0};
  parameters.beam.elevation_pattern = ElevationPattern::kGaussian;
  return parameters;
}

TEST_F(FitCommand, AModelIsChosenByTheFramesHeldOut) {
  data_io::WriteParameters(world_.params(), TinyAcoustic());
  data_io::WriteParameters(world_ / "start.json", TinyAcoustic());
  real_ = world_.WriteSimulated("acoustic", true);
  const std::string arguments = "fit --real " + Quoted(real_) + " --scene " + Quoted(world_.scene()) +
                                " --params " + Quoted(world_ / "start.json") + " --out " +
                                Quoted(world_ / "out") +
                                " -q --rays 96x200 --starts 1 --free receiver.noise_db --held-out 1,3";
  const Outcome outcome = RunSonarcal(arguments + " --choose looks,trend");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("choice of the model by the likelihood of frames 1 and 3"));
  const nlohmann::json choice = testing::ReadJsonFile(world_ / "out/fit.json")["model_choice"];
  EXPECT_EQ(choice["frames"], (std::vector<int>{1, 3}));
  ASSERT_EQ(choice["axes"].size(), 2U);
  EXPECT_EQ(choice["axes"][0]["axis"], "looks");
  for (const nlohmann::json& axis : choice["axes"]) {
    int chosen = 0;
    for (const nlohmann::json& variant : axis["variants"]) {
      for (const char* key : {"name", "nats_per_pixel", "behind_best", "behind_best_sigma", "fitted_values",
                              "given", "usable", "tied", "chosen"}) {
        EXPECT_TRUE(variant.contains(key)) << key;
      }
      EXPECT_GE(variant["behind_best"].get<double>(), 0.0);
      chosen += variant["chosen"].get<bool>() ? 1 : 0;
    }
    EXPECT_EQ(chosen, 1) << axis["axis"];
  }
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("Trend of the noise floor with range"));
  // Synthetic: one look and no trend were drawn.
  EXPECT_EQ(data_io::ReadParameters(world_ / "out/params.json").receiver.noise_slope_db_per_m, 0.0);

  const Outcome unknown = RunSonarcal(arguments + " --choose sails");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("'sails', expected pattern"));
  data_io::WriteParameters(world_ / "start.json", StartingParameters());
  const Outcome paper = RunSonarcal(arguments + " --choose looks");
  EXPECT_EQ(paper.status, 1);
  EXPECT_THAT(paper.err, HasSubstr("'paper', but only forms of 'acoustic'"));
}

// A picture of a viewer: one frame whose recording states no dB scale, no widths and no frequency.
TEST_F(FitCommand, OneFrameWithoutAScaleFindsItsDisplayAndSaysWhatIsMissing) {
  ParameterSet start = testing::TinyParameters();
  start.model = EchoModel::kAcoustic;
  start.receiver.noise_db = 90.0;
  data_io::WriteParameters(world_ / "start.json", start);
  const Outcome simulated =
      RunSonarcal("simulate -q --noise --bits 8 --scene " + Quoted(world_.scene()) + " --sonar " +
                  Quoted(world_.sonar()) + " --params " + Quoted(world_ / "start.json") + " --poses " +
                  Quoted(world_.poses()) + " --rays 96x200 --out " + Quoted(world_ / "noisy"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto recording = data_io::OpenRecording(world_ / "noisy");
  RecordingInfo info = recording->info();
  info.scale.db_min.reset();
  info.scale.db_max.reset();
  info.scale.db_span.reset();
  info.sonar.frequency_hz = 0.0;
  info.sonar.azimuth_beam_width_deg = 0.0;
  info.sonar.elevation_beam_width_deg = 0.0;
  Frame frame = recording->ReadFrame(0);
  frame.image.scale = info.scale;
  data_io::WriteRecording(MemoryRecording(info, {frame}), world_ / "picture");
  real_ = world_ / "picture";
  const Outcome outcome = RunSonarcal("fit --real " + Quoted(real_) + " --scene " + Quoted(world_.scene()) +
                                      " --params " + Quoted(world_ / "start.json") + " --out " +
                                      Quoted(world_ / "out") + " -q --rays 96x200 --starts 1 --free display");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("choice of the display by the background of one frame"));
  EXPECT_THAT(outcome.out, HasSubstr("The recording states no dB scale"));
  for (const char* part : {"no frequency", "state beam.azimuth_width_deg", "state beam.elevation_width_deg",
                           "because none is held out", "one frame alone: speckle"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  const nlohmann::json choice = testing::ReadJsonFile(world_ / "out/fit.json")["model_choice"];
  EXPECT_EQ(choice["axes"][0]["variants"].size(), 4u);
  const Outcome other = RunSonarcal(Arguments("--choose looks"));
  EXPECT_NE(other.status, 0);
  EXPECT_THAT(other.err, HasSubstr("--choose looks needs held-out frames"));
}

TEST_F(FitCommand, LossesOfMirrorsAreFittedByDefault) {
  ParameterSet truth = TinyAcoustic();
  truth.receiver.noise_db = 105.0;
  truth.display = {.db_min = 90.0, .db_max = 160.0};
  truth.mirrors["floor"].loss_db = 3.0;
  truth.beam.transmit_even_deg = 15.0;
  truth.beam.transmit_end_deg = 20.0;
  data_io::WriteParameters(world_.params(), truth);
  real_ = world_.WriteSimulated("ghosts", true);
  ParameterSet start = truth;
  start.mirrors["floor"].loss_db = 10.0;
  start.mirrors["ceiling"].loss_db = 10.0;
  data_io::WriteParameters(world_ / "start.json", start);
  const Outcome outcome = RunSonarcal("fit --real " + Quoted(real_) + " --scene " + Quoted(world_.scene()) +
                                      " --params " + Quoted(world_ / "start.json") + " --out " +
                                      Quoted(world_ / "out") + " --rays 96x200 --starts 1 --held-out 1");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the mirror 'ceiling' is no material of the scene"));
  EXPECT_THAT(outcome.out, HasSubstr("mirror.floor.loss_db"));
  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/fit.json");
  const auto loss = std::find_if(json["parameters"].begin(), json["parameters"].end(),
                                 [](const nlohmann::json& p) { return p["name"] == "mirror.floor.loss_db"; });
  ASSERT_NE(loss, json["parameters"].end());
  EXPECT_EQ((*loss)["status"], "free");
  EXPECT_EQ((*loss)["unit"], "dB");
  const double fitted = (*loss)["value"];
  EXPECT_NEAR(fitted, 3.0, 3.5 * (*loss)["sigma"].get<double>());
  EXPECT_EQ(data_io::ReadParameters(world_ / "out/params.json").mirrors.at("floor").loss_db, fitted);
  EXPECT_THAT(testing::ReadFile(world_ / "out/report.html"), HasSubstr("mirror.floor.loss_db"));
}

TEST_F(FitCommand, OptionsOfOtherWaysToFitAreRefused) {
  const std::string real = "fit --real " + Quoted(real_) + " --out " + Quoted(world_ / "out");
  for (const auto& [arguments, name] : std::vector<std::pair<std::string, std::string>>{
           {Arguments("--find-background"), "--find-background has no effect without --noise-only"},
           {Arguments("--trust-all"), "--trust-all has no effect"},
           {Arguments("--pings ignore"), "--pings ignore has no effect"},
           {Arguments("--echo-level 0.1"), "--echo-level has no effect without --simulated-object echoes"},
           {real + " --noise-only --object box", "--object has no effect with --noise-only"},
           {real + " --noise-only --rays 48x40", "--rays has no effect with --noise-only"},
           {real + " --still --held-out 1", "--held-out has no effect with --still"}}) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(name));
    EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
  }
}

workflow::FitRecordingOptions QuickFit() {
  workflow::FitRecordingOptions options{.rays = {},
                                        .config = {.free = std::vector<std::string>{"display.db_max"},
                                                   .fixed = {},
                                                   .bounds = {},
                                                   .held_out = {}},
                                        .fit = {},
                                        .comparison = {}};
  options.rays.rays = RayGridSize{96, 200};
  options.fit.starts = 1;
  options.keep_images = false;
  return options;
}

TEST(FitRecording, AMisspeltObjectIsFoundBeforeAnythingIsTraced) {
  const TinyWorld world;
  const auto recording = data_io::OpenRecording(world.WriteSimulated("real"));
  workflow::FitRecordingOptions options = QuickFit();
  options.comparison.object = metrics::ObjectSearch{.material = "bocks"};
  options.on_trace = [](int, int) { ADD_FAILURE() << "traced"; };
  EXPECT_THAT(
      [&] {
        workflow::FitRecording(*recording, data_io::ReadGltf(world.scene()), StartingParameters(), options);
      },
      ::testing::ThrowsMessage<DataError>(
          HasSubstr("no material 'bocks' to be the object, expected one of floor, box")));
}

TEST(FitRecording, AHeldOutFrameThatEqualsAFittedOneIsRefused) {
  const TinyWorld world;
  const auto recording = data_io::OpenRecording(world.WriteSimulated("real", true));
  const auto with = [&](const Frame& last) {
    return MemoryRecording(recording->info(), {recording->ReadFrame(0), recording->ReadFrame(1), last});
  };
  workflow::FitRecordingOptions options = QuickFit();
  options.config.held_out = std::vector<int>{2};
  const calib::FrameSplit split{.used = {0, 1}, .held_out = {2}};
  EXPECT_THAT(
      [&] {
        workflow::FitRecording(with(recording->ReadFrame(1)), data_io::ReadGltf(world.scene()),
                               StartingParameters(), options);
      },
      ::testing::ThrowsMessage<DataError>(HasSubstr("held-out frame 2 is the same picture as frame 1")));
  Frame other = recording->ReadFrame(1);
  other.image.value(5, 5) += 1.0F;  // as another ping of a still scene
  calib::CheckHeldOut(with(other), split);
  // Black pictures are alike, whatever they were taken of.
  Frame black = recording->ReadFrame(1);
  for (float& value : black.image.value.values()) value = 0.0F;
  calib::CheckHeldOut(MemoryRecording(recording->info(), {black, recording->ReadFrame(1), black}), split);
}

TEST(FitRecording, ASingleFrameIsEvaluatedOnItselfAndThatIsReported) {
  const TinyWorld world;
  const auto recording = data_io::OpenRecording(world.WriteSimulated("real"));
  const MemoryRecording single(recording->info(), {recording->ReadFrame(0)});
  const workflow::RecordingFit fit =
      workflow::FitRecording(single, data_io::ReadGltf(world.scene()), StartingParameters(), QuickFit());
  EXPECT_TRUE(fit.fit.usable);
  EXPECT_FALSE(fit.judged_on_held_out);
  EXPECT_EQ(fit.after.frames.size(), 1U);
  EXPECT_TRUE(fit.seen.contains("box"));
  EXPECT_LE(fit.seen.at("box").low_deg, fit.seen.at("box").high_deg);
}

}  // namespace
}  // namespace sonarcal::commands
