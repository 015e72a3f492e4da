#include "apps/commands/fitting/fit_noise.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"
#include "sim/physics/display.h"
#include "sim/physics/receiver.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

constexpr int kPings = 15;

// Noise of an acoustic sonar that sees nothing: one floor, single-look speckle.
ParameterSet NoiseAlone() {
  ParameterSet parameters = testing::TinyParameters();
  parameters.model = EchoModel::kAcoustic;
  parameters.display = {.db_min = 0.0, .db_max = 60.0};
  parameters.receiver = {};
  parameters.receiver.noise_db = 18.0;
  parameters.receiver.noise_slope_db_per_m = 1.0;
  return parameters;
}

class FitNoiseCommand : public ::testing::Test {
 protected:
  FitNoiseCommand() {
    data_io::WriteGltf(Scene{.vertices_m = {{50, 50, 50}, {51, 50, 50}, {50, 51, 50}},
                             .triangles = {{0, 1, 2}},
                             .triangle_material = {0},
                             .material_names = {"box"}},
                       world_.scene());
    data_io::WriteParameters(world_.params(), NoiseAlone());
    std::vector<data_io::TimedPose> poses;
    for (int i = 0; i < kPings; ++i) poses.push_back({static_cast<double>(i), {}});
    data_io::WritePoses(world_.poses(), poses);
    const Outcome simulated =
        RunSonarcal(world_.SimulateArguments() + " -q --noise --bits 8 --out " + Quoted(real_));
    EXPECT_EQ(simulated.status, 0) << simulated.err;
  }

  std::string Arguments(const std::string& extra = "") const {
    return "fit --noise-only -q --real " + Quoted(real_) + " --out " + Quoted(world_ / "out") + " " + extra;
  }

  // The recording with its first frames alone.
  void Keep(int frames) {
    const auto recording = data_io::OpenRecording(real_);
    std::vector<Frame> kept;
    for (int i = 0; i < frames; ++i) kept.push_back(recording->ReadFrame(i));
    data_io::WriteRecording(MemoryRecording(recording->info(), std::move(kept)), world_ / "kept");
    real_ = world_ / "kept";
  }

  TinyWorld world_;
  std::filesystem::path real_ = world_ / "real";
};

TEST_F(FitNoiseCommand, FindsTheNoiseOfASyntheticSonar) {
  const Outcome outcome = RunSonarcal(Arguments());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("noise law of 10 pings, evaluated on 3 pings that neither"));
  EXPECT_THAT(outcome.out, HasSubstr("whitened residual"));

  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/fit.json");
  EXPECT_EQ(json["format"], "sonar-fit/1");
  EXPECT_EQ(json["frames_held_out"], (std::vector<int>{10, 11, 12, 13, 14}));
  const nlohmann::json& agreement = json["agreement"];
  EXPECT_EQ(agreement["frames_chosen_on"], (std::vector<int>{10, 11}));
  EXPECT_EQ(agreement["frames_judged_on"], (std::vector<int>{12, 13, 14}));
  EXPECT_EQ(agreement["judged_apart_from_choice"], true);
  // 24 x 60 x 3 pixels: the 95 % point of KS is 1.36 / sqrt(4320) = 0.021, less for grey levels.
  EXPECT_LT(agreement["frames_judged"]["ks"].get<double>(), 0.03);
  EXPECT_NEAR(json["residuals"]["whitened"]["mean"].get<double>(), 0.0, 0.02);
  EXPECT_NEAR(json["residuals"]["whitened"]["spread"].get<double>(), 1.0, 0.04);
  int chosen = 0;
  for (const nlohmann::json& choice : json["model_choice"]) chosen += choice["chosen"].get<bool>();
  EXPECT_EQ(chosen, 1);
  for (const nlohmann::json& parameter : json["parameters"]) {
    EXPECT_EQ(parameter["sigma"].is_number(), parameter["status"] == "free") << parameter;
  }

  const ParameterSet fitted = data_io::ReadParameters(world_ / "out/params.json");
  EXPECT_EQ(fitted.model, EchoModel::kAcoustic);
  const ReceiverParameters truth = NoiseAlone().receiver;
  // On the display alone levels are known, as parts of the span: at the middle of the window.
  const auto shown = [](const DisplayParameters<double>& display, double level_db) {
    return (level_db - display.db_min) / (display.db_max - display.db_min);
  };
  ASSERT_TRUE(fitted.receiver.noise_db);
  double level_db = *fitted.receiver.noise_db + 2.5 * fitted.receiver.noise_slope_db_per_m +
                    sim::TimeVariedGainDb(fitted.receiver.time_varied_gain, 2.5, 0.0);
  if (fitted.receiver.noise_after_gain_db) {
    level_db = DbFromPower(PowerFromDb(level_db) + PowerFromDb(*fitted.receiver.noise_after_gain_db));
  }
  EXPECT_NEAR(shown(fitted.display, level_db),
              shown(NoiseAlone().display, *truth.noise_db + 2.5 * truth.noise_slope_db_per_m), 0.01);
}

TEST_F(FitNoiseCommand, TheReportShowsTheLawAndWhatItLeaves) {
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  for (const char* part : {"receiver.noise_db", "Whitened residual", "<svg", "The recording is synthetic",
                           "Candidates", "neither the fit nor the selection used"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, Not(HasSubstr("Evaluated on fitted data")));
}

TEST_F(FitNoiseCommand, JudgeNoiseGivesTheFiguresOfTheFit) {
  // A window and cells left out: both come from the fit.json beside the law.
  ASSERT_EQ(RunSonarcal(Arguments("--held-out 3:6,10:15 --range-min 1 --reject-beyond 2.5")).status, 0);
  const nlohmann::json fit = testing::ReadJsonFile(world_ / "out/fit.json");
  EXPECT_EQ(fit["frames_held_out"], (std::vector<int>{3, 4, 5, 10, 11, 12, 13, 14}));
  EXPECT_FALSE(fit["window"]["cells_left_out"].empty());
  const auto judge = [&](const std::string& extra) {
    const Outcome outcome = RunSonarcal("judge-noise -q --json --real " + Quoted(real_) + " " + extra);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const nlohmann::json all = judge("--params " + Quoted(world_ / "out/params.json"));
  EXPECT_EQ(all["agreement"], fit["agreement"]["all_frames"]);
  EXPECT_EQ(all["drift"], fit["drift"]);
  EXPECT_EQ(all["pings"].size(), kPings);
  const std::string evaluated = "--params " + Quoted(world_ / "out/params_evaluated.json");
  EXPECT_EQ(judge(evaluated + " --frames 11:15")["agreement"], fit["agreement"]["frames_judged"]);
  EXPECT_EQ(judge(evaluated + " --frames 0:3,6:10")["agreement"], fit["agreement"]["frames_used"]);
  EXPECT_EQ(fit["agreement"]["fitted_again_to_all_frames"], true);
  EXPECT_NE(fit["agreement"]["all_frames"], fit["agreement"]["frames_used"]);
}

TEST_F(FitNoiseCommand, JudgeNoiseNamesThePingsAndCellsWhereALawFails) {
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  // Ping 4 is of twice the noise power, and so are 8 x 8 pixels of all pings.
  const auto recording = data_io::OpenRecording(real_);
  std::vector<Frame> frames;
  for (int i = 0; i < kPings; ++i) {
    Frame frame = recording->ReadFrame(i);
    Grid<float>& grey = frame.image.value;
    const auto louder = static_cast<float>(3.0 / 60.0 * 255.0);
    for (int bin = 0; bin < grey.rows(); ++bin) {
      for (int beam = 0; beam < grey.cols(); ++beam) {
        const bool in_cell = bin > 16 && bin <= 24 && beam >= 8 && beam < 16;
        if (i == 4 || in_cell) grey(bin, beam) = std::min(255.0f, grey(bin, beam) + louder);
      }
    }
    frames.push_back(std::move(frame));
  }
  data_io::WriteRecording(MemoryRecording(recording->info(), std::move(frames)), world_ / "louder");
  const Outcome outcome =
      RunSonarcal("judge-noise -q --params " + Quoted(world_ / "out/params.json") + " --real " +
                  Quoted(world_ / "louder") + " --out " + Quoted(world_ / "judged"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("worst:\n    frame 4 "));
  const nlohmann::json json = testing::ReadJsonFile(world_ / "judged/judgement.json");
  EXPECT_EQ(json["format"], "sonar-noise-judgement/1");
  EXPECT_NEAR(json["pings"][4]["level_db"].get<double>(), 3.0, 0.3);
  EXPECT_GT(json["pings"][4]["ks"], json["pings"][4]["chance_ks"]);
  nlohmann::json worst = json["cells"][0];
  for (const nlohmann::json& cell : json["cells"]) worst = cell["ks"] > worst["ks"] ? cell : worst;
  EXPECT_EQ(worst["beams"], (std::vector<int>{8, 15}));
  EXPECT_EQ(testing::HtmlFault(testing::ReadFile(world_ / "judged/report.html")), "");
}

TEST_F(FitNoiseCommand, JudgeNoiseTakesFromTheFitWhatNoOptionGives) {
  std::filesystem::create_directory(world_ / "law");
  data_io::WriteParameters(world_ / "law/params.json", NoiseAlone());
  testing::WriteFile(world_ / "law/fit.json", R"({"speckle": "gamma", "window": {"range_m": [1.5, 3.5]}})");
  const auto said = [&](const std::string& extra) {
    return RunSonarcal("judge-noise -q --params " + Quoted(world_ / "law/params.json") + " --real " +
                       Quoted(real_) + " " + extra)
        .out;
  };
  EXPECT_THAT(said(""), HasSubstr("1.50 to 3.50 m, gamma speckle; window and speckle of "));
  // Ends of bins, which are 1 / 15 m long.
  EXPECT_THAT(said("--range-min 1.9"),
              HasSubstr("1.90 to 3.50 m, gamma speckle; farthest range and speckle of "));
  EXPECT_THAT(said("--range-max 2.9"),
              HasSubstr("1.50 to 2.90 m, gamma speckle; nearest range and speckle of "));
  EXPECT_THAT(said("--range-min 1.9 --range-max 2.9 --speckle gamma"),
              HasSubstr("1.90 to 2.90 m, gamma speckle\n"));
}

// The law that made the pings: its rates are realised, to within one grey level.
TEST_F(FitNoiseCommand, JudgeNoiseMeasuresFalseAlarms) {
  const std::string judge = "judge-noise -q --params " + Quoted(world_.params()) + " --real " +
                            Quoted(real_) + " --out " + Quoted(world_ / "judged");
  const Outcome without = RunSonarcal(judge);
  ASSERT_EQ(without.status, 0) << without.err;
  EXPECT_FALSE(testing::ReadJsonFile(world_ / "judged/judgement.json").contains("false_alarms"));
  const Outcome outcome = RunSonarcal(judge + " --false-alarms --range-min 1 --range-max 4");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("false alarms, share of "));
  const nlohmann::json json = testing::ReadJsonFile(world_ / "judged/judgement.json");
  std::map<std::string, int> rows;
  for (const nlohmann::json& row : json["false_alarms"]) {
    ++rows[row["method"]];
    EXPECT_NEAR(row["pixels"].get<double>(), kPings * 24 * 45, kPings * 24 * 2.0)
        << "of 60 bins those within 3 m";
    if (row["stated"].is_null()) continue;
    const double stated = row["stated"];
    // CFAR assumes an even background, and this one rises by 1 dB/m.
    const double share = row["method"] == "likelihood_ratio" ? 0.2 : 0.6;
    if (stated > 1e-3) {
      EXPECT_NEAR(row["realised"].get<double>(), stated, share * stated) << row;
    }
    EXPECT_LE(row["ci"][0], row["realised"]);
    EXPECT_GE(row["ci"][1], row["realised"]);
  }
  EXPECT_EQ(rows.size(), 8U);
  EXPECT_EQ(rows["os_cfar"], 3);
  EXPECT_EQ(rows["otsu"], 1);
  const std::string html = testing::ReadFile(world_ / "judged/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("False alarms"));
}

TEST_F(FitNoiseCommand, JudgeNoiseRefusesALawOfAnotherSonarInOneSentence) {
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  ParameterSet law = data_io::ReadParameters(world_ / "out/params.json");
  ParameterSet diffuse = law;
  diffuse.receiver.looks = 0.5;
  diffuse.receiver.diffuse_share = 0.3;
  data_io::WriteParameters(world_ / "diffuse.json", diffuse);
  law.receiver.noise_taper_db.pop_back();
  data_io::WriteParameters(world_ / "other.json", law);
  law.receiver.noise_taper_db.clear();
  law.receiver.noise_after_gain_taper_db.clear();
  law.receiver.noise_db.reset();
  law.receiver.noise_after_gain_db.reset();
  data_io::WriteParameters(world_ / "silent.json", law);
  for (const auto& [file, part] :
       {std::pair{"diffuse.json", "gamma speckle, expected k_diffuse speckle"},
        std::pair{"other.json", "values of receiver.noise_taper_db, expected as many"},
        std::pair{"silent.json", "has no noise level"}}) {
    const Outcome outcome =
        RunSonarcal("judge-noise --params " + Quoted(world_ / file) + " --real " + Quoted(real_));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
  }
}

TEST_F(FitNoiseCommand, OneFrameIsEvaluatedOnBandsNotFittedAndThatIsReported) {
  Keep(1);
  const Outcome outcome = RunSonarcal(Arguments());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const char* said = "evaluated on every second band of 8 range bins, not fitted, of the ping fitted";
  EXPECT_THAT(outcome.out, HasSubstr(said));
  EXPECT_THAT(testing::ReadFile(world_ / "out/report.html"), HasSubstr(said));
  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/fit.json");
  EXPECT_EQ(json["agreement"]["judged_on_held_out"], true);
  EXPECT_EQ(json["agreement"]["odd_bands_held_out"], true);
  EXPECT_NE(json["agreement"]["frames_judged"], json["agreement"]["frames_used"]);
}

TEST_F(FitNoiseCommand, FewHeldOutFramesBothChooseAndEvaluateAndThatIsReported) {
  Keep(6);
  const Outcome outcome = RunSonarcal(Arguments("--held-out 2,5"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("evaluated on 2 pings that were not fitted, but that selected the candidate"));
  EXPECT_THAT(testing::ReadFile(world_ / "out/report.html"),
              HasSubstr("Selected and evaluated on the same data"));
  const nlohmann::json agreement = testing::ReadJsonFile(world_ / "out/fit.json")["agreement"];
  EXPECT_EQ(agreement["judged_apart_from_choice"], false);
  EXPECT_EQ(agreement["frames_chosen_on"], agreement["frames_judged_on"]);
}

TEST_F(FitNoiseCommand, TheWindowFoundByRuleIsReported) {
  const Outcome outcome = RunSonarcal(Arguments("--find-background --reject-beyond 3"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("found by rule"));
  EXPECT_THAT(testing::ReadFile(world_ / "out/report.html"), HasSubstr("found by rule"));
  const nlohmann::json window = testing::ReadJsonFile(world_ / "out/fit.json")["window"];
  EXPECT_EQ(window["found_by_rule"], true);
  EXPECT_LT(window["range_m"][0].get<double>(), window["range_m"][1].get<double>());
}

TEST_F(FitNoiseCommand, InvalidOptionsAreRefusedInOneSentence) {
  const auto expect_failure = [&](const std::string& arguments, int status, const std::string& part) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, status) << arguments;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(part));
    EXPECT_FALSE(std::filesystem::exists(world_ / "out"));
  };
  expect_failure(Arguments("--held-out 99"), 1, "held-out frame 99 of a recording of 15 frames");
  expect_failure(Arguments("--held-out 14:16"), 1, "held-out frames 14:16 of a recording of 15 frames");
  for (const char* range : {"5:2", "-1:3", "1:x", "0:2000000000"})
    expect_failure(Arguments(fmt::format("--held-out={}", range)), 2, "expected frames K and ranges A:B");
  expect_failure(Arguments("--range-min 4.4"), 1, "range bins in the window");
  expect_failure(Arguments("--range-min 4 --range-max 1"), 1, "range bins in the window");
  expect_failure(Arguments("--params " + Quoted(world_ / "none.json")), 1, "none.json");
  const auto recording = data_io::OpenRecording(real_);
  std::string all = "0";
  for (int i = 1; i < recording->frame_count(); ++i) all += fmt::format(",{}", i);
  expect_failure(Arguments("--held-out " + all), 1, "none is left to fit to");
}

TEST_F(FitNoiseCommand, ASceneIsWantedWithoutTheFlag) {
  const Outcome outcome = RunSonarcal("fit --real " + Quoted(real_) + " --out " + Quoted(world_ / "out"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--noise-only"));
}

}  // namespace
}  // namespace sonarcal::commands
