#include "metrics/json/metrics_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::HasSubstr;
using testing::SpeckledBlock;
using ::testing::StartsWith;

MetricsReport ReportOf(int frame_count) {
  MetricsReport report;
  report.real = "tank/recording.json";
  report.simulated = "out/recording.json (synthetic)";
  FrameComparer comparer(report.options);
  for (int i = 0; i < frame_count; ++i) {
    FrameMetrics frame = comparer.Compare(SpeckledBlock(2 * i + 1), SpeckledBlock(2 * i + 2));
    frame.index = i;
    frame.name = fmt::format("frame_{:04}.png", i);
    report.frames.push_back(std::move(frame));
  }
  report.aggregate = AggregateFrames(report.frames);
  return report;
}

TEST(MetricsJsonTest, FramesCarryTheAgreedNames) {
  const MetricsReport report = ReportOf(2);
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(report));
  EXPECT_EQ(parsed["format"], "sonar-metrics/1");
  ASSERT_EQ(parsed["frames"].size(), 2u);
  const nlohmann::json& frame = parsed["frames"][1];
  const ViewMetrics& polar = report.frames[1].polar;
  EXPECT_EQ(frame["index"], 1);
  EXPECT_EQ(frame["ns"], polar.occupancy.ns);
  EXPECT_EQ(frame["nr"], polar.occupancy.nr);
  EXPECT_EQ(frame["na"], polar.occupancy.na);
  EXPECT_EQ(frame["ns_over_nr"], *polar.occupancy.ns_over_nr());
  EXPECT_EQ(frame["na_over_ns"], *polar.occupancy.na_over_ns());
  EXPECT_EQ(frame["na_over_nr"], *polar.occupancy.na_over_nr());
  EXPECT_EQ(frame["iou"], *polar.occupancy.iou());
  EXPECT_EQ(frame["intensity_error"]["polar"], *polar.intensity.union_region.mean_absolute());
  EXPECT_EQ(frame["intensity_error"]["fan"], *report.frames[1].fan.intensity.union_region.mean_absolute());
  EXPECT_EQ(frame["intensity"]["overlap"]["bias"], *polar.intensity.overlap.bias());
  EXPECT_EQ(frame["fan"]["ns"], report.frames[1].fan.occupancy.ns);
}

TEST(MetricsJsonTest, MacroAndMicroCarryTheSameNamesAndIntervals) {
  const MetricsReport report = ReportOf(4);
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(report));
  for (const char* kind : {"macro", "micro"}) {
    const nlohmann::json& summary = parsed[kind];
    for (const char* name : {"ns_over_nr", "na_over_ns", "na_over_nr", "iou"}) {
      ASSERT_TRUE(summary[name].is_number()) << kind << "." << name;
      const nlohmann::json& ci = summary[std::string(name) + "_ci"];
      ASSERT_EQ(ci.size(), 2u);
      EXPECT_LE(ci[0].get<double>(), summary[name].get<double>());
      EXPECT_GE(ci[1].get<double>(), summary[name].get<double>());
      EXPECT_TRUE(summary["fan"][name].is_number());
    }
    EXPECT_TRUE(summary["intensity_error"]["polar"].is_number());
    EXPECT_EQ(summary["intensity_error"]["fan_ci"].size(), 2u);
  }
  EXPECT_EQ(parsed["micro"]["na"], report.aggregate.pooled_polar.occupancy.na);
  EXPECT_TRUE(parsed["ci"]["absent_because"].is_null());
  EXPECT_NEAR(parsed["micro"]["na_over_nr"].get<double>(),
              parsed["micro"]["na_over_ns"].get<double>() * parsed["micro"]["ns_over_nr"].get<double>(),
              1e-12);
}

TEST(MetricsJsonTest, UndefinedFiguresAreNullWithTheirReason) {
  MetricsReport report;
  report.frames.resize(1);
  report.aggregate = AggregateFrames(report.frames);
  report.noise_floor.real_against_real.absent_reason = "1 real frame, two are needed";
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(report));
  EXPECT_TRUE(parsed["frames"][0]["iou"].is_null());
  EXPECT_TRUE(parsed["frames"][0]["intensity_error"]["polar"].is_null());
  EXPECT_TRUE(parsed["macro"]["iou"].is_null());
  EXPECT_TRUE(parsed["macro"]["iou_ci"].is_null());
  EXPECT_EQ(parsed["macro"]["frames_left_out"]["iou"], 1);
  EXPECT_EQ(parsed["macro"]["frames_left_out"]["ns_over_nr"], 1);
  EXPECT_EQ(parsed["macro"]["frames_left_out"]["intensity_error"], 1);
  EXPECT_EQ(parsed["ci"]["level"], 0.95);
  EXPECT_EQ(parsed["ci"]["min_frames"], 3);
  EXPECT_EQ(parsed["ci"]["absent_because"], "1 frame, an interval needs at least 3");
  EXPECT_EQ(parsed["noise_floor"]["real_against_real"]["absent_because"], "1 real frame, two are needed");
  EXPECT_THAT(parsed["noise_floor"]["speckle"]["absent_because"].get<std::string>(), HasSubstr("dB scale"));
}

TEST(MetricsJsonTest, FiguresOfEveryFrameAreNotAmongThoseLeftOut) {
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(ReportOf(1)));
  EXPECT_FALSE(parsed["macro"]["frames_left_out"].contains("iou"));
  EXPECT_TRUE(parsed["macro"]["frames_left_out"].contains("distribution.whole.emd_db"));
}

TEST(MetricsJsonTest, SegmentationAndNoiseFloorAreStated) {
  MetricsReport report = ReportOf(1);
  report.options.segmentation.sigma_count = 3.5;
  report.options.intensity_domain = IntensityDomain::kWhole;
  ImageScale scale;
  scale.db_span = 80.0;
  report.noise_floor.speckle = SpeckleFloorFor(scale);
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(report));
  EXPECT_EQ(parsed["segmentation"]["method"], "background_sigma");
  EXPECT_EQ(parsed["segmentation"]["parameters"]["sigma_count"], 3.5);
  EXPECT_EQ(parsed["segmentation"]["parameters"]["close_rows"], 7);
  EXPECT_THAT(parsed["intensity_error_definition"].get<std::string>(), HasSubstr("whole image"));
  EXPECT_NEAR(parsed["noise_floor"]["speckle"]["speckled_simulation"].get<double>(), 0.0753, 1e-4);
  EXPECT_EQ(parsed["frames"][0]["intensity_error"]["polar"],
            *report.frames[0].polar.intensity.whole.mean_absolute());
}

TEST(MetricsJsonTest, TheObjectOfASimulationAndItsSearchBoxAreStated) {
  MetricsReport report = ReportOf(1);
  report.frames[0].object_box = PixelBox{.bin_begin = 1, .bin_end = 5, .beam_begin = 2, .beam_end = 9};
  const nlohmann::json by_rule = nlohmann::json::parse(MetricsJson(report));
  EXPECT_EQ(by_rule["segmentation"]["simulated_object"], "same_rule");
  EXPECT_FALSE(by_rule["segmentation"].contains("echo_fraction"));
  EXPECT_FALSE(by_rule["segmentation"].contains("object_region"));
  EXPECT_TRUE(by_rule["segmentation"]["region_of_interest_px"].is_null());
  EXPECT_EQ(by_rule["frames"][0]["object_region"],
            nlohmann::json::parse(R"({"range_bins": [1, 5], "beams": [2, 9]})"));
  report.options.simulated_object = SimulatedObject::kEchoes;
  report.options.echo_fraction = 0.125;
  report.options.region = testing::MaskOf({"##", "#."});
  report.options.object = ObjectSearch{.material = "steel", .margin = {.bins = 3, .beams = 4}};
  const nlohmann::json by_echoes = nlohmann::json::parse(MetricsJson(report))["segmentation"];
  EXPECT_EQ(by_echoes["simulated_object"], "echoes");
  EXPECT_EQ(by_echoes["echo_fraction"], 0.125);
  EXPECT_EQ(by_echoes["region_of_interest_px"], 3);
  EXPECT_EQ(by_echoes["object_region"],
            nlohmann::json::parse(
                R"({"source": "model", "object": "steel", "margin_bins": 3, "margin_beams": 4})"));
}

TEST(MetricsJsonTest, BlocksAreStatedForFramesInTimeAndTheirIntervals) {
  MetricsReport report = ReportOf(4);
  EXPECT_FALSE(nlohmann::json::parse(MetricsJson(report))["ci"].contains("block_frames"));
  for (int i = 0; i < 4; ++i) report.frames[i].time_s = 0.1 * i;
  report.aggregate = AggregateFrames(report.frames);
  const nlohmann::json ci = nlohmann::json::parse(MetricsJson(report))["ci"];
  EXPECT_THAT(ci["method"].get<std::string>(), HasSubstr("blocks of consecutive frames"));
  const nlohmann::json& blocks = ci["block_frames"];
  EXPECT_EQ(blocks["polar"]["iou"], report.aggregate.macro.polar.At("iou").block_frames);
  EXPECT_TRUE(blocks["polar"].contains("outline.mean_m"));
  EXPECT_FALSE(blocks["fan"].contains("outline.mean_m")) << "of the polar view only";
  EXPECT_FALSE(blocks["polar"].contains("distribution.echoes.emd_db")) << "has no interval without decibels";
}

// The text is put together from pieces, but looks like a document written at once.
TEST(MetricsJsonTest, TheTextIsIndentedThroughout) {
  for (const int frame_count : {0, 1, 3}) {
    MetricsReport report = ReportOf(frame_count);
    for (FrameMetrics& frame : report.frames) frame.object_box = PixelBox{};
    const std::string text = MetricsJson(report);
    EXPECT_EQ(text.back(), '\n');
    std::istringstream lines(text);
    std::string line;
    int depth = 0;
    while (std::getline(lines, line)) {
      const std::size_t indent = line.find_first_not_of(' ');
      const bool closes = line[indent] == '}' || line[indent] == ']';
      ASSERT_EQ(indent, 2 * static_cast<std::size_t>(depth - (closes ? 1 : 0))) << line;
      for (const char c : line) depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    }
    EXPECT_EQ(depth, 0);
  }
}

TEST(MetricsJsonTest, AFrameOnOneLineHoldsTheFrame) {
  const MetricsReport report = ReportOf(1);
  const std::string line = FrameMetricsJson(report.frames[0], IntensityDomain::kUnion);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(line), nlohmann::json::parse(MetricsJson(report))["frames"][0]);
}

TEST(MetricsJsonTest, TheFloorByDrawsStandsBesideItsLaw) {
  MetricsReport report = ReportOf(3);
  EXPECT_FALSE(nlohmann::json::parse(MetricsJson(report))["noise_floor"].contains("drawn"));
  report.noise_floor.drawn.emplace();
  report.noise_floor.drawn->law = "k";
  report.noise_floor.drawn->aggregate = AggregateFrames(ReportOf(2).frames);
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(report));
  const nlohmann::json& floor = parsed["noise_floor"];
  EXPECT_EQ(floor["beside_figures"], "drawn");
  EXPECT_EQ(floor["drawn"]["law"], "k");
  EXPECT_EQ(floor["drawn"]["frames"], 2);
  EXPECT_EQ(floor["drawn"]["iou"], *report.noise_floor.drawn->aggregate.macro.polar.At("iou").value);
  EXPECT_EQ(parsed["macro"]["iou_floor"], floor["drawn"]["iou"]);
  EXPECT_EQ(parsed["macro"]["intensity_error"]["fan_floor"], floor["drawn"]["intensity_error"]["fan"]);
}

TEST(MetricsJsonTest, FractionsOfFullScaleStandInGreyLevelsAndDecibelsToo) {
  MetricsReport report = ReportOf(2);
  report.scale.full_scale = 255.0;
  const nlohmann::json unknown = nlohmann::json::parse(MetricsJson(report));
  EXPECT_FALSE(unknown["macro"].contains("in_db")) << "nobody said how many dB the display spans";
  report.scale.db_span = 80.0;
  const nlohmann::json parsed = nlohmann::json::parse(MetricsJson(report));
  for (const char* kind : {"macro", "micro"}) {
    const nlohmann::json& summary = parsed[kind];
    const double fraction = summary["intensity"]["union"]["rmse"];
    EXPECT_DOUBLE_EQ(summary["in_grey_levels"]["intensity"]["union"]["rmse"], 255.0 * fraction);
    EXPECT_DOUBLE_EQ(summary["in_db"]["intensity"]["union"]["rmse"], 80.0 * fraction);
    EXPECT_TRUE(summary["in_db"]["fan"]["distribution"]["whole"]["wasserstein"].is_number());
    EXPECT_FALSE(summary["in_db"]["intensity"]["union"].contains("ncc"));
  }
}

TEST(MetricsJsonTest, TheFloorStandsBesideEveryFigureThatIsBetterOrWorse) {
  MetricsReport report = ReportOf(3);
  EXPECT_FALSE(nlohmann::json::parse(MetricsJson(report))["macro"].contains("iou_floor"));
  report.noise_floor.real_against_real.pairs = ReportOf(2).frames;
  report.noise_floor.real_against_real.aggregate =
      AggregateFrames(report.noise_floor.real_against_real.pairs);
  const nlohmann::json macro = nlohmann::json::parse(MetricsJson(report))["macro"];
  const ViewSummary& floor = report.noise_floor.real_against_real.aggregate.macro.polar;
  EXPECT_EQ(macro["iou_floor"], *floor.At("iou").value);
  EXPECT_EQ(macro["intensity"]["union"]["ssim_floor"], *floor.At("intensity.union.ssim").value);
  EXPECT_EQ(macro["intensity_error"]["polar_floor"], *floor.At("intensity.union.mean_absolute").value);
  EXPECT_FALSE(macro["speckle"]["background"]["real"].contains("looks_floor"));
}

TEST(NoiseFloorTest, FramesKnownToBeStillComeBeforeDrawsAndDrawsBeforeFramesTakenToBe) {
  NoiseFloor floor;
  EXPECT_EQ(floor.source(), FloorSource::kNone);
  EXPECT_EQ(floor.Beside(), nullptr);
  floor.real_against_real.pairs.resize(1);
  floor.real_against_real.assumed_still = true;
  EXPECT_EQ(floor.source(), FloorSource::kRealAgainstReal);
  floor.drawn.emplace();
  EXPECT_EQ(floor.source(), FloorSource::kDrawn);
  EXPECT_EQ(floor.Beside(), &floor.drawn->aggregate);
  floor.real_against_real.assumed_still = false;
  EXPECT_EQ(floor.Beside(), &floor.real_against_real.aggregate);
}

TEST(PerFrameCsvTest, AHeaderAndALineAFrame) {
  MetricsReport report = ReportOf(2);
  report.frames[0].name = "odd, \"name\".png";
  report.frames[1].polar.occupancy = {.ns = 5, .nr = 0, .na = 0};
  std::istringstream csv(PerFrameCsv(report.frames, IntensityDomain::kUnion));
  std::string header, first, second, rest;
  std::getline(csv, header);
  std::getline(csv, first);
  std::getline(csv, second);
  EXPECT_THAT(header,
              StartsWith("index,name,ns,nr,na,ns_over_nr,na_over_ns,na_over_nr,iou,dice,"
                         "fan_ns,fan_nr,fan_na,fan_ns_over_nr,fan_na_over_ns,fan_na_over_nr,fan_iou,fan_dice,"
                         "intensity_error_polar,intensity_error_fan,intensity_union_mean_absolute,"));
  EXPECT_THAT(header, HasSubstr(",fan_distribution_objects_wasserstein,"));
  EXPECT_EQ(std::count(second.begin(), second.end(), ','), std::count(header.begin(), header.end(), ','));
  EXPECT_THAT(first, StartsWith("0,\"odd, \"\"name\"\".png\","));
  EXPECT_THAT(second, StartsWith("1,frame_0001.png,5,0,0,,0,,0,"));
  EXPECT_FALSE(std::getline(csv, rest));
}

}  // namespace
}  // namespace sonarcal::metrics
