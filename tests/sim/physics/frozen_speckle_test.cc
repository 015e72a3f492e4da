#include "sim/physics/frozen_speckle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sonarcal::sim {
namespace {

// Density of z / N by the Bessel form of the noncentral chi-square distribution:
// L (x / q)^((L - 1) / 2) exp(-L (q + x)) I_{L-1}(2 L sqrt(q x)).
double Density(double looks, double q, double x) {
  return looks * std::pow(x / q, 0.5 * (looks - 1.0)) * std::exp(-looks * (q + x)) *
         std::cyl_bessel_i(looks - 1.0, 2.0 * looks * std::sqrt(q * x));
}

// Integral of the density by Simpson's rule. x = t^2 leaves no root at 0.
double SlowCdf(double looks, double q, double ratio) {
  constexpr int kSteps = 2000;
  const double end = std::sqrt(ratio);
  double sum = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double t = end * i / kSteps;
    sum += (i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * 2.0 * t * Density(looks, q, t * t);
  }
  return sum * end / kSteps / 3.0;
}

TEST(FrozenSpeckleTest, IsTheIntegralOfTheNoncentralDensity) {
  for (const double looks : {1.0, 1.5, 3.0}) {
    for (const double q : {0.2, 1.0, 4.0, 20.0}) {
      for (const double ratio : {0.3, 1.0, 3.0, 6.0, 25.0}) {
        EXPECT_NEAR(FrozenPowerCdf(looks, q, ratio), SlowCdf(looks, q, ratio), 1e-10)
            << looks << ", " << q << ", " << ratio;
      }
    }
  }
}

TEST(FrozenSpeckleTest, NoiseAloneIsAnExponentialLaw) {
  for (const double ratio : {0.01, 1.0, 5.0}) {
    EXPECT_NEAR(FrozenPowerCdf(1.0, 0.0, ratio), 1.0 - std::exp(-ratio), 1e-12);
    EXPECT_NEAR(FrozenPowerCdf(2.0, 0.0, ratio), 1.0 - (1.0 + 2.0 * ratio) * std::exp(-2.0 * ratio), 1e-12);
  }
}

TEST(FrozenSpeckleTest, EndsAreZeroAndOne) {
  EXPECT_EQ(FrozenPowerCdf(1.0, 2.0, 0.0), 0.0);
  EXPECT_EQ(FrozenPowerCdf(1.0, 2.0, -1.0), 0.0);
  EXPECT_EQ(FrozenPowerCdf(1.0, 400.0, 4.0), 0.0);
  EXPECT_EQ(FrozenPowerCdf(1.0, 4.0, 400.0), 1.0);
  EXPECT_NEAR(FrozenPowerCdf(1.0, 4.0, 80.0), 1.0, 1e-12);
}

// Mean q + N and variance (N^2 + 2 N q) / L, by integrals of the survival.
TEST(FrozenSpeckleTest, HasItsMeanAndVariance) {
  for (const double looks : {1.0, 2.5}) {
    for (const double q : {0.5, 3.0}) {
      double mean = 0.0;
      double square = 0.0;
      constexpr double kStep = 5e-3;
      for (double x = 0.5 * kStep; x < 60.0; x += kStep) {
        const double above = 1.0 - FrozenPowerCdf(looks, q, x);
        mean += kStep * above;
        square += kStep * 2.0 * x * above;
      }
      EXPECT_NEAR(mean, q + 1.0, 1e-4);
      EXPECT_NEAR(square - mean * mean, (1.0 + 2.0 * q) / looks, 1e-3);
    }
  }
}

}  // namespace
}  // namespace sonarcal::sim
