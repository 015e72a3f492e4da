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
    const int step = bin / 16;
    for (int beam = 0; beam < kBeams; ++beam) {
      const double level_db = 50.0 + 10.0 * step / (kBins / 16.0) + 10.0 * std::log10(power(random));
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

// Sums by their definition: for each block the mean product of the deviations at a lag, over the pairs of
// pixels that far apart, plus the variance of the block's mean.
SpeckleSums SumsByDefinition(const Grid<float>& image, double span_db, const Mask& region, int step) {
  SpeckleSums sums;
  for (int first_bin = 0; first_bin <= image.rows() - 16; first_bin += 16 / step) {
    for (int first_beam = 0; first_beam <= image.cols() - 8; first_beam += 8 / step) {
      std::vector<double> power;
      bool is_inside = true;
      for (int i = 0; i < 128; ++i) {
        const int bin = first_bin + i / 8, beam = first_beam + i % 8;
        is_inside = is_inside && region(bin, beam) != 0;
        power.push_back(std::pow(10.0, span_db / 10.0 * image(bin, beam) / 255.0));
      }
      if (!is_inside) continue;
      double mean = 0.0;
      for (const double p : power) mean += p / 128.0;
      double variance = 0.0;
      for (const double p : power) variance += std::pow(p / mean - 1.0, 2) / 127.0;
      const auto covariance = [&](int bins, int beams) {
        double sum = 0.0, pairs = 0.0;
        for (int i = 0; i < 128; ++i) {
          if (i / 8 + bins >= 16 || i % 8 + beams >= 8) continue;
          sum += (power[i] / mean - 1.0) * (power[i + 8 * bins + beams] / mean - 1.0);
          ++pairs;
        }
        return sum / pairs + variance / 128.0;
      };
      ++sums.blocks;
      sums.relative_variance += variance;
      for (int lag = 1; lag <= 8; ++lag) sums.along_range[lag - 1] += covariance(lag, 0);
      for (int lag = 1; lag <= 4; ++lag) sums.along_azimuth[lag - 1] += covariance(0, lag);
    }
  }
  return sums;
}

TEST(SpeckleTest, SumsAreThoseOfTheirDefinition) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<float> grey(60.0F, 250.0F);
  Grid<float> image(40, 21);  // the last 8 bins and 5 beams fill no block
  for (float& value : image.values()) value = grey(random);
  // Neighbours resemble each other, along range more than along azimuth.
  for (int bin = 1; bin < 40; ++bin) {
    for (int beam = 1; beam < 21; ++beam) {
      image(bin, beam) =
          0.25F * image(bin, beam) + 0.5F * image(bin - 1, beam) + 0.25F * image(bin, beam - 1);
    }
  }
  Mask region(40, 21, 1);
  region(31, 4) = 0;
  for (const int step : {1, 2}) {
    const SpeckleSums sums = MeasureSpeckleIn(image, EightyDb(), region, step);
    const SpeckleSums expected = SumsByDefinition(image, 80.0, region, step);
    EXPECT_EQ(sums.blocks, step == 1 ? 3 : 12);
    EXPECT_EQ(sums.blocks, expected.blocks);
    EXPECT_NEAR(sums.relative_variance, expected.relative_variance, 1e-10);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(sums.along_range[i], expected.along_range[i], 1e-10) << i;
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(sums.along_azimuth[i], expected.along_azimuth[i], 1e-10) << i;
  }
}

TEST(SpeckleTest, AWidthIsReadBetweenTheLagsAroundOneHalf) {
  SpeckleSums sums{.blocks = 2, .relative_variance = 2.0};
  sums.along_range = {1.8, 1.6, 1.4, 1.2, 0.8, 0.0, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(sums.range_width_bins().value(), 2.0 * 4.5);
  sums.along_azimuth = {0.4, 2.0, 2.0, 2.0};  // the first crossing counts
  EXPECT_DOUBLE_EQ(sums.azimuth_width_beams().value(), 2.0 * 0.5 / 0.8);
  sums.along_azimuth = {1.9, 1.8, 1.7, 1.01};
  EXPECT_FALSE(sums.azimuth_width_beams()) << "wider than half a block";
  sums.along_azimuth[3] = 1.0;
  EXPECT_DOUBLE_EQ(sums.azimuth_width_beams().value(), 8.0);
}

TEST(SpeckleTest, SumsOfFramesAddUp) {
  SpeckleMeasures a, b;
  a.real_background = {.blocks = 1, .relative_variance = 0.5, .along_range = {0.1}, .along_azimuth = {0.2}};
  b.real_background = {.blocks = 2, .relative_variance = 0.25};
  b.real_background.along_range.fill(0.5);
  b.real_background.along_azimuth.fill(0.75);
  b.simulated_background.blocks = 3;
  b.real_object.blocks = 4;
  b.simulated_object.blocks = 5;
  a += b;
  EXPECT_EQ(a.real_background.blocks, 3);
  EXPECT_EQ(a.real_background.relative_variance, 0.75);
  EXPECT_EQ(a.real_background.along_range[0], 0.6);
  EXPECT_EQ(a.real_background.along_range[7], 0.5);
  EXPECT_EQ(a.real_background.along_azimuth[0], 0.95);
  EXPECT_EQ(a.real_background.along_azimuth[3], 0.75);
  EXPECT_EQ(a.simulated_background.blocks, 3);
  EXPECT_EQ(a.real_object.blocks, 4);
  EXPECT_EQ(a.simulated_object.blocks, 5);
}

TEST(SpeckleTest, AnObjectIsWhereBothRegionsAre) {
  const Grid<float> one = GammaImage(1.0, 7);
  Mask left(kBins, kBeams);
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams / 2; ++beam) left(bin, beam) = 1;
  }
  const Mask all(kBins, kBeams, 1);
  for (const SpeckleMeasures& speckle :
       {MeasureSpeckle(one, one, EightyDb(), left, all), MeasureSpeckle(one, one, EightyDb(), all, left)}) {
    EXPECT_EQ(speckle.real_object.blocks, (kBins / 8 - 1) * (kBeams / 8 - 1));
    EXPECT_EQ(speckle.real_background.blocks, 0);
  }
}

TEST(SpeckleTest, PixelsWithoutMeasurementAreNeitherObjectNorBackground) {
  const Grid<float> one = GammaImage(1.0, 7);
  Mask valid(kBins, kBeams, 1), object(kBins, kBeams);
  valid(5, 5) = valid(kBins - 1, kBeams - 1) = 0;
  for (int beam = 0; beam < kBeams; ++beam) {
    for (int bin = 0; bin < kBins / 2; ++bin) object(bin, beam) = 1;
  }
  const SpeckleMeasures all = MeasureSpeckle(one, one, EightyDb(), object, object);
  const SpeckleMeasures some = MeasureSpeckle(one, one, EightyDb(), object, object, &valid);
  EXPECT_EQ(some.real_background.blocks, all.real_background.blocks - 1);
  EXPECT_EQ(some.simulated_object.blocks, all.simulated_object.blocks - 2) << "those that overlap there";
  EXPECT_EQ(some.real_object.blocks, all.real_object.blocks - 2);
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
