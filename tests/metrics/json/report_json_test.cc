#include "metrics/json/report_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "metrics/json/segmentation_json.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using Json = nlohmann::ordered_json;

// Two bins and three beams, of which one pixel is 1 / 3 brighter and is the only one of the object.
TEST(ResidualsJsonTest, ClassesAreListsOfOneLength) {
  const PolarImage real{testing::SmallAxes(2, 3), {}, Grid<float>(2, 3, 60.0F)};
  PolarImage simulated = real;
  simulated.value(1, 0) += 85.0F;
  const Mask object = testing::MaskOf({"...", "#.."});
  ResidualCollector residuals;
  EXPECT_TRUE(ResidualsJson(residuals, {}).is_null());
  residuals.Add(real, simulated, object, object);
  residuals.Add({testing::SmallAxes(3, 3), {}, Grid<float>(3, 3)}, simulated, object, object);
  ResidualTable table{.by = "material", .unit = {}, .classes = {}};
  table.classes.push_back({.name = "sand", .from = std::nullopt});
  const Json json = ResidualsJson(residuals, {table});
  EXPECT_EQ(json["frames"], 1);
  EXPECT_EQ(json["frames_left_out"], 1);
  const Json& by_range = json["by_range"];
  EXPECT_EQ(by_range["unit"], "m");
  EXPECT_EQ(by_range["from"], (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(by_range["to"], (std::vector<double>{2.0, 3.0}));
  EXPECT_FALSE(by_range.contains("name"));
  EXPECT_EQ(by_range["whole"]["pixels"], (std::vector<int>{3, 3}));
  EXPECT_EQ(by_range["whole"]["bias"], (std::vector<double>{0.0, 0.111111})) << "six decimals";
  EXPECT_EQ(by_range["union"]["pixels"], (std::vector<int>{0, 1}));
  EXPECT_TRUE(by_range["union"]["mean_absolute"][0].is_null());
  EXPECT_EQ(by_range["union"]["mean_absolute"][1], 0.333333);
  EXPECT_EQ(json["by_beam"]["unit"], "degrees");
  EXPECT_EQ(json["by_beam"]["whole"]["bias"], (std::vector<double>{0.166667, 0.0, 0.0}));
  EXPECT_EQ(json["by_material"]["name"], (std::vector<std::string>{"sand"}));
  EXPECT_FALSE(json["by_material"].contains("from"));
  const Json& map = json["map"];
  EXPECT_EQ(map["rows"], 2);
  EXPECT_EQ(map["cols"], 3);
  EXPECT_EQ(map["bins"], 1);
  EXPECT_EQ(map["beams"], 1);
  EXPECT_EQ(map["whole"]["bias"], (std::vector<double>{0.0, 0.0, 0.0, 0.333333, 0.0, 0.0}));
  EXPECT_EQ(map["union"]["pixels"], (std::vector<int>{0, 0, 0, 1, 0, 0}));
}

TEST(AgainstJsonTest, VerdictsAreCountedForHeadlinesAndForAll) {
  Against against{.earlier = "a.json", .common_frames = 0, .figures = {}, .notes = {"a note"}};
  const auto add = [&](ChangeVerdict verdict, bool headline) {
    against.figures.push_back({.fan = headline, .path = "iou", .headline = headline, .verdict = verdict});
  };
  add(ChangeVerdict::kBetter, true);
  add(ChangeVerdict::kBetter, false);
  add(ChangeVerdict::kWorse, false);
  add(ChangeVerdict::kSame, false);
  add(ChangeVerdict::kNotTold, true);
  against.figures[0].earlier = 0.5;
  against.figures[0].now = 0.75;
  against.figures[0].worsening = -0.25;
  against.figures[0].worsening_ci = Interval{-0.375, -0.125};
  against.figures[0].explained = 0.5;
  const Json json = AgainstJson(against);
  EXPECT_EQ(json["better"], 1);
  EXPECT_EQ(json["worse"], 0);
  EXPECT_EQ(json["same"], 0);
  EXPECT_EQ(json["not_told"], 1);
  EXPECT_EQ(json["all_figures"], (Json{{"better", 2}, {"worse", 1}, {"same", 1}, {"not_told", 1}}));
  EXPECT_EQ(json["earlier"], "a.json");
  against.unknown = {"iou, polar (too few frames)"};
  EXPECT_TRUE(AgainstJson(against)["worse"].is_null()) << "a limit on it counts as exceeded";
  EXPECT_EQ(json["method"], "whether the two 95 % intervals are apart; too few frames stand in both");
  EXPECT_EQ(json["figures"][0], (Json{{"view", "fan"},
                                      {"figure", "iou"},
                                      {"headline", true},
                                      {"earlier", 0.5},
                                      {"now", 0.75},
                                      {"worsening", -0.25},
                                      {"worsening_ci", {-0.375, -0.125}},
                                      {"verdict", "better"},
                                      {"explained", 0.5}}));
  EXPECT_TRUE(json["figures"][1]["worsening_ci"].is_null());
  EXPECT_TRUE(json["figures"][1]["explained"].is_null());
  EXPECT_EQ(json["figures"][1]["view"], "polar");
  EXPECT_EQ(json["notes"], (std::vector<std::string>{"a note"}));
  against.common_frames = 1;
  EXPECT_EQ(AgainstJson(against)["method"], "paired bootstrap over the common frames, 95 %");
}

TEST(SegmentationJsonTest, EachMethodStatesItsOwnParameters) {
  SegmentationOptions options;
  const auto names_of = [&](SegmentationMethod method) {
    options.method = method;
    const Json json = SegmentationJson(options);
    EXPECT_EQ(json["method"], std::string(ToString(method)));
    std::string names;
    for (const auto& [name, value] : json["parameters"].items()) {
      if (name == "open_rows") break;  // those of the tidying are the same for all
      names += name + ' ';
    }
    return names;
  };
  const std::string smoothing = "median_px blur_rows blur_cols ";
  const std::string ring = "guard_rows guard_cols training_rows training_cols ";
  const std::string cell = "false_alarm_rate cell_rows cell_cols ";
  EXPECT_EQ(names_of(SegmentationMethod::kBackgroundSigma),
            "background sigma_count min_contrast " + smoothing);
  EXPECT_EQ(names_of(SegmentationMethod::kOtsu), smoothing);
  EXPECT_EQ(names_of(SegmentationMethod::kTriangle), smoothing);
  EXPECT_EQ(names_of(SegmentationMethod::kFixedThreshold), "threshold_fraction " + smoothing);
  EXPECT_EQ(names_of(SegmentationMethod::kLocalContrast), "contrast " + ring + smoothing);
  options.contrast_db = 6.0;
  EXPECT_EQ(names_of(SegmentationMethod::kLocalContrast), "contrast_db " + ring + smoothing);
  EXPECT_EQ(names_of(SegmentationMethod::kCaCfar), cell + "looks domain " + ring);
  EXPECT_EQ(names_of(SegmentationMethod::kOsCfar), cell + "looks domain os_quantile " + ring);
  EXPECT_EQ(names_of(SegmentationMethod::kLikelihoodRatio), cell);
}

}  // namespace
}  // namespace sonarcal::metrics
