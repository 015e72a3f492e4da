#include "metrics/segmentation/segmentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/imaging/fan_image.h"
#include "metrics/segmentation/scored_image.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using ::testing::HasSubstr;
using testing::MaskOf;
using testing::SpeckledBlock;

// A threshold and nothing around it.
SegmentationOptions Bare(SegmentationMethod method) {
  SegmentationOptions options;
  options.method = method;
  options.blur_rows = options.blur_cols = 0.0;
  options.close_rows = options.close_cols = 0;
  options.largest_component_only = false;
  options.guard_rows = 2;  // images here are small
  options.guard_cols = 3;
  return options;
}

SegmentationOptions FixedAt(double fraction) {
  SegmentationOptions options = Bare(SegmentationMethod::kFixedThreshold);
  options.threshold_fraction = fraction;
  return options;
}

Grid<float> BrightWhere(const Mask& mask, float dark = 10.0f, float bright = 200.0f) {
  Grid<float> value(mask.rows(), mask.cols(), dark);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i]) value.values()[i] = bright;
  }
  return value;
}

std::string MessageOf(const SegmentationOptions& options) {
  try {
    options.Check();
  } catch (const DataError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SegmentationTest, AFixedThresholdIsAFractionOfFullScaleAndNotIncluded) {
  const Segmentation result = Segment(GridOf({{99.0f, 100.0f, 101.0f}}), 400.0, FixedAt(0.25));
  EXPECT_EQ(result.threshold, 100.0);
  EXPECT_EQ(result.object, MaskOf({"..#"}));
}

TEST(SegmentationTest, EveryMethodFindsABrightBlockOnADarkGround) {
  const Mask block = MaskOf({"........", "..###...", "..###...", "........", "........"});
  for (const SegmentationMethod method :
       {SegmentationMethod::kBackgroundSigma, SegmentationMethod::kOtsu, SegmentationMethod::kFixedThreshold,
        SegmentationMethod::kTriangle, SegmentationMethod::kLocalContrast}) {
    EXPECT_EQ(Segment(BrightWhere(block), 255.0, Bare(method)).object, block) << ToString(method);
  }
}

TEST(SegmentationTest, ScalingImageAndFullScaleChangesNothing) {
  const PolarImage image = SpeckledBlock(1);
  Grid<float> scaled = image.value;
  for (float& value : scaled.values()) value *= 16.0f;
  for (const SegmentationMethod method :
       {SegmentationMethod::kBackgroundSigma, SegmentationMethod::kOtsu, SegmentationMethod::kFixedThreshold,
        SegmentationMethod::kTriangle, SegmentationMethod::kLocalContrast}) {
    SegmentationOptions options;
    options.method = method;
    EXPECT_EQ(Segment(image.value, 255.0, options).object, Segment(scaled, 16.0 * 255.0, options).object);
  }
}

TEST(SegmentationTest, TheDefaultsFindABlockInSpeckleAndWidenItByTheBlurAtMost) {
  const Mask object = Segment(SpeckledBlock(2), {}).object;
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 40; ++col) {
      const bool deep_inside = row >= 33 && row < 57 && col >= 12 && col < 23;
      const bool near = row >= 22 && row < 68 && col >= 6 && col < 29;
      if (deep_inside) {
        ASSERT_TRUE(object(row, col)) << row << ", " << col;
      }
      if (!near) {
        ASSERT_FALSE(object(row, col)) << row << ", " << col;
      }
    }
  }
}

TEST(SegmentationTest, BackgroundMayBeLearntOutsideTheRegion) {
  const PolarImage image = SpeckledBlock(3);
  Mask region(120, 40);
  for (int row = 20; row < 70; ++row) {
    for (int col = 5; col < 30; ++col) region(row, col) = 1;
  }
  SegmentationOptions options;
  options.background = BackgroundSample::kOutsideRegion;
  const Mask object = Segment(image, options, &region).object;
  EXPECT_GT(CountSet(object), 30 * 15 * 9 / 10);
  for (std::size_t i = 0; i < object.size(); ++i) ASSERT_LE(object.values()[i], region.values()[i]);

  try {
    Segment(image, options, nullptr);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no pixel lies outside the region"));
  }
}

TEST(SegmentationTest, ObjectOutsideTheRegionIsNotSeenAndDoesNotMoveTheOtsuThreshold) {
  const Grid<float> value = GridOf({{10.0f, 20.0f, 250.0f}, {10.0f, 20.0f, 250.0f}});
  const Mask region = MaskOf({"##.", "##."});
  const Segmentation result = Segment(value, 255.0, Bare(SegmentationMethod::kOtsu), &region);
  EXPECT_EQ(result.threshold, 10.0);
  EXPECT_EQ(result.object, MaskOf({".#.", ".#."}));
}

TEST(SegmentationTest, ConstantAndEmptyImagesHaveNoObject) {
  for (const SegmentationMethod method :
       {SegmentationMethod::kBackgroundSigma, SegmentationMethod::kOtsu, SegmentationMethod::kTriangle,
        SegmentationMethod::kLocalContrast, SegmentationMethod::kCaCfar, SegmentationMethod::kOsCfar}) {
    SegmentationOptions options;  // with its smoothing, which rounds
    options.contrast = 0.0;
    options.method = method;
    for (const float level : {0.0f, 77.7f, 255.0f}) {
      const Segmentation result = Segment(Grid<float>(50, 20, level), 255.0, options);
      EXPECT_EQ(CountSet(result.object), 0) << ToString(method) << " at " << level;
      EXPECT_TRUE(std::isfinite(result.threshold));
    }
    EXPECT_TRUE(Segment(Grid<float>(), 255.0, options).object.empty());
    const Mask nowhere(50, 20);
    EXPECT_EQ(CountSet(Segment(Grid<float>(50, 20, 9.0f), 255.0, options, &nowhere).object), 0);
  }
}

TEST(SegmentationTest, ANoiseFreeImageNeedsTheMinimumContrast) {
  const Mask block = MaskOf({"....", ".##.", "....", "....", "...."});
  const SegmentationOptions options = Bare(SegmentationMethod::kBackgroundSigma);
  EXPECT_EQ(Segment(BrightWhere(block, 10.0f, 11.1f), 255.0, options).object, block);
  EXPECT_EQ(CountSet(Segment(BrightWhere(block, 10.0f, 10.9f), 255.0, options).object), 0);
}

TEST(SegmentationTest, TheLargestComponentIsKeptAndDiagonalNeighboursBelongTogether) {
  SegmentationOptions options = FixedAt(0.5);
  options.largest_component_only = true;
  const Mask all = MaskOf({"##....", "......", "...#..", "....#.", ".....#"});
  EXPECT_EQ(Segment(BrightWhere(all), 255.0, options).object,
            MaskOf({"......", "......", "...#..", "....#.", ".....#"}));
}

TEST(SegmentationTest, SmallComponentsAreDropped) {
  SegmentationOptions options = FixedAt(0.5);
  options.min_area_px = 3;
  const Mask all = MaskOf({"##....", "......", "###..#", "......", "####.."});
  EXPECT_EQ(Segment(BrightWhere(all), 255.0, options).object,
            MaskOf({"......", "......", "###...", "......", "####.."}));
}

TEST(SegmentationTest, ComponentsThatReachTooFarAreDroppedBeforeTheLargestIsKept) {
  SegmentationOptions options = FixedAt(0.5);
  options.largest_component_only = true;
  options.max_cols = 4;
  const Mask all = MaskOf({"######", "......", "##..#.", "##..#.", "....#."});
  EXPECT_EQ(Segment(BrightWhere(all), 255.0, options).object,
            MaskOf({"......", "......", "##....", "##....", "......"}));
  options.max_rows = 1;
  EXPECT_EQ(CountSet(Segment(BrightWhere(all), 255.0, options).object), 0);
}

TEST(SegmentationTest, OpeningRemovesAThinLineAndClosingFillsAGap) {
  SegmentationOptions open = FixedAt(0.5);
  open.open_rows = open.open_cols = 3;
  EXPECT_EQ(
      Segment(BrightWhere(MaskOf({"........", ".###....", ".######.", ".###....", "........"})), 255.0, open)
          .object,
      MaskOf({"........", ".###....", ".###....", ".###....", "........"}));
  SegmentationOptions close = FixedAt(0.5);
  close.close_rows = 3;
  EXPECT_EQ(Segment(BrightWhere(MaskOf({"...", ".#.", "...", ".#.", "..."})), 255.0, close).object,
            MaskOf({"...", ".#.", ".#.", ".#.", "..."}));
}

TEST(SegmentationTest, AMedianRemovesASinglePixel) {
  SegmentationOptions options = FixedAt(0.5);
  options.median_px = 3;
  EXPECT_EQ(
      CountSet(
          Segment(BrightWhere(MaskOf({".....", ".....", "..#..", ".....", "....."})), 255.0, options).object),
      0);
}

// A Gaussian of standard deviation 0.5 leaves 79 % in the middle and gives 11 % to each neighbour.
TEST(SegmentationTest, ABlurAlongOneAxisLeavesTheOtherAlone) {
  const Mask pixel = MaskOf({".....", ".....", "..#..", ".....", "....."});
  SegmentationOptions options = FixedAt(0.1);
  options.blur_rows = 0.5;
  EXPECT_EQ(Segment(BrightWhere(pixel, 0.0f, 255.0f), 255.0, options).object,
            MaskOf({".....", "..#..", "..#..", "..#..", "....."}));
  options.threshold_fraction = 0.11;
  EXPECT_EQ(Segment(BrightWhere(pixel, 0.0f, 255.0f), 255.0, options).object, pixel);
  options.threshold_fraction = 0.79;
  EXPECT_EQ(CountSet(Segment(BrightWhere(pixel, 0.0f, 255.0f), 255.0, options).object), 0);
  options = FixedAt(0.1);
  options.blur_cols = 0.5;
  EXPECT_EQ(Segment(BrightWhere(pixel, 0.0f, 255.0f), 255.0, options).object,
            MaskOf({".....", ".....", ".###.", ".....", "....."}));
}

// The mean of valid neighbours only, by the sum over them.
TEST(SegmentationTest, ABlurWeighsOnlyValidPixels) {
  const Grid<float> value = GridOf({{40.0f, 80.0f, 240.0f, 120.0f, 20.0f}});
  const Mask valid = MaskOf({"##.##"});
  SegmentationOptions options = FixedAt(0.0);
  options.blur_cols = 1.0;
  const auto blurred = [&](int col) {
    double sum = 0.0, weights = 0.0;
    for (int mirrored = col - 4; mirrored <= col + 4; ++mirrored) {
      const int other = mirrored < 0 ? -mirrored : mirrored > 4 ? 8 - mirrored : mirrored;  // OpenCV's border
      if (valid(0, other) == 0) continue;
      const double weight = std::exp(-0.5 * (mirrored - col) * (mirrored - col));
      sum += weight * value(0, other);
      weights += weight;
    }
    return sum / weights;
  };
  for (const int col : {0, 1, 3, 4}) {
    options.threshold_fraction = (blurred(col) - 0.1) / 255.0;
    EXPECT_TRUE(Segment(value, 255.0, options, nullptr, &valid).object(0, col)) << col;
    options.threshold_fraction = (blurred(col) + 0.1) / 255.0;
    EXPECT_FALSE(Segment(value, 255.0, options, nullptr, &valid).object(0, col)) << col;
  }
}

TEST(SegmentationTest, ValuesWithinAHundredThousandthOfFullScaleAreEqual) {
  for (const double full_scale : {1.0, 255.0, 4000.0}) {
    const auto low = static_cast<float>(0.5 * full_scale);
    const auto just = static_cast<float>(0.5 * full_scale * (1.0 + 1.5e-5));
    const auto more = static_cast<float>(0.5 * full_scale * (1.0 + 4e-5));
    for (const SegmentationMethod method : {SegmentationMethod::kOtsu, SegmentationMethod::kLocalContrast}) {
      SegmentationOptions options = Bare(method);
      options.contrast = 0.0;
      Grid<float> value(20, 20, low);
      value(10, 10) = just;
      EXPECT_EQ(CountSet(Segment(value, full_scale, options).object), 0) << full_scale;
      value(10, 10) = more;
      EXPECT_EQ(CountSet(Segment(value, full_scale, options).object), 1) << full_scale;
    }
  }
}

TEST(SegmentationTest, EachLimitOfAComponentCountsAlone) {
  const Mask all = MaskOf({"#.....", "......", "###..#", ".....#", ".....#"});
  SegmentationOptions options = FixedAt(0.5);
  options.min_area_px = 2;
  EXPECT_EQ(Segment(BrightWhere(all), 255.0, options).object,
            MaskOf({"......", "......", "###..#", ".....#", ".....#"}));
  options.min_area_px = 3;
  EXPECT_EQ(CountSet(Segment(BrightWhere(all), 255.0, options).object), 6);
  options.min_area_px = 4;
  EXPECT_EQ(CountSet(Segment(BrightWhere(all), 255.0, options).object), 0);
  options = FixedAt(0.5);
  options.max_rows = 1;
  EXPECT_EQ(Segment(BrightWhere(all), 255.0, options).object,
            MaskOf({"#.....", "......", "###...", "......", "......"}));
  options = FixedAt(0.5);
  options.max_cols = 1;
  EXPECT_EQ(Segment(BrightWhere(all), 255.0, options).object,
            MaskOf({"#.....", "......", ".....#", ".....#", ".....#"}));
}

TEST(SegmentationTest, OfEqualComponentsTheFirstFromTheTopIsKept) {
  SegmentationOptions options = FixedAt(0.5);
  options.largest_component_only = true;
  EXPECT_EQ(
      Segment(BrightWhere(MaskOf({".....", "...##", ".....", "##...", "....."})), 255.0, options).object,
      MaskOf({".....", "...##", ".....", ".....", "....."}));
}

TEST(SegmentationTest, OpeningAndClosingMayActAlongOneAxis) {
  const Mask cross = MaskOf({"..#..", "..#..", "#####", "..#..", "..#.."});
  SegmentationOptions options = FixedAt(0.5);
  options.open_rows = 3;
  EXPECT_EQ(Segment(BrightWhere(cross), 255.0, options).object,
            MaskOf({"..#..", "..#..", "..#..", "..#..", "..#.."}));
  options = FixedAt(0.5);
  options.open_cols = 3;
  EXPECT_EQ(Segment(BrightWhere(cross), 255.0, options).object,
            MaskOf({".....", ".....", "#####", ".....", "....."}));
  options = FixedAt(0.5);
  options.close_cols = 3;
  EXPECT_EQ(Segment(BrightWhere(MaskOf({"#.#..", "....."})), 255.0, options).object,
            MaskOf({"###..", "....."}));
}

// A closing only adds and an opening only removes pixels, so neither moves an object.
TEST(SegmentationTest, RectanglesOfEvenSizeDoNotMoveAnObject) {
  const Mask object = MaskOf({"........", "..####..", "..####..", "..####..", "..####..", "........"});
  for (const int size : {2, 4}) {
    SegmentationOptions options = FixedAt(0.5);
    options.open_rows = options.open_cols = size;
    EXPECT_EQ(Segment(BrightWhere(object), 255.0, options).object, object);
    options = FixedAt(0.5);
    options.close_rows = options.close_cols = size;
    EXPECT_EQ(Segment(BrightWhere(object), 255.0, options).object, object);
  }
  SegmentationOptions options = FixedAt(0.5);
  options.close_cols = 2;
  EXPECT_EQ(Segment(BrightWhere(MaskOf({"#.#..", "....."})), 255.0, options).object,
            MaskOf({"###..", "....."}));
}

TEST(SegmentationTest, TheBordersOfAFanDoNotDarkenTheirNeighbours) {
  const FanMap map(testing::SmallAxes(120, 40));
  PolarImage bright{testing::SmallAxes(120, 40), {}, Grid<float>(120, 40, 100.0f)};
  SegmentationOptions options = FixedAt(99.9 / 255.0);
  options.blur_rows = options.blur_cols = 3.0;
  const FanImage fan = map.Apply(bright);
  EXPECT_EQ(Segment(fan, options).object, fan.inside);
}

TEST(SegmentationTest, InvalidPixelsMayHoldAnything) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Grid<float> value = GridOf({{10.0f, 200.0f, nan}});
  const Mask valid = MaskOf({"##."});
  SegmentationOptions options = FixedAt(0.5);
  options.blur_cols = 0.1;
  EXPECT_EQ(Segment(value, 255.0, options, nullptr, &valid).object, MaskOf({".#."}));
  try {
    Segment(value, 255.0, options);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("pixel (row 0, column 2) is nan"));
  }
}

TEST(SegmentationTest, TheFirstPixelCountsAsAnyOther) {
  Grid<float> value = GridOf({{200.0f, 10.0f, 20.0f, 12.0f}});
  EXPECT_EQ(Segment(value, 255.0, Bare(SegmentationMethod::kOtsu)).threshold, 20.0);
  value(0, 0) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(Segment(value, 255.0, Bare(SegmentationMethod::kOtsu)), DataError);
}

TEST(ScoredImageTest, TheSettingOfAnImagesOwnThresholdIsItsPartOfFullScale) {
  const Grid<float> value = GridOf({{10.0f, 12.0f, 11.0f, 200.0f, 220.0f}});
  const ScoredImage scored(value, ImageScale{}, Bare(SegmentationMethod::kOtsu), nullptr, nullptr);
  EXPECT_EQ(scored.setting(), 12.0 / 255.0);
  EXPECT_EQ(scored.ThresholdAt(scored.setting()), 12.0);
  EXPECT_EQ(scored.ThresholdAt(0.5), 127.5);
}

TEST(ScoredImageTest, AContrastInDecibelsNeedsBothEndsOfTheScaleOrItsSpan) {
  const Grid<float> value(3, 3, 10.0f);
  SegmentationOptions options = Bare(SegmentationMethod::kLocalContrast);
  options.contrast_db = 6.0;
  ImageScale scale;
  scale.db_span = 60.0;
  EXPECT_EQ(ScoredImage(value, scale, options, nullptr, nullptr).setting(), 0.1);
  scale.db_min = 20.0;  // one end says nothing
  EXPECT_EQ(ScoredImage(value, scale, options, nullptr, nullptr).setting(), 0.1);
  scale.db_max = 60.0;
  EXPECT_EQ(ScoredImage(value, scale, options, nullptr, nullptr).setting(), 0.15);
  scale.db_span.reset();
  scale.db_max.reset();
  EXPECT_THROW(ScoredImage(value, scale, options, nullptr, nullptr), DataError);
}

TEST(SegmentationTest, HolesAndHullsAreFilled) {
  const Mask ring = MaskOf({".......", ".####..", ".#..#..", ".#..##.", ".####..", "......."});
  SegmentationOptions options = FixedAt(0.5);
  options.fill = RegionFill::kHoles;
  EXPECT_EQ(Segment(BrightWhere(ring), 255.0, options).object,
            MaskOf({".......", ".####..", ".####..", ".#####.", ".####..", "......."}));
  const Mask hook = MaskOf({"......", ".#....", ".#....", ".#....", ".####.", "......"});
  EXPECT_EQ(Segment(BrightWhere(hook), 255.0, options).object, hook);
  options.fill = RegionFill::kHull;
  EXPECT_EQ(Segment(BrightWhere(hook), 255.0, options).object,
            MaskOf({"......", ".#....", ".##...", ".###..", ".####.", "......"}));
}

TEST(SegmentationTest, NothingIsFilledBeyondTheRegionOfInterest) {
  SegmentationOptions options = FixedAt(0.5);
  options.fill = RegionFill::kHull;
  const Mask region = MaskOf({"####", "##.#", "####"});
  EXPECT_EQ(Segment(BrightWhere(MaskOf({"#..#", "#..#", "####"})), 255.0, options, &region).object,
            MaskOf({"####", "##.#", "####"}));
}

TEST(SegmentationOptionsTest, AnInvalidOptionIsNamedWithValueAndLimit) {
  EXPECT_EQ(MessageOf({}), "no error");
  EXPECT_EQ(MessageOf({.sigma_count = 0.0}), "segmentation sigma_count is 0, expected more than 0");
  EXPECT_EQ(MessageOf({.threshold_fraction = 1.5}),
            "segmentation threshold_fraction is 1.5, expected 0 to 1");
  EXPECT_EQ(MessageOf({.median_px = 4}), "segmentation median_px is 4, expected 0, 3 or 5");
  EXPECT_THAT(MessageOf({.blur_rows = -1.0}), HasSubstr("blur_rows is -1"));
  EXPECT_THAT(MessageOf({.blur_rows = std::nan("")}), HasSubstr("blur_rows is nan"));
  EXPECT_THAT(MessageOf({.close_cols = -2}), HasSubstr("close_cols is -2"));
  EXPECT_THAT(MessageOf({.min_area_px = -1}), HasSubstr("min_area_px is -1"));
  EXPECT_THAT(MessageOf({.contrast = 1.1}), HasSubstr("contrast is 1.1, expected 0 to 1"));
  EXPECT_THAT(MessageOf({.contrast_db = -3.0}), HasSubstr("contrast_db is -3"));
  EXPECT_THAT(MessageOf({.guard_cols = 1001}), HasSubstr("guard_cols is 1001"));
  EXPECT_THAT(MessageOf({.training_rows = 0, .training_cols = 0}), HasSubstr("training_rows is 0"));
  EXPECT_THAT(MessageOf({.false_alarm_rate = 0.0}), HasSubstr("false_alarm_rate is 0, expected more than 0"));
  EXPECT_THAT(MessageOf({.cell_rows = 4}), HasSubstr("cell_rows is 4, expected an odd number"));
  EXPECT_THAT(MessageOf({.looks = 0.04}), HasSubstr("looks is 0.04"));
  EXPECT_THAT(MessageOf({.os_quantile = 1.0}), HasSubstr("os_quantile is 1"));
  EXPECT_THAT(MessageOf({.method = SegmentationMethod::kLikelihoodRatio}),
              HasSubstr("has no law of the background"));
}

// Both ends of each range that a field's comment states: the last value is valid, the next is not.
TEST(SegmentationOptionsTest, LimitsAreThoseOfTheComments) {
  const auto message = [](auto member, auto value) {
    SegmentationOptions options;
    options.*member = value;
    return MessageOf(options);
  };
  const auto expect_real = [&](auto member, double low, double high) {
    for (const double valid : {low, high}) EXPECT_EQ(message(member, valid), "no error");
    EXPECT_NE(message(member, std::nextafter(low, -1e9)), "no error") << low;
    EXPECT_NE(message(member, std::nextafter(high, 1e9)), "no error") << high;
  };
  using Options = SegmentationOptions;
  expect_real(&Options::min_contrast, 0.0, 1.0);
  expect_real(&Options::threshold_fraction, 0.0, 1.0);
  expect_real(&Options::blur_rows, 0.0, 100.0);
  expect_real(&Options::blur_cols, 0.0, 100.0);
  expect_real(&Options::contrast, 0.0, 1.0);
  expect_real(&Options::contrast_db, 0.0, 200.0);
  expect_real(&Options::looks, kMinLooks, kMaxLooks);
  expect_real(&Options::os_quantile, 0.01, 0.99);
  EXPECT_EQ(message(&Options::false_alarm_rate, std::nextafter(1.0, 0.0)), "no error");
  EXPECT_NE(message(&Options::false_alarm_rate, 1.0), "no error");
  EXPECT_EQ(message(&Options::sigma_count, 1e-300), "no error");
  EXPECT_NE(message(&Options::sigma_count, std::numeric_limits<double>::infinity()), "no error");

  const auto expect_whole = [&](int Options::*member, int low, int high) {
    for (const int valid : {low, high}) EXPECT_EQ(message(member, valid), "no error");
    EXPECT_NE(message(member, low - 1), "no error") << low;
    if (high < 1000000) {
      EXPECT_NE(message(member, high + 1), "no error") << high;
    }
  };
  for (const auto member :
       {&Options::open_rows, &Options::open_cols, &Options::close_rows, &Options::close_cols})
    expect_whole(member, 0, 1001);
  for (const auto member :
       {&Options::guard_rows, &Options::guard_cols, &Options::training_rows, &Options::training_cols})
    expect_whole(member, 0, 1000);
  for (const auto member : {&Options::min_area_px, &Options::max_rows, &Options::max_cols})
    expect_whole(member, 0, 1000000);
  for (const auto member : {&Options::cell_rows, &Options::cell_cols}) {
    for (const int valid : {1, 3, 99, 101}) EXPECT_EQ(message(member, valid), "no error") << valid;
    for (const int other : {-1, 0, 2, 100, 102, 103}) EXPECT_NE(message(member, other), "no error") << other;
  }
  for (const int valid : {0, 3, 5}) EXPECT_EQ(message(&Options::median_px, valid), "no error");
  for (const int other : {-1, 1, 2, 4, 6, 7})
    EXPECT_NE(message(&Options::median_px, other), "no error") << other;
  EXPECT_EQ(MessageOf({.training_rows = 0, .training_cols = 1}), "no error");
  EXPECT_EQ(MessageOf({.training_rows = 1, .training_cols = 0}), "no error");
}

TEST(SegmentationOptionsTest, EveryMethodIsFoundByItsName) {
  for (const auto& [word, method] : WordsOf(std::type_identity<SegmentationMethod>{}))
    EXPECT_EQ(FromWord<SegmentationMethod>(ToString(method)), method) << word;
  EXPECT_FALSE(FromWord<SegmentationMethod>("magic"));
}

}  // namespace
}  // namespace sonarcal::metrics
