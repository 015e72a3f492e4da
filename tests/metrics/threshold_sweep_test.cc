#include "metrics/threshold_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "metrics/compare.h"
#include "metrics/find_objects.h"
#include "metrics/json/sweep_json.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SpeckledBlock;

constexpr int kIou = 3;

TEST(SweepSettingsTest, EvenlyFromLowestToHighest) {
  EXPECT_THAT(SweepSettings({.steps = 5}, SegmentationMethod::kOtsu), ElementsAre(0.0, 0.25, 0.5, 0.75, 1.0));
  EXPECT_THAT(SweepSettings({.steps = 3, .low = 2.0, .high = 4.0}, SegmentationMethod::kBackgroundSigma),
              ElementsAre(2.0, 3.0, 4.0));
  EXPECT_THAT(SweepSettings({}, SegmentationMethod::kCaCfar), ElementsAre());
  for (const SweepOptions& wrong :
       {SweepOptions{.steps = 1}, SweepOptions{.steps = 5, .low = 2.0},
        SweepOptions{.steps = 5, .low = 0.5, .high = 0.5}, SweepOptions{.steps = -1},
        SweepOptions{.steps = 1001}, SweepOptions{.steps = 5, .low = -0.5},
        SweepOptions{.steps = 5, .high = std::nan("")}}) {
    EXPECT_THROW(SweepSettings(wrong, SegmentationMethod::kOtsu), DataError);
  }
  EXPECT_EQ(SweepSettings({.steps = 1000}, SegmentationMethod::kOtsu).size(), 1000U);
  EXPECT_THAT(SweepSettings({.steps = 2}, SegmentationMethod::kBackgroundSigma), ElementsAre(0.5, 10.0));
  EXPECT_THAT(SweepSettings({.steps = 2}, SegmentationMethod::kLocalContrast), ElementsAre(0.0, 0.5));
  EXPECT_THAT(SweepSettings({.steps = 2}, SegmentationMethod::kOsCfar), ElementsAre(0.5, 8.0));
}

// Two frames, three settings, by hand.
TEST(ThresholdSweepTest, PooledAndMeanCurvesAndTheirAreas) {
  ThresholdSweep sweep({0.0, 1.0, 3.0});
  sweep.Add({{.ns = 10, .nr = 10, .na = 10}, {.ns = 4, .nr = 6, .na = 2}, {.ns = 0, .nr = 0, .na = 0}});
  sweep.Add({{.ns = 30, .nr = 30, .na = 30}, {.ns = 20, .nr = 20, .na = 20}, {.ns = 0, .nr = 5, .na = 0}});
  EXPECT_EQ(sweep.frames(), 2);
  EXPECT_EQ(sweep.Pooled(1), (Occupancy{.ns = 24, .nr = 26, .na = 22}));
  EXPECT_THAT(sweep.MicroCurve(kIou), ElementsAre(1.0, 22.0 / 28.0, 0.0));
  EXPECT_THAT(sweep.MacroCurve(kIou), ElementsAre(1.0, 0.5 * (0.25 + 1.0), 0.0));  // one frame at the end
  const std::optional<SweepArea> area = sweep.AreaUnder(sweep.MacroCurve(kIou));
  ASSERT_TRUE(area);
  EXPECT_NEAR(area->area, (0.5 * (1.0 + 0.625) * 1.0 + 0.5 * 0.625 * 2.0) / 3.0, 1e-12);
  EXPECT_EQ(area->axis_share, 1.0);
  // Na/Ns of nothing is nothing: the area is of the first interval alone.
  const auto na_over_ns = sweep.MicroCurve(1);
  EXPECT_EQ(na_over_ns[2], std::nullopt);
  EXPECT_NEAR(sweep.AreaUnder(na_over_ns)->area, 0.5 * (1.0 + 22.0 / 24.0), 1e-12);
  EXPECT_NEAR(sweep.AreaUnder(na_over_ns)->axis_share, 1.0 / 3.0, 1e-12);
  EXPECT_EQ(sweep.AreaUnder({std::nullopt, 1.0, std::nullopt}), std::nullopt);
  const ThresholdSweep from_two({2.0, 3.0, 6.0});
  EXPECT_NEAR(from_two.AreaUnder({1.0, 0.5, std::nullopt})->axis_share, 0.25, 1e-12);
}

TEST(ThresholdSweepTest, CsvAndJsonHoldTheSameCurves) {
  ThresholdSweep sweep({0.0, 0.5});
  sweep.Add({{.ns = 4, .nr = 2, .na = 1}, {.ns = 0, .nr = 1, .na = 0}});
  EXPECT_EQ(sweep.Csv(),
            "setting,ns,nr,na,micro_ns_over_nr,micro_na_over_ns,micro_na_over_nr,micro_iou,micro_dice,"
            "macro_ns_over_nr,macro_na_over_ns,macro_na_over_nr,macro_iou,macro_dice\n"
            "0,4,2,1,2,0.25,0.5,0.2,0.3333333333333333,2,0.25,0.5,0.2,0.3333333333333333\n"
            "0.5,0,1,0,0,,0,0,0,0,,0,0,0\n");
  const nlohmann::ordered_json json = SweepJson(sweep, SegmentationMethod::kOtsu);
  EXPECT_EQ(json["setting"], "part of full scale");
  EXPECT_EQ(json["counts"]["ns"], (std::vector<int>{4, 0}));
  EXPECT_EQ(json["micro"]["iou"]["curve"], (std::vector<double>{0.2, 0.0}));
  EXPECT_EQ(json["micro"]["iou"]["area"], 0.1);
  EXPECT_TRUE(json["macro"]["na_over_ns"]["curve"][1].is_null());
  EXPECT_TRUE(json["macro"]["na_over_ns"]["area"].is_null());
  EXPECT_EQ(json["macro"]["na_over_ns"]["axis_share"], 0.0);
  EXPECT_EQ(json["micro"]["iou"]["axis_share"], 1.0);
}

// Each setting of the sweep is what the comparison at that setting alone finds.
TEST(ThresholdSweepTest, ASettingOfTheSweepIsTheComparisonAtThatSetting) {
  PolarImage real = SpeckledBlock(1);
  PolarImage simulated = SpeckledBlock(2);
  for (const SegmentationMethod method :
       {SegmentationMethod::kBackgroundSigma, SegmentationMethod::kFixedThreshold,
        SegmentationMethod::kLocalContrast, SegmentationMethod::kCaCfar}) {
    CompareOptions options;
    options.segmentation.method = method;
    options.sweep = {.steps = 4, .low = 0.1, .high = 0.4};
    const FrameMetrics swept = CompareFrames(real, simulated, options);
    ASSERT_EQ(swept.sweep.size(), 4U);
    options.segmentation.sigma_count = options.segmentation.threshold_fraction =
        options.segmentation.contrast = 0.2;
    options.segmentation.false_alarm_rate = std::pow(10.0, -0.2);
    options.sweep = {};
    const FrameMetrics alone = CompareFrames(real, simulated, options);
    EXPECT_EQ(swept.sweep[1], alone.polar.occupancy) << ToString(method);
    EXPECT_TRUE(alone.sweep.empty());
  }
}

TEST(FindObjectsTest, EchoesAreWhateverTheSimulationShows) {
  const PolarImage real = SpeckledBlock(1);
  PolarImage simulated{real.axes, real.scale, Grid<float>(120, 40)};
  simulated.value(40, 15) = 1.0F;
  simulated.value(41, 15) = 52.0F;
  CompareOptions options;
  options.keep_masks = true;
  options.simulated_object = SimulatedObject::kEchoes;
  EXPECT_EQ(CompareFrames(real, simulated, options).polar.occupancy.ns, 2);
  options.echo_fraction = 0.2;  // 51
  options.sweep.steps = 3;
  const FrameMetrics metrics = CompareFrames(real, simulated, options);
  EXPECT_EQ(CountSet(metrics.masks->polar_simulated), 1);
  EXPECT_EQ(metrics.masks->polar_simulated(41, 15), 1);
  EXPECT_EQ(metrics.threshold_simulated, 51.0);
  EXPECT_GT(metrics.polar.occupancy.nr, 300);  // the real one by the segmentation
  for (const Occupancy& counts : metrics.sweep) EXPECT_EQ(counts.ns, 1);
  options.region = Mask(120, 40, 1);
  (*options.region)(41, 15) = 0;
  EXPECT_EQ(CompareFrames(real, simulated, options).polar.occupancy.ns, 0);
}

TEST(FindObjectsTest, TheRealObjectIsLookedForNearTheSimulatedOne) {
  PolarImage real = SpeckledBlock(1);
  for (int row = 90; row < 110; ++row) {
    for (int col = 0; col < 40; ++col) real.value(row, col) = 250.0F;  // a larger one elsewhere
  }
  CompareOptions options;
  options.keep_masks = true;
  EXPECT_LT(*CompareFrames(real, SpeckledBlock(2), options).polar.occupancy.iou(), 0.1);
  options.region_margin_m = 0.1;
  const FrameMetrics near = CompareFrames(real, SpeckledBlock(2), options);
  EXPECT_GT(*near.polar.occupancy.iou(), 0.8);
  const Mask around = DilatedByMetres(near.masks->polar_simulated, real.axes, 0.1);
  for (std::size_t i = 0; i < around.size(); ++i) {
    ASSERT_LE(near.masks->polar_real.values()[i], around.values()[i]);
  }
  // Nowhere, where there is no simulated one.
  const PolarImage silent{real.axes, real.scale, Grid<float>(120, 40)};
  EXPECT_EQ(CompareFrames(real, silent, options).polar.occupancy, (Occupancy{}));
  options.region_margin_m = -1.0;
  EXPECT_THROW(CompareFrames(real, silent, options), DataError);
}

}  // namespace
}  // namespace sonarcal::metrics
