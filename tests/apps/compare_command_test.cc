#include "apps/compare_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/compare_recordings.h"
#include "apps/threshold_check.h"
#include "data_io/open_recording.h"
#include "data_io/parameters_io.h"
#include "data_io/types/error.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal {
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

TEST_F(CompareCommand, WritesWhatTheInterfaceNames) {
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

TEST_F(CompareCommand, TheReportOpensOfflineAndSaysWhatIsSynthetic) {
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
  EXPECT_EQ(RunSonarcal(Arguments("--fail-above no_such_figure=1")).status, 2);
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

TEST_F(CompareCommand, OtherDisplaysAreRefusedUnlessAsked) {
  ParameterSet parameters = testing::TinyParameters();
  parameters.display.db_max += 3.0;
  WriteParameters(world_.params(), parameters);
  simulated_ = world_.WriteSimulated("other");
  const Outcome outcome = RunSonarcal(Arguments());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--as-displayed"));
  EXPECT_EQ(RunSonarcal(Arguments("--as-displayed")).status, 0);
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

TEST(CompareRecordings, LeaveOutWhatEitherDoesNotShow) {
  const PolarImage image = testing::SpeckledBlock(1);
  RecordingInfo info;
  info.sonar.axes = image.axes;
  info.scale = image.scale;
  RecordingInfo shown = info;
  const auto pixels = [&](const RecordingInfo& real, const RecordingInfo& simulated) {
    const MetricsReport report =
        CompareRecordings(MemoryRecording(real, {{{}, image}, {{}, image}}),
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

TEST(TellingFrames, AreTheBestTheMiddleAndTheWorst) {
  MetricsReport report;
  for (int i = 0; i < 7; ++i) {
    FrameMetrics frame;
    frame.index = i;
    frame.polar.intensity.union_region.Add(0.0, 0.1 * ((i * 3) % 7));  // 0, 3, 6, 2, 5, 1, 4 tenths
    report.frames.push_back(frame);
  }
  EXPECT_EQ(TellingFrames(report), (std::vector<int>{0, 1, 2}));
}

TEST(Thresholds, AFigureWithoutValueDoesNotPass) {
  const auto thresholds = ParseThresholds({"iou=0.5", "micro.iou=0.5"});
  const nlohmann::ordered_json metrics = {{"macro", {{"iou", nullptr}}}, {"micro", {{"iou", 0.4}}}};
  EXPECT_EQ(PassedThresholds(thresholds, metrics).size(), 1U);
}

}  // namespace
}  // namespace sonarcal
