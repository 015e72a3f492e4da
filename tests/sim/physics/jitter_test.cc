#include "sim/physics/jitter.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace sonarcal::sim {
namespace {

JitterParameters<double> Example(JitterGrowth growth) {
  return {.sigma_range_m = 0.02,
          .sigma_azimuth_deg = 0.3,
          .reference_range_m = 5.0,
          .reference_frequency_hz = 900e3,
          .growth = growth};
}

TEST(Jitter, GrowsWithRangeByEitherLaw) {
  const auto root = Example(JitterGrowth::kRoot);
  const auto linear = Example(JitterGrowth::kLinear);
  EXPECT_DOUBLE_EQ(JitterSigmaRangeM(root, 0.0, 900e3), 0.02);
  EXPECT_DOUBLE_EQ(JitterSigmaRangeM(linear, 0.0, 900e3), 0.02);
  // R^2/R0^2 = 3: the root doubles, the line quadruples.
  const double range_m = 5.0 * std::sqrt(3.0);
  EXPECT_NEAR(JitterSigmaRangeM(root, range_m, 900e3), 0.04, 1e-15);
  EXPECT_NEAR(JitterSigmaRangeM(linear, range_m, 900e3), 0.08, 1e-15);
  EXPECT_NEAR(JitterSigmaAzimuthRad(root, range_m, 900e3), 0.6 * kPi / 180.0, 1e-15);
  EXPECT_NEAR(JitterSigmaAzimuthRad(linear, range_m, 900e3), 1.2 * kPi / 180.0, 1e-15);
}

TEST(Jitter, FallsWithTheRootOfFrequency) {
  for (const auto growth : {JitterGrowth::kRoot, JitterGrowth::kLinear}) {
    const auto jitter = Example(growth);
    EXPECT_NEAR(JitterSigmaRangeM(jitter, 3.0, 3.6e6) / JitterSigmaRangeM(jitter, 3.0, 900e3), 0.5, 1e-12);
    EXPECT_NEAR(JitterSigmaAzimuthRad(jitter, 3.0, 225e3) / JitterSigmaAzimuthRad(jitter, 3.0, 900e3), 2.0,
                1e-12);
  }
}

TEST(BlurWeight, WeightsOfAllBinsAddUpToOne) {
  for (const double sigma : {1e-9, 0.01, 0.3, 1.0, 20.0}) {
    double sum = 0.0;
    const double step = std::max(0.25, sigma / 4.0);
    for (int i = -800; i < 800; ++i)
      sum += GaussianBlurWeight(2.0, 3.5, i * step, (i + 1) * step, sigma).value;
    EXPECT_NEAR(sum, 1.0, 1e-12) << "sigma " << sigma;
  }
}

TEST(BlurWeight, ZeroErrorGivesNoBlur) {
  EXPECT_NEAR(GaussianBlurWeight(1.0, 3.0, 1.0, 3.0, 1e-9).value, 1.0, 1e-8);
  EXPECT_NEAR(GaussianBlurWeight(1.0, 3.0, 3.0, 4.0, 1e-9).value, 0.0, 1e-8);
  EXPECT_NEAR(GaussianBlurWeight(1.0, 3.0, 0.0, 1.5, 1e-9).value, 0.25, 1e-8);  // the share that overlaps
  EXPECT_NEAR(GaussianBlurWeight(1.0, 3.0, 0.0, 9.0, 1e-9).value, 1.0, 1e-8);
}

double NormalCdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

// The midpoint rule over n steps errs by at most (width / n)^2 / 24 max |f''|; f is a difference of two
// normal distributions, |f''| <= 2 x 0.242 / sigma^2.
TEST(BlurWeight, WeightEqualsNumericalIntegration) {
  constexpr int kSteps = 4000;
  const struct {
    double from_low, from_high, to_low, to_high, sigma;
  } cases[] = {{0, 1, 0, 1, 0.5},   {0, 1, 1, 2, 0.5},      {0, 1, -3, -1, 0.7},
               {2, 2.5, 1, 4, 1.5}, {-1, 1, 0.2, 0.4, 0.1}, {0, 1, 4, 5, 1.0}};
  for (const auto& c : cases) {
    double mean = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = c.from_low + (i + 0.5) * (c.from_high - c.from_low) / kSteps;
      mean += (NormalCdf((c.to_high - x) / c.sigma) - NormalCdf((c.to_low - x) / c.sigma)) / kSteps;
    }
    const double step = (c.from_high - c.from_low) / kSteps;
    const double tolerance = step * step / 24.0 * 0.484 / (c.sigma * c.sigma) + 1e-13;
    EXPECT_NEAR(GaussianBlurWeight(c.from_low, c.from_high, c.to_low, c.to_high, c.sigma).value, mean,
                tolerance);
  }
}

TEST(BlurWeight, WeightEqualsTheShareOfRandomDraws) {
  std::mt19937_64 random(20241207);
  std::uniform_real_distribution<double> uniform(0.4, 0.9);
  std::normal_distribution<double> normal(0.0, 0.6);
  constexpr int kDraws = 1'000'000;
  std::vector<int> landed(8, 0);  // unit intervals from -3
  for (int i = 0; i < kDraws; ++i) {
    const int bin = static_cast<int>(std::floor(uniform(random) + normal(random))) + 3;
    if (bin >= 0 && bin < 8) ++landed[bin];
  }
  for (int bin = 0; bin < 8; ++bin) {
    const double p = GaussianBlurWeight(0.4, 0.9, bin - 3.0, bin - 2.0, 0.6).value;
    const double standard_error = std::sqrt(p * (1.0 - p) / kDraws);
    EXPECT_NEAR(static_cast<double>(landed[bin]) / kDraws, p, 4.5 * standard_error + 1e-9) << "bin " << bin;
  }
}

// h^2 f'''/6 with h = 1e-4; f''' is of the order of sigma^-3 at most 10.
TEST(BlurWeight, SlopeEqualsCentralDifference) {
  const double h = 1e-4;
  for (const double sigma : {0.2, 0.7, 3.0}) {
    for (const double to : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
      const double difference = (GaussianBlurWeight(0.0, 1.0, to, to + 1.0, sigma + h).value -
                                 GaussianBlurWeight(0.0, 1.0, to, to + 1.0, sigma - h).value) /
                                (2.0 * h);
      EXPECT_NEAR(GaussianBlurWeight(0.0, 1.0, to, to + 1.0, sigma).slope, difference,
                  2e-8 * (1.0 + std::pow(sigma, -3.0)));
    }
  }
}

TEST(BlurWeight, SlopeOfAWiderIntervalEqualsCentralDifference) {
  const double h = 1e-4;
  const double difference = (GaussianBlurWeight(1.0, 3.5, 2.0, 4.0, 0.7 + h).value -
                             GaussianBlurWeight(1.0, 3.5, 2.0, 4.0, 0.7 - h).value) /
                            (2.0 * h);
  EXPECT_NEAR(GaussianBlurWeight(1.0, 3.5, 2.0, 4.0, 0.7).slope, difference, 1e-7);
}

TEST(BlurWeight, CarriesItsSlopeToASolver) {
  using Jet = ceres::Jet<double, 1>;
  const BlurWeight weight = GaussianBlurWeight(0.0, 1.0, 1.0, 2.0, 0.5);
  const Jet at = weight.At(Jet(0.5, 0), 0.5);
  EXPECT_DOUBLE_EQ(at.a, weight.value);
  EXPECT_DOUBLE_EQ(at.v[0], weight.slope);
  // A little beside its own sigma: right to first order.
  const double beside = GaussianBlurWeight(0.0, 1.0, 1.0, 2.0, 0.505).value;
  EXPECT_NEAR(weight.At(0.505, 0.5), beside, 5e-5);
  EXPECT_GT(std::abs(weight.value - beside), 5e-4);
}

}  // namespace
}  // namespace sonarcal::sim
