#include "metrics/segmentation/cfar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/imaging/fan_image.h"
#include "core/math/local_sums.h"
#include "metrics/segmentation/false_alarm.h"
#include "metrics/segmentation/segmentation.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::HasSubstr;

Grid<float> Noise(std::uint64_t seed, double looks, int rows = 400, int cols = 128) {
  std::mt19937_64 random(seed);
  std::gamma_distribution<double> power(looks, 1.0 / looks);
  Grid<float> noise(rows, cols);
  // As strong as it may be: the rate does not depend on it.
  for (float& value : noise.values()) value = static_cast<float>(1e4 * power(random));
  return noise;
}

Grid<float> LogGrey(const Grid<float>& power, double counts_per_neper) {
  Grid<float> grey(power.rows(), power.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) {
    grey.values()[i] = static_cast<float>(100.0 + counts_per_neper * std::log(power.values()[i]));
  }
  return grey;
}

double ShareAboveRate(const Grid<float>& decades, double rate) {
  const double limit = -std::log10(rate);
  const auto above = std::count_if(decades.values().begin(), decades.values().end(),
                                   [&](float value) { return value > limit; });
  return static_cast<double>(above) / static_cast<double>(decades.size());
}

SegmentationOptions Options(SegmentationMethod method) {
  SegmentationOptions options;
  options.method = method;
  options.guard_rows = 3;
  options.guard_cols = 2;
  options.training_rows = 5;
  options.training_cols = 4;
  return options;
}

constexpr std::array kMethods = {SegmentationMethod::kCaCfar, SegmentationMethod::kOsCfar};

// Over 51,200 pixels a rate of 0.01 is met to 0.00044 (one standard deviation), if pixels were independent;
// as neighbours share training cells, up to twice that. 0.001: 0.00014.
TEST(CfarTest, TheStatedRateHoldsOnExponentialAndGammaNoise) {
  for (const SegmentationMethod method : kMethods) {
    for (const double looks : {1.0, 3.0}) {
      SegmentationOptions options = Options(method);
      options.looks = looks;
      const Grid<float> decades = CfarDecadesInPower(Noise(1, looks), options);
      EXPECT_NEAR(ShareAboveRate(decades, 1e-1), 1e-1, 4e-3) << ToString(method) << ", looks " << looks;
      EXPECT_NEAR(ShareAboveRate(decades, 1e-2), 1e-2, 1.2e-3) << ToString(method) << ", looks " << looks;
      EXPECT_NEAR(ShareAboveRate(decades, 1e-3), 1e-3, 4.5e-4) << ToString(method) << ", looks " << looks;
    }
  }
}

TEST(CfarTest, TheRateHoldsForCellsOfSeveralPixels) {
  for (const SegmentationMethod method : kMethods) {
    SegmentationOptions options = Options(method);
    options.cell_rows = 5;
    options.cell_cols = 3;
    const Grid<float> decades = CfarDecadesInPower(Noise(2, 1.0), options);
    // Cells overlap: about 3,400 of them are independent. The image's edge, where cells are smaller, is not
    // looked at.
    int above = 0, count = 0;
    for (int row = 2; row < decades.rows() - 2; ++row) {
      for (int col = 1; col < decades.cols() - 1; ++col, ++count) above += decades(row, col) > 2.0F;
    }
    EXPECT_NEAR(static_cast<double>(above) / count, 1e-2, 5e-3) << ToString(method);
  }
}

TEST(CfarTest, InGreyTheRateHoldsForALogarithmOfAnySlope) {
  for (const SegmentationMethod method : kMethods) {
    SegmentationOptions options = Options(method);
    options.guard_rows = options.guard_cols = 2;
    options.training_rows = options.training_cols = 10;
    for (const double slope : {3.0, 40.0}) {
      const Grid<float> decades = CfarDecadesInGrey(LogGrey(Noise(3, 1.0), slope), 255.0, options);
      EXPECT_NEAR(ShareAboveRate(decades, 1e-2), 1e-2, 1.5e-3) << ToString(method) << ", slope " << slope;
      EXPECT_NEAR(ShareAboveRate(decades, 1e-3), 1e-3, 6e-4) << ToString(method) << ", slope " << slope;
    }
  }
}

// Word for word: the training cells of each pixel gathered, averaged, sorted.
TEST(CfarTest, AgreesWithTheWindowGatheredPixelByPixel) {
  const Grid<float> power = Noise(4, 1.0, 40, 30);
  const TrainingShape shape = {3, 2, 5, 4};
  const Grid<float> averaged = CfarDecadesInPower(power, Options(SegmentationMethod::kCaCfar));
  const Grid<float> ordered = CfarDecadesInPower(power, Options(SegmentationMethod::kOsCfar));
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 30; ++col) {
      const int top = std::clamp(row - 8, 0, 40 - 17);
      const int left = std::clamp(col - 6, 0, 30 - 13);
      std::vector<double> cells;
      double sum = 0.0;
      for (int r = top; r < top + 17; ++r) {
        for (int c = left; c < left + 13; ++c) {
          if (std::abs(r - row) <= shape.guard_rows && std::abs(c - col) <= shape.guard_cols) continue;
          cells.push_back(power(r, c));
          sum += power(r, c);
        }
      }
      const auto n = static_cast<double>(cells.size());
      ASSERT_NEAR(averaged(row, col), n * std::log10(1.0 + power(row, col) / sum), 1e-4);
      std::sort(cells.begin(), cells.end());
      const int rank = static_cast<int>(std::lround(0.75 * n));
      const double exact =
          OrderedStatisticLaw(1.0, 1.0, static_cast<int>(n), rank).Decades(power(row, col) / cells[rank - 1]);
      ASSERT_NEAR(ordered(row, col), exact, 5e-3 * (1.0 + exact)) << row << ", " << col;
    }
  }
}

// Three pixels of a third of a look each: the cell has one look, its training cells have fewer.
TEST(CfarTest, OrderedCellsOfOneLookAreNotExponentialWhereTheirPixelsAreNot) {
  SegmentationOptions options = Options(SegmentationMethod::kOsCfar);
  options.looks = 1.0 / 3.0;
  options.cell_rows = 3;
  const Grid<float> power = Noise(6, 1.0 / 3.0, 40, 30);
  const Grid<float> decades = CfarDecadesInPower(power, options);
  std::vector<double> cells;
  for (int row = 20 - 8; row <= 20 + 8; ++row) {
    for (int col = 15 - 6; col <= 15 + 6; ++col) {
      if (std::abs(row - 20) > 3 || std::abs(col - 15) > 2) cells.push_back(power(row, col));
    }
  }
  std::sort(cells.begin(), cells.end());
  const int count = static_cast<int>(cells.size());
  const int rank = static_cast<int>(std::lround(0.75 * count));
  const double cell = (power(19, 15) + power(20, 15) + power(21, 15)) / 3.0;
  const double exact = OrderedStatisticLaw(1.0, 1.0 / 3.0, count, rank).Decades(cell / cells[rank - 1]);
  EXPECT_NEAR(decades(20, 15), exact, 1e-2 * (1.0 + exact));
  EXPECT_GT(std::abs(OrderedStatisticLaw(1.0, 1.0, count, rank).Decades(cell / cells[rank - 1]) - exact),
            0.05);
}

// Grey levels: the excess over the mean in standard deviations, or over a quantile in distances between two.
TEST(CfarTest, InGreyAgreesWithTheWindowGatheredPixelByPixel) {
  const Grid<float> grey = LogGrey(Noise(4, 1.0, 40, 30), 12.0);
  const Grid<float> averaged = CfarDecadesInGrey(grey, 255.0, Options(SegmentationMethod::kCaCfar));
  const Grid<float> ordered = CfarDecadesInGrey(grey, 255.0, Options(SegmentationMethod::kOsCfar));
  const LogMeanLaw mean_law(1.0);
  const LogQuantileLaw quantile_law(1.0, 0.25, 0.75);
  for (int row = 0; row < 40; row += 3) {
    for (int col = 0; col < 30; ++col) {
      const int top = std::clamp(row - 8, 0, 40 - 17);
      const int left = std::clamp(col - 6, 0, 30 - 13);
      std::vector<double> cells;
      double sum = 0.0, squares = 0.0;
      for (int r = top; r < top + 17; ++r) {
        for (int c = left; c < left + 13; ++c) {
          if (std::abs(r - row) <= 3 && std::abs(c - col) <= 2) continue;
          cells.push_back(grey(r, c));
          sum += grey(r, c);
          squares += static_cast<double>(grey(r, c)) * grey(r, c);
        }
      }
      const auto n = static_cast<double>(cells.size());
      const double mean = sum / n;
      const double by_mean = mean_law.Decades((grey(row, col) - mean) / std::sqrt(squares / n - mean * mean));
      ASSERT_NEAR(averaged(row, col), by_mean, 1e-3 * (1.0 + by_mean)) << row << ", " << col;
      std::sort(cells.begin(), cells.end());
      const double high = cells[static_cast<std::size_t>(std::lround(0.75 * n)) - 1];
      const double low = cells[static_cast<std::size_t>(std::lround(0.25 * n)) - 1];
      const double by_quantile = quantile_law.Decades((grey(row, col) - high) / (high - low));
      ASSERT_NEAR(ordered(row, col), by_quantile, 2e-2 * (1.0 + by_quantile)) << row << ", " << col;
    }
  }
}

// Levels that differ by less than a thousandth of full scale have that spread.
TEST(CfarTest, InGreyASpreadIsAtLeastAThousandthOfFullScale) {
  for (const double full_scale : {255.0, 4000.0}) {
    Grid<float> grey(40, 30, static_cast<float>(0.4 * full_scale));
    grey(20, 15) = static_cast<float>(0.403 * full_scale);
    const Grid<float> averaged = CfarDecadesInGrey(grey, full_scale, Options(SegmentationMethod::kCaCfar));
    EXPECT_NEAR(averaged(20, 15), LogMeanLaw(1.0).Decades(3.0), 1e-3);
    const Grid<float> ordered = CfarDecadesInGrey(grey, full_scale, Options(SegmentationMethod::kOsCfar));
    EXPECT_NEAR(ordered(20, 15), LogQuantileLaw(1.0, 0.25, 0.75).Decades(3.0), 1e-3);
  }
}

TEST(CfarTest, SilenceIsExceededByAnyEchoAndByNoSilence) {
  Grid<float> power(40, 30, 0.0F);
  power(20, 15) = 1.0F;
  const Grid<float> averaged = CfarDecadesInPower(power, Options(SegmentationMethod::kCaCfar));
  EXPECT_EQ(averaged(20, 15), static_cast<float>(kMaxDecades));
  EXPECT_EQ(averaged(20, 14), 0.0F);
  const Grid<float> silence(40, 30, 0.0F);
  EXPECT_EQ(CfarDecadesInPower(silence, Options(SegmentationMethod::kCaCfar))(20, 15), 0.0F);
}

TEST(CfarTest, ASecondObjectHidesAWeakOneFromCellAveragingOnly) {
  Grid<float> power = Noise(5, 1.0, 60, 40);
  power(30, 20) = 2e5F;
  for (int row = 34; row < 38; ++row) {
    for (int col = 18; col < 23; ++col) power(row, col) = 1e7F;
  }
  EXPECT_LT(CfarDecadesInPower(power, Options(SegmentationMethod::kCaCfar))(30, 20), 3.0F);
  EXPECT_GT(CfarDecadesInPower(power, Options(SegmentationMethod::kOsCfar))(30, 20), 3.0F);
}

TEST(CfarTest, FindsABlockInSpeckleWhetherTheDisplayIsKnownOrNot) {
  PolarImage image = testing::SpeckledBlock(6);
  for (const SegmentationMethod method : kMethods) {
    SegmentationOptions options;
    options.method = method;
    options.guard_rows = 30;  // as large as the block: no cell of it is compared with others of it
    options.guard_cols = 15;
    options.training_rows = 12;
    options.training_cols = 5;
    options.cell_rows = options.cell_cols = 3;
    options.false_alarm_rate = 1e-4;
    for (const bool known : {true, false}) {
      image.scale.db_span = known ? std::optional<double>(80.0) : std::nullopt;
      const Mask object = Segment(image, options).object;
      int hits = 0;
      for (int row = 30; row < 60; ++row) {
        for (int col = 10; col < 25; ++col) hits += object(row, col);
      }
      EXPECT_GT(hits, 30 * 15 * 85 / 100) << ToString(method) << known;
      EXPECT_LT(CountSet(object) - hits, 160) << ToString(method) << known;
    }
  }
}

// What a viewer's picture does not show is 0, and would be the quietest background of all.
TEST(CfarTest, InvalidCellsAreNoTrainingCells) {
  Grid<float> power = Noise(7, 1.0, 200, 128);
  Mask valid(200, 128, 1);
  for (int row = 0; row < 200; ++row) {
    for (int col = 0; col < 128; ++col) {
      if (col > 20 + row / 4 && col < 100) continue;
      valid(row, col) = 0;
      power(row, col) = 0.0F;
    }
  }
  const auto valid_count = static_cast<double>(CountSet(valid));
  for (const SegmentationMethod method : kMethods) {
    const auto rate = [&](const Grid<float>& decades) {
      double above = 0.0;
      for (std::size_t i = 0; i < decades.size(); ++i) {
        above += valid.values()[i] != 0 && decades.values()[i] > 2.0F;
      }
      return above / valid_count;
    };
    EXPECT_NEAR(rate(CfarDecadesInPower(power, Options(method), &valid)), 1e-2, 3e-3) << ToString(method);
    EXPECT_GT(rate(CfarDecadesInPower(power, Options(method))), 1.4e-2) << ToString(method);
  }
  // The same by the call that commands make, at a rate of one in a thousand.
  PolarImage image{testing::SmallAxes(200, 128), {}, Grid<float>(200, 128)};
  image.scale.db_span = 80.0;
  for (std::size_t i = 0; i < power.size(); ++i) {
    const double level_db = power.values()[i] > 0.0F ? 50.0 + 10.0 * std::log10(power.values()[i]) : 0.0;
    image.value.values()[i] = static_cast<float>(level_db / 80.0 * image.scale.full_scale);
  }
  for (const SegmentationMethod method : kMethods) {
    SegmentationOptions options = Options(method);
    options.false_alarm_rate = 1e-3;
    options.cfar_domain = CfarDomain::kPower;
    options.close_rows = options.close_cols = 0;
    const auto marked = static_cast<double>(CountSet(Segment(image, options, nullptr, &valid).object));
    EXPECT_LT(marked / valid_count, 2e-3) << ToString(method);
  }
  const Mask nowhere(200, 128);
  const Grid<float> none = CfarDecadesInPower(power, Options(SegmentationMethod::kOsCfar), &nowhere);
  for (const float decades : none.values()) ASSERT_EQ(decades, 0.0F);
}

TEST(CfarTest, ANoiseFreeImageHasItsEchoesAndAConstantOneNone) {
  for (const SegmentationMethod method : kMethods) {
    for (const CfarDomain domain : {CfarDomain::kGrey, CfarDomain::kPower}) {
      PolarImage image{testing::SmallAxes(60, 40), {}, Grid<float>(60, 40, 0.0f)};
      image.scale.db_span = 60.0;
      SegmentationOptions options = Options(method);
      options.cfar_domain = domain;
      options.close_rows = options.close_cols = 0;
      EXPECT_EQ(CountSet(Segment(image, options).object), 0);
      image.value(30, 20) = image.value(31, 20) = 120.0f;
      const Mask object = Segment(image, options).object;
      EXPECT_EQ(CountSet(object), 2) << ToString(method) << ' ' << ToString(domain);
      EXPECT_TRUE(object(30, 20));
    }
  }
}

TEST(CfarTest, OptionsThatLeaveNoTestAreRefused) {
  PolarImage image = testing::SpeckledBlock(1);
  SegmentationOptions options = Options(SegmentationMethod::kCaCfar);
  options.cfar_domain = CfarDomain::kPower;
  try {
    Segment(image, options);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("does not state its dB scale"));
  }
  options.cfar_domain = CfarDomain::kAuto;
  try {
    Segment(FanMap(image.axes).Apply(image), options);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("of a fan image"));
  }
  options.guard_rows = 200;
  options.guard_cols = 60;
  try {
    Segment(image, options);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no training cell about pixel (row 0, column 0)"));
  }
}

TEST(LocalSumsTest, MomentsKeepTheirDigitsFarFromZero) {
  Grid<float> value(50, 50);
  for (std::size_t i = 0; i < value.size(); ++i) value.values()[i] = 1e6f + static_cast<float>(i % 2);
  const Moments moments = LocalSums(value).Over(WindowAt({1, 1, 10, 10}, 25, 25, 50, 50));
  // Odd columns hold 1 more: 11 of the window's 23, and 1 of the guard's 3.
  const double share = (11.0 * 23.0 - 1.0 * 3.0) / (23.0 * 23.0 - 3.0 * 3.0);
  EXPECT_NEAR(moments.mean, 1e6 + share, 1e-6);
  EXPECT_NEAR(moments.spread, std::sqrt(share * (1.0 - share)), 1e-6);
}

TEST(LocalSumsTest, ABoxMeanAtTheBorderIsOfThePixelsThatThereAre) {
  const Grid<float> mean = BoxMean(testing::GridOf({{1.0f, 3.0f, 8.0f}, {5.0f, 7.0f, 0.0f}}), 3, 3);
  EXPECT_FLOAT_EQ(mean(0, 0), 4.0f);
  EXPECT_FLOAT_EQ(mean(1, 1), 4.0f);
  EXPECT_FLOAT_EQ(mean(0, 2), 4.5f);
}

}  // namespace
}  // namespace sonarcal::metrics
