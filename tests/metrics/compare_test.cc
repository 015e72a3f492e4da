#include "metrics/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"
#include "tests/metrics/metrics_testing.h"
#include "tests/support/recordings.h"

namespace sonarcal::metrics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SpeckledBlock;

std::string RefusalOf(const std::function<void(PolarImage& real, PolarImage& simulated)>& change) {
  PolarImage real = SpeckledBlock(1);
  PolarImage simulated = SpeckledBlock(2);
  change(real, simulated);
  try {
    CompareFrames(real, simulated);
  } catch (const DataError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CompareTest, AFrameComparedWithItselfHasNoError) {
  const FrameMetrics metrics = CompareFrames(SpeckledBlock(1), SpeckledBlock(1));
  for (const ViewMetrics* view : {&metrics.polar, &metrics.fan}) {
    EXPECT_GT(view->occupancy.nr, 0);
    EXPECT_EQ(view->occupancy.ns_over_nr(), 1.0);
    EXPECT_EQ(view->occupancy.iou(), 1.0);
    for (const IntensityDomain domain :
         {IntensityDomain::kUnion, IntensityDomain::kWhole, IntensityDomain::kOverlap}) {
      EXPECT_EQ(view->intensity.Over(domain).mean_absolute(), 0.0);
      EXPECT_EQ(view->intensity.Over(domain).bias(), 0.0);
    }
  }
  EXPECT_EQ(metrics.threshold_real, metrics.threshold_simulated);
  EXPECT_THAT(metrics.notes, IsEmpty());
  EXPECT_FALSE(metrics.masks);
}

TEST(CompareTest, SwappingRealAndSimulatedMirrorsTheRatiosAndTheBias) {
  const FrameMetrics ab = CompareFrames(SpeckledBlock(1), SpeckledBlock(2));
  const FrameMetrics ba = CompareFrames(SpeckledBlock(2), SpeckledBlock(1));
  for (const auto view : {&FrameMetrics::polar, &FrameMetrics::fan}) {
    EXPECT_EQ((ab.*view).occupancy.ns, (ba.*view).occupancy.nr);
    EXPECT_EQ((ab.*view).occupancy.na_over_ns(), (ba.*view).occupancy.na_over_nr());
    EXPECT_EQ((ab.*view).occupancy.iou(), (ba.*view).occupancy.iou());
    EXPECT_EQ((ab.*view).intensity.union_region.mean_absolute(),
              (ba.*view).intensity.union_region.mean_absolute());
    EXPECT_EQ(*(ab.*view).intensity.whole.bias(), -*(ba.*view).intensity.whole.bias());
  }
}

TEST(CompareTest, BothViewsSeeTheSameObject) {
  CompareOptions options;
  options.keep_masks = true;
  const FrameMetrics metrics = CompareFrames(SpeckledBlock(1), SpeckledBlock(2), options);
  ASSERT_TRUE(metrics.masks);
  EXPECT_EQ(CountSet(metrics.masks->polar_real), metrics.polar.occupancy.nr);
  EXPECT_EQ(CountSet(metrics.masks->polar_simulated), metrics.polar.occupancy.ns);
  EXPECT_EQ(CountSet(metrics.masks->fan_real), metrics.fan.occupancy.nr);
  EXPECT_EQ(CountSet(metrics.masks->fan_simulated), metrics.fan.occupancy.ns);
  const FanMap map(SpeckledBlock(1).axes);
  EXPECT_EQ(metrics.masks->fan_real, map.ApplyNearest(metrics.masks->polar_real));
  EXPECT_NEAR(*metrics.fan.occupancy.iou(), *metrics.polar.occupancy.iou(), 0.05);
}

TEST(CompareTest, OneComparerServesFramesOfDifferentGeometry) {
  FrameComparer comparer({});
  const FrameMetrics first = comparer.Compare(SpeckledBlock(1), SpeckledBlock(2));
  PolarImage far_real = SpeckledBlock(1);
  PolarImage far_simulated = SpeckledBlock(2);
  far_real.axes.range_min_m = far_simulated.axes.range_min_m = 2.0;
  far_real.axes.range_max_m = far_simulated.axes.range_max_m = 4.0;
  const FrameMetrics far = comparer.Compare(far_real, far_simulated);
  EXPECT_EQ(far.polar.occupancy, first.polar.occupancy);
  EXPECT_NE(far.fan.occupancy, first.fan.occupancy);
  EXPECT_EQ(comparer.Compare(SpeckledBlock(1), SpeckledBlock(2)).fan.occupancy, first.fan.occupancy);
}

TEST(CompareTest, FramesOfDifferentKindsAreRefusedWithTheFieldThatDiffers) {
  EXPECT_EQ(RefusalOf([](PolarImage&, PolarImage&) {}), "no error");
  EXPECT_EQ(RefusalOf([](PolarImage&, PolarImage& s) { s.scale.quantity = Quantity::kDecibel; }),
            "quantity: the real frame holds grey level, the simulated one decibel; expected the same");
  EXPECT_EQ(RefusalOf([](PolarImage& r, PolarImage& s) {
              r.scale.quantity = s.scale.quantity = Quantity::kDecibel;
            }),
            "quantity: the real frame holds decibel, expected grey levels as displayed");
  EXPECT_EQ(RefusalOf([](PolarImage&, PolarImage& s) { s.scale.full_scale = 4095.0; }),
            "full_scale: the real frame has 255, the simulated one 4095; expected the same");
  EXPECT_THAT(RefusalOf([](PolarImage& r, PolarImage& s) { r.scale.full_scale = s.scale.full_scale = 0.0; }),
              HasSubstr("full_scale: that of the real frame is 0"));
  EXPECT_EQ(RefusalOf([](PolarImage& r, PolarImage& s) {
              r.scale.db_min = 0.0;
              s.scale.db_min = 80.0;
            }),
            "db_min: the real frame has 0 dB, the simulated one 80 dB; expected the same");
  EXPECT_EQ(RefusalOf([](PolarImage& r, PolarImage& s) {
              r.scale.db_span = 80.0;
              s.scale.db_min = 80.0;
              s.scale.db_max = 190.0;
            }),
            "db_span: the real frame has 80 dB, the simulated one 110 dB; expected the same");
  EXPECT_THAT(RefusalOf([](PolarImage&, PolarImage& s) { s.axes.range_max_m += 0.5; }),
              HasSubstr("geometry: the real and the simulated frame have range windows"));
  EXPECT_EQ(RefusalOf([](PolarImage& r, PolarImage&) { r.value = Grid<float>(3, 4); }),
            "the real frame holds 3 x 4 pixels, expected 120 range bins x 40 beams");
  EXPECT_EQ(RefusalOf([](PolarImage&, PolarImage& s) { s.value = Grid<float>(120, 41); }),
            "the simulated frame holds 120 x 41 pixels, expected 120 range bins x 40 beams");
}

TEST(CompareTest, ADbScaleKnownToOneSideIsNoted) {
  PolarImage simulated = SpeckledBlock(2);
  simulated.scale.db_min = 80.0;
  simulated.scale.db_max = 160.0;
  EXPECT_THAT(
      CompareFrames(SpeckledBlock(1), simulated).notes,
      ElementsAre("only the simulated frame states its dB scale; the other is assumed to have the same"));
  PolarImage real = SpeckledBlock(1);
  real.scale.db_span = 80.0;
  EXPECT_THAT(CompareFrames(real, simulated).notes, IsEmpty());
}

TEST(CompareTest, OneEndOfTheDbScaleStatesIt) {
  PolarImage simulated = SpeckledBlock(2);
  simulated.scale.db_min = 80.0;
  EXPECT_EQ(CompareFrames(SpeckledBlock(1), simulated).notes.size(), 1U);
  EXPECT_FALSE(DbSpan(simulated.scale));
  simulated.scale.db_span = 60.0;
  EXPECT_EQ(DbSpan(simulated.scale), 60.0);
  simulated.scale.db_max = 130.0;
  EXPECT_EQ(DbSpan(simulated.scale), 50.0);
}

TEST(CompareTest, TheRegionOfInterestMustFitTheImage) {
  CompareOptions options;
  for (const auto& [rows, cols] : {std::pair{3, 4}, std::pair{120, 39}, std::pair{119, 40}}) {
    options.region = Mask(rows, cols, 1);
    EXPECT_THROW(CompareFrames(SpeckledBlock(1), SpeckledBlock(2), options), DataError);
  }
  options.region = Mask(120, 40, 0);
  const FrameMetrics nothing = CompareFrames(SpeckledBlock(1), SpeckledBlock(2), options);
  EXPECT_EQ(nothing.polar.occupancy.iou(), std::nullopt);
  EXPECT_THAT(nothing.notes, ElementsAre("no object was found in the real frame",
                                         "no object was found in the simulated frame"));
  EXPECT_EQ(nothing.polar.intensity.union_region.mean_absolute(), std::nullopt);
}

TEST(CompareTest, LimitsOfTheOptionsAreThoseOfTheirComments) {
  const auto is_refused = [](auto member, double value) {
    CompareOptions options;
    options.*member = value;
    try {
      options.Check();
    } catch (const DataError&) {
      return true;
    }
    return false;
  };
  for (const double valid : {0.0, 1.0}) EXPECT_FALSE(is_refused(&CompareOptions::echo_fraction, valid));
  for (const double valid : {0.0, 100.0}) EXPECT_FALSE(is_refused(&CompareOptions::region_margin_m, valid));
  for (const double valid : {0.0, 1e3}) EXPECT_FALSE(is_refused(&CompareOptions::db_tolerance, valid));
  for (const double wrong : {-1e-9, 1.0001}) EXPECT_TRUE(is_refused(&CompareOptions::echo_fraction, wrong));
  for (const double wrong : {-1e-9, 100.01}) EXPECT_TRUE(is_refused(&CompareOptions::region_margin_m, wrong));
  EXPECT_TRUE(is_refused(&CompareOptions::db_tolerance, -1e-9));
  EXPECT_TRUE(is_refused(&CompareOptions::db_tolerance, std::nan("")));
}

TEST(CompareTest, DecibelsWithinTheToleranceAreEqual) {
  PolarImage real = SpeckledBlock(1), simulated = SpeckledBlock(2);
  real.scale.db_span = 80.0;
  simulated.scale.db_span = 80.25;
  EXPECT_NO_THROW(CheckComparable(real, simulated, 0.25));
  EXPECT_THROW(CheckComparable(real, simulated, 0.2), DataError);
  EXPECT_THROW(CheckComparable(simulated, real, 0.2), DataError);
}

// Corners that a viewer's picture does not show hold zeros in the one image and anything in the other.
TEST(CompareTest, SamplesThatAreNotValidCountNowhere) {
  CompareOptions options;
  options.valid = Mask(120, 40, 1);
  PolarImage real = SpeckledBlock(1);
  PolarImage simulated = SpeckledBlock(2);
  for (int bin = 0; bin < 20; ++bin) {
    for (int beam = 0; beam < 15 - bin / 2; ++beam) (*options.valid)(bin, beam) = 0;
  }
  const std::int64_t left = CountSet(*options.valid);
  const auto fill = [&](PolarImage& image, float value) {
    for (std::size_t i = 0; i < image.value.size(); ++i) {
      if (options.valid->values()[i] == 0) image.value.values()[i] = value;
    }
  };
  fill(real, 0.0F);
  fill(simulated, 0.0F);
  const FrameMetrics with_zeros = CompareFrames(real, simulated, options);
  fill(simulated, 255.0F);
  const FrameMetrics with_anything = CompareFrames(real, simulated, options);
  EXPECT_EQ(with_anything.polar.intensity.whole.pixels, left);
  for (const auto view : {&FrameMetrics::polar, &FrameMetrics::fan}) {
    EXPECT_EQ((with_anything.*view).occupancy, (with_zeros.*view).occupancy);
    EXPECT_EQ((with_anything.*view).intensity.whole.mean_absolute(),
              (with_zeros.*view).intensity.whole.mean_absolute());
    EXPECT_GT((with_anything.*view).occupancy.iou(), 0.5);
  }
  const std::int64_t all_of_fan = CompareFrames(real, simulated).fan.intensity.whole.pixels;
  EXPECT_LT(with_anything.fan.intensity.whole.pixels, all_of_fan);
  EXPECT_GT(with_anything.fan.intensity.whole.pixels, all_of_fan / 2);
  options.valid = Mask(120, 40, 1);
  EXPECT_EQ(CompareFrames(real, simulated, options).fan.intensity.whole.pixels, all_of_fan);
  options.valid = Mask(3, 4, 1);
  EXPECT_THROW(CompareFrames(real, simulated, options), DataError);
}

// Two frames of one still scene: what the detector and the receiver's noise leave of agreement.
TEST(CompareTest, TwoFramesOfARealStillSceneAgree) {
  SONARCAL_NEEDS_RECORDING(first_path, "aris3000_uxo/frame_0000_128x780.png");
  SONARCAL_NEEDS_RECORDING(second_path, "aris3000_uxo/frame_0001_128x780.png");
  const auto recording = data_io::OpenRecordingOf(first_path.parent_path(),
                                                  std::filesystem::path(SONARCAL_SOURCE_DIR) / "cases/bomb");
  const PolarImage first = recording->ReadFrame(0).image;
  const PolarImage second = recording->ReadFrame(1).image;
  const FrameMetrics metrics = CompareFrames(first, second);
  EXPECT_NEAR(*metrics.polar.occupancy.iou(), 0.912, 0.01);
  EXPECT_NEAR(*metrics.polar.occupancy.ns_over_nr(), 0.973, 0.01);
  EXPECT_NEAR(*metrics.fan.occupancy.iou(), 0.904, 0.015);
  // Receiver noise alone (the speckle is frozen), and less of it where the fan has smoothed it.
  EXPECT_NEAR(*metrics.polar.intensity.union_region.mean_absolute(), 0.061, 0.003);
  EXPECT_NEAR(*metrics.polar.intensity.whole.mean_absolute(), 0.067, 0.001);
  EXPECT_NEAR(*metrics.fan.intensity.union_region.mean_absolute(), 0.045, 0.003);
}

// A mock-up on a floor that fills the image: what the default detector is not for.
TEST(CompareTest, ARegionAndOtsuFindTheMockUpOnItsFloor) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_static");
  const auto recording = data_io::OpenRecording(folder);
  const PolarImage first = recording->ReadFrame(0).image;
  const PolarImage second = recording->ReadFrame(1).image;
  CompareOptions options;
  options.segmentation.method = SegmentationMethod::kOtsu;
  options.segmentation.largest_component_only = false;
  Mask edges(first.value.rows(), first.value.cols());
  edges(233, 109) = edges(262, 152) = 1;  // corners of what is brighter than 80 % of full scale
  options.region = BoxAround(edges, 10, 10);
  EXPECT_GT(*CompareFrames(first, second, options).polar.occupancy.iou(), 0.95);
}

}  // namespace
}  // namespace sonarcal::metrics
