#include "apps/commands/compare_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/workflow/compare.h"
#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "metrics/json/threshold_check.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

class CompareCommand : public ::testing::Test {
 protected:
  std::string Arguments(const std::string& extra = "") const {
    return "compare --real " + Quoted(real_) + " --sim " + Quoted(simulated_) + " --out " +
           Quoted(world_ / "out") + " -q " + extra;
  }

  TinyWorld world_;
  std::filesystem::path real_ = world_.WriteSimulated("real", true);
  std::filesystem::path simulated_ = world_.WriteSimulated("sim");
};

TEST_F(CompareCommand, WritesTheFilesThatTheManualNames) {
  const Outcome outcome = RunSonarcal(Arguments());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("IoU"));

  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/metrics.json");
  ASSERT_EQ(json["frames"].size(), 4U);
  for (const char* key : {"index", "ns", "nr", "na", "ns_over_nr", "na_over_ns", "na_over_nr", "iou"}) {
    EXPECT_TRUE(json["frames"][0].contains(key)) << key;
  }
  EXPECT_TRUE(json["frames"][0]["intensity_error"].contains("polar"));
  EXPECT_TRUE(json["frames"][0]["intensity_error"].contains("fan"));
  for (const char* way : {"macro", "micro"}) {
    for (const char* ratio : {"ns_over_nr", "na_over_ns", "na_over_nr", "iou"}) {
      EXPECT_TRUE(json[way].contains(ratio)) << way << ' ' << ratio;
      EXPECT_TRUE(json[way].contains(std::string(ratio) + "_ci")) << way << ' ' << ratio;
    }
  }
  EXPECT_TRUE(json["segmentation"].contains("method"));
  EXPECT_TRUE(json.contains("noise_floor"));
  EXPECT_THAT(json["real"].get<std::string>(), HasSubstr("synthetic"));

  const std::string csv = testing::ReadFile(world_ / "out/per_frame.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  for (const char* view : {"polar", "fan"}) {
    for (const char* what : {"real", "simulated", "overlay", "regions"}) {
      EXPECT_TRUE(std::filesystem::exists(world_ / fmt::format("out/frame_0003_{}_{}.png", view, what)));
    }
  }
}

TEST_F(CompareCommand, TheReportOpensOfflineAndMarksSyntheticData) {
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("Both sides are synthetic"));
  EXPECT_THAT(html, HasSubstr("What the numbers mean"));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(html, ::testing::Not(HasSubstr("http://")));
}

TEST_F(CompareCommand, ARecordingAgreesWithItself) {
  simulated_ = real_;
  const Outcome outcome = RunSonarcal(Arguments("--json"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["macro"]["iou"], 1.0);
  EXPECT_EQ(json["macro"]["intensity_error"]["polar"], 0.0);
}

TEST_F(CompareCommand, AThresholdThatIsPassedIsStatusFour) {
  EXPECT_EQ(RunSonarcal(Arguments("--fail-above intensity_error.polar=0.99")).status, 0);
  const Outcome outcome = RunSonarcal(Arguments("--fail-above intensity_error.polar=1e-9"));
  EXPECT_EQ(outcome.status, 4);
  EXPECT_THAT(outcome.err, HasSubstr("intensity_error.polar"));
  EXPECT_TRUE(std::filesystem::exists(world_ / "out/metrics.json")) << "the figures are wanted all the same";
  std::filesystem::remove_all(world_ / "out");
  EXPECT_EQ(RunSonarcal(Arguments("--fail-above no_such_figure=1")).status, 2);
  EXPECT_TRUE(std::filesystem::exists(world_ / "out/metrics.json")) << "an unknown name costs no result";
  EXPECT_EQ(RunSonarcal(Arguments("--fail-above iou")).status, 2);
}

TEST_F(CompareCommand, OtherNumbersOfFramesNeedFrames) {
  ASSERT_EQ(RunSonarcal("convert -q " + Quoted(simulated_) + " --frames 0:2 --out " + Quoted(world_ / "two"))
                .status,
            0);
  simulated_ = world_ / "two";
  const Outcome outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--frames"));
  EXPECT_EQ(RunSonarcal(Arguments("--frames 0:2")).status, 0);
  EXPECT_EQ(RunSonarcal(Arguments("--frames 0:3")).status, 1);
}

TEST_F(CompareCommand, OptionsThatContradictAreRefused) {
  for (const char* options : {"--contrast 0.2 --contrast-db 3", "--all-components --largest-component"}) {
    const Outcome outcome = RunSonarcal(Arguments(options));
    EXPECT_EQ(outcome.status, 2) << options;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  }
}

TEST_F(CompareCommand, PartsOfAWholeSimulationAreMergedToTheComparisonOfTheWhole) {
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  const nlohmann::json whole = testing::ReadJsonFile(world_ / "out/metrics.json");
  for (const char* frames : {"0:3", "3:4"}) {
    const Outcome part =
        RunSonarcal(fmt::format("compare -q --part --frames {} --real {} --sim {} --out {}", frames,
                                Quoted(real_), Quoted(simulated_), Quoted(world_ / frames)));
    ASSERT_EQ(part.status, 0) << part.err;
  }
  const Outcome merged =
      RunSonarcal(fmt::format("compare -q --real {} --merge {},{} --out {}", Quoted(real_),
                              Quoted(world_ / "0:3"), Quoted(world_ / "3:4"), Quoted(world_ / "merged")));
  ASSERT_EQ(merged.status, 0) << merged.err;
  const nlohmann::json json = testing::ReadJsonFile(world_ / "merged/metrics.json");
  for (const char* key : {"frames", "macro", "micro", "notes"}) EXPECT_EQ(json[key], whole[key]) << key;
}

// The frames of the second recording start two later, which only the poses tell.
TEST_F(CompareCommand, PairsWhosePosesAreApartAreNamed) {
  const auto pose_notes = [&] {
    const nlohmann::json json = testing::ReadJsonFile(world_ / "out/metrics.json");
    auto notes = json["notes"].get<std::vector<std::string>>();
    std::erase_if(notes, [](const std::string& note) { return !note.starts_with("frames are paired by"); });
    return notes;
  };
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  EXPECT_THAT(pose_notes(), ::testing::IsEmpty());
  ASSERT_EQ(
      RunSonarcal("convert -q " + Quoted(simulated_) + " --frames 2:4 --out " + Quoted(world_ / "later"))
          .status,
      0);
  simulated_ = world_ / "later";
  ASSERT_EQ(RunSonarcal(Arguments("--frames 0:2 --force")).status, 0);
  ASSERT_EQ(pose_notes().size(), 1U);
  EXPECT_THAT(pose_notes().front(), HasSubstr("in 2 of 2, the poses"));
}

TEST_F(CompareCommand, OtherDisplaysAreRefusedUnlessAsked) {
  ParameterSet parameters = testing::TinyParameters();
  parameters.display.db_max += 3.0;
  data_io::WriteParameters(world_.params(), parameters);
  simulated_ = world_.WriteSimulated("other");
  const Outcome outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--as-displayed"));
  EXPECT_EQ(RunSonarcal(Arguments("--as-displayed")).status, 0);
}

TEST_F(CompareCommand, DeepJsonIsRefused) {
  testing::WriteFile(world_ / "deep.json", R"({"format":)" + std::string(200'000, '['));
  const Outcome against = RunSonarcal(Arguments("--against " + Quoted(world_ / "deep.json")));
  EXPECT_EQ(against.status, 1);
  EXPECT_THAT(against.err, HasSubstr("found no comparison"));
  std::filesystem::create_directories(world_ / "out");
  testing::WriteFile(world_ / "out/provenance.json", R"({"outputs":)" + std::string(200'000, '['));
  const Outcome into = RunSonarcal(Arguments());
  EXPECT_EQ(into.status, 1);
  EXPECT_TRUE(IsOneSentence(into.err)) << into.err;
}

TEST_F(CompareCommand, ReportsWhatGotWorseSinceAnEarlierRun) {
  ASSERT_EQ(RunSonarcal(Arguments()).status, 0);
  const std::filesystem::path earlier = world_ / "earlier.json";
  std::filesystem::copy_file(world_ / "out/metrics.json", earlier);
  const std::string against = "--against " + Quoted(earlier) + " --fail-above against.worse=0";
  Outcome outcome = RunSonarcal(Arguments(against));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("4 common frames, paired"));
  EXPECT_THAT(outcome.out, HasSubstr("the same"));

  ParameterSet parameters = testing::TinyParameters();
  for (auto& [name, material] : parameters.materials) {
    material.gsab.a *= 0.3;
    material.gsab.c *= 0.3;
    material.gsab.e *= 0.3;
  }
  data_io::WriteParameters(world_.params(), parameters);
  simulated_ = world_.WriteSimulated("dark");
  outcome = RunSonarcal(Arguments(against));
  EXPECT_EQ(outcome.status, 4);
  EXPECT_THAT(outcome.err, HasSubstr("against.worse is"));
  const nlohmann::json json = testing::ReadJsonFile(world_ / "out/metrics.json");
  EXPECT_GE(json["against"]["worse"], 1);
  EXPECT_GT(json["against"]["figures"].size(), 60U);
  const std::string html = testing::ReadFile(world_ / "out/report.html");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("worse"));
  EXPECT_THAT(html, HasSubstr("Way to the floor"));

  testing::WriteFile(earlier, "{}");
  outcome = RunSonarcal(Arguments(against));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
}

TEST_F(CompareCommand, SaysWhereTheSimulationIsWrongBySceneAndRange) {
  const Outcome outcome = RunSonarcal(Arguments("--scene " + Quoted(world_.scene())));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json residuals = testing::ReadJsonFile(world_ / "out/metrics.json")["residuals"];
  EXPECT_EQ(residuals["frames"], 4);
  EXPECT_EQ(residuals["by_range"]["from"].size(), 60U);
  EXPECT_EQ(residuals["by_beam"]["whole"]["bias"].size(), 24U);
  EXPECT_EQ(residuals["map"]["whole"]["pixels"].size(), 60U * 24U);
  EXPECT_EQ(residuals["by_material"]["name"], nlohmann::json({"floor", "box", "(nothing met)"}));
  EXPECT_EQ(residuals["by_incidence"]["from"].size(), 18U);
  const auto pixels = [](const nlohmann::json& classes) {
    return classes["whole"]["pixels"].get<std::vector<int>>();
  };
  const std::vector<int> by_material = pixels(residuals["by_material"]);
  EXPECT_EQ(by_material[0] + by_material[1] + by_material[2], 4 * 60 * 24);
  EXPECT_GT(by_material[0], by_material[1]) << "more floor than box";
  EXPECT_GT(by_material[1], 0);
  int with_angle = 0;
  for (const int count : pixels(residuals["by_incidence"])) with_angle += count;
  EXPECT_EQ(with_angle, by_material[0] + by_material[1]);
  const std::string csv = testing::ReadFile(world_ / "out/residuals.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * (60 + 24 + 18 + 3));
}

TEST_F(CompareCommand, AFloorIsDrawnWhereNoFramesStandStill) {
  Outcome outcome = RunSonarcal(Arguments());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  nlohmann::json json = testing::ReadJsonFile(world_ / "out/metrics.json");
  EXPECT_EQ(json["noise_floor"]["beside_figures"], "none");
  EXPECT_FALSE(json["macro"].contains("iou_floor"));
  outcome = RunSonarcal(Arguments("--params " + Quoted(world_.params())));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("floor"));
  json = testing::ReadJsonFile(world_ / "out/metrics.json");
  EXPECT_EQ(json["noise_floor"]["beside_figures"], "drawn");
  EXPECT_GT(json["macro"]["intensity"]["whole"]["mean_absolute_floor"], 0.0);
  EXPECT_LT(json["macro"]["iou_floor"], 1.0);
  EXPECT_FALSE(json["macro"]["speckle"]["background"]["real"].contains("looks_floor"));
  EXPECT_THAT(testing::ReadFile(world_ / "out/report.html"), HasSubstr("Floor of the mean"));
}

TEST_F(CompareCommand, AsManyFramesAsAskedGetPictures) {
  ASSERT_EQ(RunSonarcal(Arguments("--pictures 2")).status, 0);
  for (const int frame : {0, 1, 2, 3}) {
    EXPECT_EQ(std::filesystem::exists(world_ / fmt::format("out/frame_{:04}_fan_real.png", frame)),
              frame == 0 || frame == 3);
  }
  EXPECT_THAT(testing::ReadFile(world_ / "out/report.html"), HasSubstr("pictures of 2 of the 4 frames"));
  EXPECT_EQ(RunSonarcal(Arguments("--pictures -1")).status, 2);
}

// Adds settings to every frame of a recording, or to one.
void SetSettings(const std::filesystem::path& recording, const nlohmann::json& settings, int frame = -1) {
  nlohmann::json json = testing::ReadJsonFile(recording / "recording.json");
  (frame < 0 ? json["image"] : json["frames"][frame])["settings"] = settings;
  testing::WriteFile(recording / "recording.json", json.dump());
}

TEST_F(CompareCommand, OtherSettingsAreRefusedUnlessAsked) {
  SetSettings(real_, {{"compression", "power"}});
  Outcome outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("compression is power and logarithm"));
  EXPECT_EQ(RunSonarcal(Arguments("--as-displayed")).status, 0);
  SetSettings(real_, {{"gain_db", 18}});
  EXPECT_EQ(RunSonarcal(Arguments()).status, 0) << "the simulation has no gain of a receiver";
  SetSettings(simulated_, {{"gain_db", 24}}, 1);
  outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("gain_db is 18 and 24"));
}

TEST_F(CompareCommand, ARegionOfInterestHoldsTheObject) {
  const auto largest_count = [&](const std::string& extra) {
    const Outcome outcome =
        RunSonarcal(Arguments("--json --segmentation fixed_threshold --threshold 0 " + extra));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["frames"][0]["nr"].get<int>();
  };
  const int everywhere = largest_count("");
  const int within = largest_count("--region-range 1:3 --region-azimuth -5:5");
  EXPECT_LT(within, everywhere);
  EXPECT_LE(within, 30 * 9);
  EXPECT_EQ(RunSonarcal(Arguments("--region-range 3:1")).status, 2);
  EXPECT_EQ(RunSonarcal(Arguments("--region-range 100:200")).status, 1);
}

// The recording has no poses. A simulation that stands still leaves it assumed to be static, which is noted.
TEST(CompareRecordings, NoFloorIsMeasuredWhereTheSimulationMoves) {
  RecordingInfo info;
  const auto frames = [&](const std::vector<std::optional<double>>& x_m) {
    std::vector<Frame> made;
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      Frame frame{{.name = "", .time_s = {}, .world_from_sonar = {}}, testing::SpeckledBlock(i + 1)};
      if (x_m[i]) frame.info.world_from_sonar = Pose{Eigen::Quaterniond::Identity(), {*x_m[i], 0.0, 0.0}};
      info.sonar.axes = frame.image.axes;
      info.scale = frame.image.scale;
      made.push_back(std::move(frame));
    }
    return MemoryRecording(info, std::move(made));
  };
  const MemoryRecording real = frames({{}, {}, {}});
  const metrics::MetricsReport moves = workflow::CompareRecordings(real, frames({0.0, 1.0, 1.0}), {});
  EXPECT_EQ(moves.noise_floor.real_against_real.pairs.size(), 1U);
  const metrics::MetricsReport still = workflow::CompareRecordings(real, frames({0.0, 0.0, 0.0}), {});
  EXPECT_EQ(still.noise_floor.real_against_real.pairs.size(), 2U);
  EXPECT_THAT(still.notes, ::testing::Contains(HasSubstr("assumed to show a static scene")));
}

TEST(CompareRecordings, SamplesInvalidInEitherRecordingAreLeftOut) {
  const PolarImage image = testing::SpeckledBlock(1);
  RecordingInfo info;
  info.sonar.axes = image.axes;
  info.scale = image.scale;
  RecordingInfo shown = info;
  const auto pixels = [&](const RecordingInfo& real, const RecordingInfo& simulated) {
    const metrics::MetricsReport report =
        workflow::CompareRecordings(MemoryRecording(real, {{{}, image}, {{}, image}}),
                                    MemoryRecording(simulated, {{{}, image}, {{}, image}}), {});
    EXPECT_EQ(report.noise_floor.real_against_real.pairs.at(0).polar.intensity.whole.pixels,
              report.frames.at(0).polar.intensity.whole.pixels);
    return report.frames.at(0).polar.intensity.whole.pixels;
  };
  EXPECT_EQ(pixels(info, info), 120 * 40);
  shown.valid = Mask(120, 40, 1);
  (*shown.valid)(7, 8) = 0;
  EXPECT_EQ(pixels(shown, info), 120 * 40 - 1);
  EXPECT_EQ(pixels(info, shown), 120 * 40 - 1);
  RecordingInfo other = info;
  other.valid = Mask(120, 40, 1);
  (*other.valid)(9, 9) = 0;
  EXPECT_EQ(pixels(shown, other), 120 * 40 - 2);
}

TEST_F(CompareCommand, EveryMethodOfSegmentationIsToBeHad) {
  const std::string ring = " --guard 6x2 --training 8x3";
  const std::string rate = " --cell 3x1 --false-alarm-rate 0.01";
  const std::pair<const char*, std::string> methods[] = {
      {"background_sigma", " --sigma-count 4"},       {"otsu", " --blur 1x1"},
      {"fixed_threshold", " --threshold 0.4"},        {"triangle", ""},
      {"local_contrast", ring + " --contrast 0.05"},  {"ca_cfar", ring + rate + " --looks 1"},
      {"os_cfar", ring + rate + " --os-quantile 0.7"}};
  for (const auto& [method, own] : methods) {
    const Outcome outcome =
        RunSonarcal(Arguments("--json --sweep-steps 0 --segmentation " + std::string(method) + own));
    ASSERT_EQ(outcome.status, 0) << method << ": " << outcome.err;
    const nlohmann::json json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["segmentation"]["method"], method);
    EXPECT_TRUE(json["threshold_sweep"].is_null());
    if (json["segmentation"]["parameters"].contains("guard_rows")) {
      EXPECT_EQ(json["segmentation"]["parameters"]["guard_rows"], 6);
      EXPECT_EQ(json["segmentation"]["parameters"]["training_cols"], 3);
    }
  }
  for (const char* unused :
       {"--segmentation otsu --threshold 0.4", "--guard 6x2", "--echo-level 0.3",
        "--segmentation ca_cfar --blur 1x1", "--sweep-steps 0 --sweep-csv", "--scene-up z"}) {
    const Outcome outcome = RunSonarcal(Arguments(unused));
    EXPECT_EQ(outcome.status, 2) << unused;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("has no effect with")) << unused;
  }
  EXPECT_EQ(RunSonarcal(Arguments("--segmentation magic")).status, 2);
  EXPECT_EQ(RunSonarcal(Arguments("--segmentation ca_cfar --guard 6")).status, 2);
  EXPECT_EQ(RunSonarcal(Arguments("--segmentation ca_cfar --false-alarm-rate 2")).status, 1);
}

TEST_F(CompareCommand, TheLikelihoodRatioNeedsTheBackgroundsLaw) {
  Outcome outcome = RunSonarcal(Arguments("--segmentation likelihood_ratio"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--background-params"));
  ParameterSet parameters = testing::TinyParameters();
  parameters.model = EchoModel::kAcoustic;
  const std::string law = (world_ / "law.json").string();
  data_io::WriteParameters(law, parameters);
  outcome = RunSonarcal(Arguments("--segmentation likelihood_ratio --background-params " + Quoted(law)));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no noise floor"));
  parameters.receiver.noise_db = parameters.display.db_min + 10.0;
  data_io::WriteParameters(law, parameters);
  outcome =
      RunSonarcal(Arguments("--json --segmentation likelihood_ratio --background-params " + Quoted(law)));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["threshold_sweep"]["setting"],
            "-log10 of the false-alarm rate");
}

TEST_F(CompareCommand, TheSweepIsInTheMetricsAndOnRequestInACsv) {
  Outcome outcome = RunSonarcal(Arguments("--json"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json sweep = nlohmann::json::parse(outcome.out)["threshold_sweep"];
  EXPECT_EQ(sweep["settings"].size(), 21U);
  EXPECT_EQ(sweep["frames"], 4);
  EXPECT_EQ(sweep["macro"]["iou"]["curve"].size(), 21U);
  EXPECT_TRUE(sweep["micro"]["dice"]["area"].is_number());
  EXPECT_FALSE(std::filesystem::exists(world_ / "out/threshold_sweep.csv"));

  outcome = RunSonarcal(Arguments("--segmentation otsu --sweep-steps 3 --sweep-range 0.2:0.6 --sweep-csv"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string csv = testing::ReadFile(world_ / "out/threshold_sweep.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_THAT(csv, HasSubstr("\n0.4,"));
  EXPECT_EQ(RunSonarcal(Arguments("--sweep-steps 0 --sweep-csv")).status, 2);
  EXPECT_EQ(RunSonarcal(Arguments("--sweep-range 3:1")).status, 2);
  EXPECT_EQ(RunSonarcal(Arguments("--sweep-steps 1")).status, 1);
}

TEST_F(CompareCommand, TheSimulatedObjectMayBeItsEchoesAndTheRealOneNearIt) {
  const auto run = [&](const std::string& extra) {
    const Outcome outcome = RunSonarcal(Arguments("--json --sweep-steps 0 " + extra));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const auto all = run("--simulated-object echoes --all-components");
  const auto bright = run("--simulated-object echoes --echo-level 0.5 --all-components");
  EXPECT_EQ(all["segmentation"]["simulated_object"], "echoes");
  EXPECT_GT(all["frames"][0]["ns"].get<int>(), bright["frames"][0]["ns"].get<int>());
  const auto near = run("--simulated-object echoes --echo-level 0.5 --all-components --region-margin 0.05");
  EXPECT_EQ(near["segmentation"]["region_margin_m"], 0.05);
  EXPECT_LE(near["frames"][0]["nr"].get<int>(), bright["frames"][0]["nr"].get<int>());
  EXPECT_EQ(near["frames"][0]["ns"], bright["frames"][0]["ns"]);
}

TEST_F(CompareCommand, APolygonHoldsTheObject) {
  const auto count = [&](const std::string& extra) {
    const Outcome outcome = RunSonarcal(Arguments(
        "--json --sweep-steps 0 --segmentation fixed_threshold --threshold 0 --closing 0x0 " + extra));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["segmentation"]["region_of_interest_px"].get<int>();
  };
  // No bin or beam has its centre on a side.
  const int of_box = count("--region-range 1.02:3.02 --region-azimuth -5.1:5.1");
  EXPECT_EQ(count("--region-polygon 1.02:-5.1,1.02:5.1,3.02:5.1,3.02:-5.1"), of_box);
  EXPECT_LT(count("--region-polygon 1.02:-5.1,1.02:5.1,3.02:0"), of_box);
  EXPECT_EQ(RunSonarcal(Arguments("--region-polygon 1:-5,1:5")).status, 2);
  EXPECT_EQ(RunSonarcal(Arguments("--region-polygon 1:-5,x,3:5")).status, 2);
}

TEST(RepresentativeFrames, AreTheBestTheMiddleAndTheWorst) {
  metrics::MetricsReport report;
  for (int i = 0; i < 7; ++i) {
    metrics::FrameMetrics frame;
    frame.index = i;
    frame.polar.intensity.union_region.Add(0.0, 0.1 * ((i * 3) % 7));  // 0, 3, 6, 2, 5, 1, 4 tenths
    report.frames.push_back(frame);
  }
  EXPECT_EQ(workflow::RepresentativeFrames(report), (std::vector<int>{0, 1, 2}));
}

TEST(EvenlySpread, HoldsTheFirstAndTheLast) {
  const std::vector<int> frames = {3, 5, 7, 9, 11};
  EXPECT_EQ(workflow::EvenlySpread(frames, 3), (std::vector<int>{3, 7, 11}));
  EXPECT_EQ(workflow::EvenlySpread(frames, 2), (std::vector<int>{3, 11}));
  EXPECT_EQ(workflow::EvenlySpread(frames, 1), (std::vector<int>{3}));
  EXPECT_EQ(workflow::EvenlySpread(frames, 9), frames);
  EXPECT_TRUE(workflow::EvenlySpread(frames, 0).empty());
}

TEST(Thresholds, AFigureWithoutValueDoesNotPass) {
  const auto thresholds = metrics::ParseThresholds({"iou=0.5", "micro.iou=0.5"});
  const nlohmann::ordered_json metrics = {{"macro", {{"iou", nullptr}}}, {"micro", {{"iou", 0.4}}}};
  EXPECT_EQ(metrics::PassedThresholds(thresholds, metrics).size(), 1U);
}

}  // namespace
}  // namespace sonarcal::commands
