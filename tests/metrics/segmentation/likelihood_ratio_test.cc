#include "metrics/segmentation/likelihood_ratio.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "metrics/segmentation/false_alarm.h"
#include "metrics/segmentation/segmentation.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::HasSubstr;

constexpr double kSpanDb = 80.0;

// A floor that rises with range and differs between beams.
BackgroundLaw SlopedLaw(int rows, int cols, double looks) {
  BackgroundLaw law{Grid<float>(rows, cols), looks, LogDisplayPower(kSpanDb)};
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      law.mean_power(row, col) = static_cast<float>(std::pow(10.0, 2.5 + row / 400.0 + 0.5 * (col % 2)));
    }
  }
  return law;
}

// Grey levels as a display over 80 dB shows that law's speckle.
Grid<float> Draw(const BackgroundLaw& law, std::uint64_t seed, double full_scale) {
  std::mt19937_64 random(seed);
  std::gamma_distribution<double> speckle(law.looks, 1.0 / law.looks);
  Grid<float> grey(law.mean_power.rows(), law.mean_power.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const double level_db = 10.0 * std::log10(law.mean_power.values()[i] * speckle(random));
    grey.values()[i] = static_cast<float>(std::round(std::clamp(level_db / kSpanDb, 0.0, 1.0) * full_scale));
  }
  return grey;
}

double ShareAbove(const Grid<float>& decades, double limit) {
  double above = 0.0;
  for (const float value : decades.values()) above += value > limit;
  return above / static_cast<double>(decades.size());
}

// 12 bits, so that levels are fine against the law. Of 512,000 pixels three standard deviations.
TEST(LikelihoodRatioTest, TheStatedRateHoldsWhereTheLawDoes) {
  for (const double looks : {1.0, 2.5}) {
    const BackgroundLaw law = SlopedLaw(400, 1280, looks);
    const Grid<float> decades = LikelihoodDecades(Draw(law, 7, 4095.0), 4095.0, law, 1, 1);
    EXPECT_NEAR(ShareAbove(decades, 1.0), 1e-1, 1.3e-3) << looks;
    EXPECT_NEAR(ShareAbove(decades, 2.0), 1e-2, 4.2e-4) << looks;
    EXPECT_NEAR(ShareAbove(decades, 3.0), 1e-3, 1.4e-4) << looks;
  }
}

TEST(LikelihoodRatioTest, CellsOfSeveralPixelsSeeAWeakerObjectAtTheSameRate) {
  const BackgroundLaw law = SlopedLaw(400, 128, 1.0);
  BackgroundLaw stronger = law;
  for (int row = 100; row < 200; ++row) {
    for (int col = 40; col < 80; ++col) stronger.mean_power(row, col) *= 3.0F;
  }
  const Grid<float> quiet = Draw(law, 8, 4095.0);
  const Grid<float> with_object = Draw(stronger, 9, 4095.0);
  const auto share_of_object = [&](int rows, int cols) {
    const Grid<float> decades = LikelihoodDecades(with_object, 4095.0, law, rows, cols);
    int above = 0;
    for (int row = 105; row < 195; ++row) {
      for (int col = 45; col < 75; ++col) above += decades(row, col) > 3.0F;
    }
    return above / (90.0 * 30.0);
  };
  EXPECT_NEAR(share_of_object(1, 1), std::pow(10.0, -1.0), 0.02);  // 10^-3 of a third of the ratio
  EXPECT_GT(share_of_object(7, 5), 0.99);
  EXPECT_NEAR(ShareAbove(LikelihoodDecades(quiet, 4095.0, law, 7, 5), 2.0), 1e-2, 5e-3);
}

// Word for word: each pixel's power over its background, averaged over the cell, as a tail of the Gamma law.
TEST(LikelihoodRatioTest, AgreesWithItsDefinitionPixelByPixel) {
  const BackgroundLaw law = SlopedLaw(9, 7, 2.0);
  Grid<float> grey = Draw(law, 5, 255.0);
  grey(4, 3) = 200.0F;
  Mask valid(9, 7, 1);
  valid(0, 0) = valid(5, 5) = 0;
  const Grid<float> decades = LikelihoodDecades(grey, 255.0, law, 3, 5, &valid);
  for (int row = 0; row < 9; ++row) {
    for (int col = 0; col < 7; ++col) {
      double sum = 0.0, count = 0.0;
      for (int r = std::max(0, row - 1); r <= std::min(8, row + 1); ++r) {
        for (int c = std::max(0, col - 2); c <= std::min(6, col + 2); ++c) {
          if (valid(r, c) == 0) continue;
          sum += std::pow(10.0, kSpanDb / 10.0 * grey(r, c) / 255.0) / law.mean_power(r, c);
          ++count;
        }
      }
      const double exact = GammaTailDecades(2.0 * 15.0, sum / count);
      EXPECT_NEAR(decades(row, col), exact, 2e-3 * (1.0 + exact)) << row << ", " << col;
    }
  }
}

TEST(LikelihoodRatioTest, SegmentsByItsLawAndNeedsOne) {
  BackgroundLaw law = SlopedLaw(120, 40, 1.0);
  BackgroundLaw with_block = law;
  for (int row = 30; row < 60; ++row) {
    for (int col = 10; col < 25; ++col) with_block.mean_power(row, col) *= 100.0F;
  }
  PolarImage image{testing::SmallAxes(120, 40), {}, Draw(with_block, 3, 255.0)};
  SegmentationOptions options;
  options.method = SegmentationMethod::kLikelihoodRatio;
  EXPECT_THROW(Segment(image, options), DataError);
  options.background_law = std::make_shared<BackgroundLaw>(law);
  options.close_rows = options.close_cols = 3;
  const Mask object = Segment(image, options).object;
  int hits = 0;
  for (int row = 30; row < 60; ++row) {
    for (int col = 10; col < 25; ++col) hits += object(row, col);
  }
  EXPECT_GT(hits, 440);
  EXPECT_LT(CountSet(object) - hits, 10);
}

TEST(LikelihoodRatioTest, ALawThatDoesNotFitIsRefused) {
  const Grid<float> grey(4, 3, 10.0F);
  BackgroundLaw law = SlopedLaw(4, 2, 1.0);
  const auto message = [&] {
    try {
      LikelihoodDecades(grey, 255.0, law, 1, 1);
    } catch (const DataError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message(), "the background's law is one of 4 x 2 pixels, expected 4 range bins x 3 beams");
  law = SlopedLaw(4, 3, 1.0);
  EXPECT_EQ(message(), "no error");
  law.mean_power(1, 2) = 0.0F;
  EXPECT_THAT(message(), HasSubstr("power 0 at (row 1, column 2)"));
  law.mean_power(1, 2) = std::numeric_limits<float>::infinity();
  EXPECT_THAT(message(), HasSubstr("power inf at (row 1, column 2)"));
  law = SlopedLaw(4, 3, 1.0);
  law.mean_power(0, 0) = -1.0F;
  EXPECT_THAT(message(), HasSubstr("power -1 at (row 0, column 0)"));
  law = SlopedLaw(4, 3, 0.0);
  EXPECT_THAT(message(), HasSubstr("0 looks"));
  for (const double looks : {kMinLooks, kMaxLooks}) {
    law.looks = looks;
    EXPECT_EQ(message(), "no error") << looks;
  }
  law.looks = std::nextafter(kMaxLooks, 2000.0);
  EXPECT_THAT(message(), HasSubstr("looks, expected 0.05 to 1000"));
  law = SlopedLaw(3, 3, 1.0);
  EXPECT_THAT(message(), HasSubstr("3 x 3 pixels"));
}

TEST(PowerOfGreyTest, ClippedLevelsCountAsHalfTheEdge) {
  const Grid<float> power = PowerOfGrey(testing::GridOf({{0.0f, 1.0f, 127.5f, 255.0f}}), 255.0,
                                        LogDisplayPower(10.0 * 255.0 / 255.0));
  EXPECT_FLOAT_EQ(power(0, 0), 0.5f * std::pow(10.0f, 0.5f / 255.0f));
  EXPECT_FLOAT_EQ(power(0, 1), std::pow(10.0f, 1.0f / 255.0f));
  EXPECT_FLOAT_EQ(power(0, 2), std::sqrt(10.0f));
  EXPECT_FLOAT_EQ(power(0, 3), 10.0f);
}

// Filters may leave values below 0 or above full scale, and between whole levels.
TEST(PowerOfGreyTest, ValuesBeyondTheScaleCountAsItsEnds) {
  const auto power_of_value = LogDisplayPower(40.0);
  const Grid<float> power =
      PowerOfGrey(testing::GridOf({{-3.0f, 100.0f, 101.0f, 130.0f, 0.25f, 0.5f}}), 100.0, power_of_value);
  EXPECT_FLOAT_EQ(power(0, 0), static_cast<float>(0.5 * std::pow(10.0, 4.0 * 0.005)));
  EXPECT_FLOAT_EQ(power(0, 1), 1e4f);
  EXPECT_FLOAT_EQ(power(0, 2), 1e4f);
  EXPECT_FLOAT_EQ(power(0, 3), 1e4f);
  EXPECT_FLOAT_EQ(power(0, 4), power(0, 0));
  EXPECT_FLOAT_EQ(power(0, 5), 2.0f * power(0, 0)) << "half a level is not clipped";
  // Too many levels for a table.
  const Grid<float> fine = PowerOfGrey(testing::GridOf({{0.0f, 50000.0f, 2e6f}}), 1e6, power_of_value);
  EXPECT_FLOAT_EQ(fine(0, 0), static_cast<float>(0.5 * std::pow(10.0, 4.0 * 0.5e-6)));
  EXPECT_FLOAT_EQ(fine(0, 1), std::pow(10.0f, 0.2f));
  EXPECT_FLOAT_EQ(fine(0, 2), 1e4f);
}

// A display that shows no power below 3: no level stands for less than the clipped ones.
TEST(PowerOfGreyTest, PowerDoesNotFallBelowTheClippedLevels) {
  const Grid<float> power = PowerOfGrey(testing::GridOf({{0.0f, 1.0f, 2.0f}}), 2.0,
                                        [](double value) { return value == 0.25 ? 8.0 : 3.0 * value; });
  EXPECT_FLOAT_EQ(power(0, 0), 4.0f);
  EXPECT_FLOAT_EQ(power(0, 1), 4.0f);
  EXPECT_FLOAT_EQ(power(0, 2), 4.0f);
}

}  // namespace
}  // namespace sonarcal::metrics
