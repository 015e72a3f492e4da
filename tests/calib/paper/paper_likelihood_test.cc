// The expected recorded value of a pixel against draws of pixels made of a few rays each, rounded and
// clipped.
#include "calib/paper/paper_likelihood.h"

#include <gtest/gtest.h>

#include <random>

namespace sonarcal::calib {
namespace {

constexpr double kFullScale = 255.0;
constexpr double kLevel = 1.0 / kFullScale;

PaperNoise NoiseOfRays(double levels_per_ray) {
  return {.sigma = 1.0,
          .knee_sigma = std::max(0.3, std::sqrt(levels_per_ray * kFullScale)) * kLevel,
          .variance_levels = levels_per_ray};
}

// Mean recorded value, in levels, of a pixel that gets a random number of rays.
double MeanOfDraws(double levels, double levels_per_ray) {
  constexpr int kSpeckleDraws = 40'000;
  std::mt19937 engine(7);
  std::poisson_distribution<int> count(levels / levels_per_ray);
  std::uniform_real_distribution<double> strength(0.8, 1.2);
  double sum = 0.0;
  for (int draw = 0; draw < kSpeckleDraws; ++draw) {
    double value = 0.0;
    const int rays = count(engine);
    if (rays > 50) value = levels_per_ray * rays;  // their differences cancel
    for (int ray = rays; ray > 0 && rays <= 50; --ray) value += levels_per_ray * strength(engine);
    sum += std::min(std::round(value), kFullScale);
  }
  return sum / kSpeckleDraws;
}

TEST(PaperLikelihood, TheExpectedValueIsThatOfRoundedAndClippedDraws) {
  for (const double per_ray : {0.1, 0.67, 2.0, 7.2}) {
    for (const double levels : {0.1, 0.3, 0.5, 0.8, 1.0, 2.0, 3.0, 10.0, 100.0, 240.0, 260.0}) {
      const double expected =
          kFullScale * PaperLikelihood(NoiseOfRays(per_ray)).ExpectedRecorded(levels * kLevel, kLevel).value;
      EXPECT_NEAR(expected, MeanOfDraws(levels, per_ray), std::max(0.1, 2e-3 * levels))
          << levels << " levels of rays of " << per_ray;
    }
  }
}

TEST(PaperLikelihood, WithoutNoiseAFaintPixelIsRecordedAsZero) {
  const PaperLikelihood none({.sigma = 1.0, .knee_sigma = 0.3 * kLevel, .variance_levels = 0.0});
  EXPECT_LT(none.ExpectedRecorded(0.3 * kLevel, kLevel).value, 0.06 * kLevel);
  EXPECT_NEAR(none.ExpectedRecorded(0.3 * kLevel, 0.0).value, 0.3 * kLevel, 1e-9) << "not rounded";
  EXPECT_NEAR(none.ExpectedRecorded(3.0, kLevel).value, 1.0, 1e-9) << "clipped";
  EXPECT_EQ(none.ExpectedRecorded(-0.2, kLevel).value, 0.0);
}

TEST(PaperLikelihood, InterpolatesTheExpectedLevels) {
  for (const double variance_levels : {0.0, 0.05, 0.7, 1.0, 1.3, 5.0}) {
    const PaperLikelihood likelihood({.sigma = 1.0, .knee_sigma = 1e-3, .variance_levels = variance_levels});
    for (double levels = 1e-3; levels < 5.0; levels += 0.0137) {
      const ValueAndSlope exact = RoundedLevels(levels, variance_levels);
      const ValueAndSlope expected = likelihood.ExpectedRecorded(levels * kLevel, kLevel);
      EXPECT_NEAR(expected.value / kLevel, exact.value, 1e-7) << levels << ", variance " << variance_levels;
      EXPECT_NEAR(expected.slope, exact.slope, 1e-4) << levels << ", variance " << variance_levels;
    }
  }
}

TEST(PaperLikelihood, SlopesAreThoseOfTheResidual) {
  for (const double per_ray : {0.05, 0.67, 1.0, 7.2}) {
    for (const double levels : {-20.0, 0.2, 0.6, 1.3, 3.0, 50.0, 235.0, 255.0, 290.0}) {
      for (const double recorded : {0.0, 0.4, 1.0}) {
        const PaperLikelihood likelihood(NoiseOfRays(per_ray));
        const auto at = [&](double mean) { return likelihood.Residual(mean, recorded, kLevel); };
        const double step = 1e-5 * kLevel;
        const double mean = levels * kLevel;
        const double difference = (at(mean + step).residual - at(mean - step).residual) / (2.0 * step);
        EXPECT_NEAR(at(mean).slope, difference, 1e-4) << levels << " levels of rays of " << per_ray;
      }
    }
  }
}

TEST(PaperLikelihood, ALitPixelShadedBelowBlackHasAWayBack) {
  const PaperResidual pixel = PaperLikelihood(NoiseOfRays(1.0)).Residual(-2.0, 0.5, kLevel);
  EXPECT_LT(pixel.residual, 0.0);
  EXPECT_GT(pixel.slope, 0.0);
}

}  // namespace
}  // namespace sonarcal::calib
