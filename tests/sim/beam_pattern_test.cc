#include "sim/physics/beam_pattern.h"

#include <gtest/gtest.h>

namespace sonarcal {
namespace {

TEST(GaussianResponse, HalfPowerAtHalfWidth) {
  EXPECT_DOUBLE_EQ(GaussianResponse(0.0, 1.7), 1.0);
  EXPECT_NEAR(GaussianResponse(0.85, 1.7), 0.5, 1e-15);
  EXPECT_NEAR(GaussianResponse(-0.85, 1.7), 0.5, 1e-15);
  EXPECT_NEAR(GaussianResponse(1.7, 1.7), 1.0 / 16.0, 1e-15);
}

// The trapezoid rule over a Gaussian is exact to rounding at this step.
TEST(GaussianResponse, EquivalentWidthIsTheIntegral) {
  const double width = 1.7;
  const double step = width / 50.0;
  double integral = 0.0;
  for (int i = -500; i <= 500; ++i) integral += GaussianResponse(i * step, width) * step;
  EXPECT_NEAR(GaussianEquivalentWidth(width), integral, 1e-12);
  EXPECT_NEAR(GaussianEquivalentWidth(1.0), 1.0645, 5e-5);
}

}  // namespace
}  // namespace sonarcal
