#include "metrics/speckle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

constexpr int kBins = 640;
constexpr int kBeams = 128;

// Independent Gamma power of a number of looks, over 80 dB, a level of 50 dB that rises with range by 10 dB.
Grid<float> GammaImage(double looks, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::gamma_distribution<double> power(looks, 1.0 / looks);
  Grid<float> image(kBins, kBeams);
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double level_db = 50.0 + 10.0 * (bin / 16) / (kBins / 16.0) + 10.0 * std::log10(power(random));
      image(bin, beam) = static_cast<float>(255.0 / 80.0 * level_db);
    }
  }
  return image;
}

ImageScale EightyDb() {
  ImageScale scale;
  scale.db_span = 80.0;
  return scale;
}

TEST(SpeckleTest, LooksOfGammaPowerAreFoundWhateverTheLevel) {
  for (const double looks : {1.0, 1.4, 4.0}) {
    const SpeckleSums sums = MeasureSpeckleIn(GammaImage(looks, 5), EightyDb(), Mask(kBins, kBeams, 1));
    EXPECT_EQ(sums.blocks, kBins / 16 * kBeams / 8);
    // 640 blocks of 128: a block's estimate scatters by sqrt(8 / 128) of itself at one look, less at more.
    EXPECT_NEAR(sums.looks().value(), looks, 4.0 * looks * std::sqrt(8.0 / 128.0 / 640.0));
    EXPECT_DOUBLE_EQ(sums.scintillation_index().value(), 1.0 / sums.looks().value());
    EXPECT_NEAR(sums.range_width_bins().value(), 1.0, 0.02);
    EXPECT_NEAR(sums.azimuth_width_beams().value(), 1.0, 0.02);
  }
}

// Field of white noise through a box of `bins` samples: its power's autocorrelation is that of the field,
// (1 - lag / bins), squared (Siegert), so that half is reached at lag = bins (1 - 1 / sqrt 2).
TEST(SpeckleTest, TheWidthOfGrainIsThatOfItsAutocorrelation) {
  constexpr int kBox = 4;
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  Grid<float> image(kBins, kBeams);
  for (int beam = 0; beam < kBeams; ++beam) {
    std::vector<double> re, im;
    for (int i = 0; i < kBins + kBox; ++i) {
      re.push_back(normal(random));
      im.push_back(normal(random));
    }
    for (int bin = 0; bin < kBins; ++bin) {
      double sum_re = 0.0, sum_im = 0.0;
      for (int k = 0; k < kBox; ++k) {
        sum_re += re[bin + k];
        sum_im += im[bin + k];
      }
      image(bin, beam) =
          static_cast<float>(255.0 / 80.0 * (40.0 + 10.0 * std::log10(sum_re * sum_re + sum_im * sum_im)));
    }
  }
  const SpeckleSums sums = MeasureSpeckleIn(image, EightyDb(), Mask(kBins, kBeams, 1));
  // (1 - lag / 4)^2 at lag 1 is 9/16, at lag 2 it is 1/4; between them linear.
  const double width = 2.0 * (1.0 + (9.0 / 16.0 - 0.5) / (9.0 / 16.0 - 0.25));
  EXPECT_NEAR(sums.range_width_bins().value(), width, 0.1);
  EXPECT_NEAR(sums.azimuth_width_beams().value(), 1.0, 0.02);
  EXPECT_NEAR(sums.scintillation_index().value(), 1.0, 0.05) << "low by the grain's area over the block's";
}

TEST(SpeckleTest, WithoutDecibelsGreyValuesStandForPower) {
  Grid<float> image(16, 8);
  for (std::size_t i = 0; i < image.size(); ++i) image.values()[i] = i % 2 == 0 ? 100.0f : 50.0f;
  const SpeckleSums sums = MeasureSpeckleIn(image, ImageScale{}, Mask(16, 8, 1));
  // s^2 / m^2 = (25 / 75)^2 128 / 127, and S = x / (1 - x / 128).
  const double x = 1.0 / 9.0 * 128.0 / 127.0;
  EXPECT_NEAR(sums.scintillation_index().value(), x / (1.0 - x / 128.0), 1e-12);
}

TEST(SpeckleTest, OnlyWholeBlocksOfTheRegionCountAndNoClippedOnes) {
  Grid<float> image = GammaImage(1.0, 5);
  Mask region(kBins, kBeams, 1);
  const std::int64_t all = MeasureSpeckleIn(image, EightyDb(), region).blocks;
  region(3, 3) = 0;
  EXPECT_EQ(MeasureSpeckleIn(image, EightyDb(), region).blocks, all - 1);
  image(20, 3) = image(21, 3) = 0.0f;
  EXPECT_EQ(MeasureSpeckleIn(image, EightyDb(), region).blocks, all - 1) << "two of 128 are clipped";
  image(22, 3) = 255.0f;
  EXPECT_EQ(MeasureSpeckleIn(image, EightyDb(), region).blocks, all - 2);
}

TEST(SpeckleTest, AnEvenImageDoesNotScatterAndAnEmptyRegionHasNoValue) {
  const Grid<float> even(kBins, kBeams, 100.0f);
  const SpeckleSums sums = MeasureSpeckleIn(even, EightyDb(), Mask(kBins, kBeams, 1));
  EXPECT_EQ(sums.scintillation_index(), 0.0);
  EXPECT_FALSE(sums.looks());
  EXPECT_FALSE(sums.range_width_bins());
  EXPECT_FALSE(MeasureSpeckleIn(even, EightyDb(), Mask(kBins, kBeams)).scintillation_index());
  EXPECT_FALSE(SpeckleSums{}.looks());
  EXPECT_FALSE(SpeckleSums{}.range_width_bins());
}

TEST(SpeckleTest, ObjectAndBackgroundAreMeasuredApart) {
  const Grid<float> one = GammaImage(1.0, 7), four = GammaImage(4.0, 8);
  Mask real(kBins, kBeams), simulated(kBins, kBeams);
  for (int bin = 0; bin < kBins / 2; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) real(bin, beam) = simulated(bin, beam) = 1;
  }
  for (int beam = 0; beam < kBeams; ++beam) simulated(kBins / 2, beam) = 1;  // of neither
  const SpeckleMeasures speckle = MeasureSpeckle(one, four, EightyDb(), real, simulated);
  EXPECT_NEAR(speckle.real_object.looks().value(), 1.0, 0.08);
  EXPECT_NEAR(speckle.simulated_background.looks().value(), 4.0, 0.2);
  EXPECT_EQ(speckle.real_background.blocks, (kBins / 32 - 1) * kBeams / 8);
  EXPECT_GT(speckle.real_object.blocks, 3 * kBins / 32 * kBeams / 8) << "blocks lie half over each other";
}

}  // namespace
}  // namespace sonarcal::metrics
