#include "sim/physics/receiver.h"

#include <gtest/gtest.h>

namespace sonarcal {
namespace {

constexpr double kEulerGamma = 0.57721566490153286;

// psi(n) = -gamma + 1 + 1/2 + ... + 1/(n - 1); psi(1/2) = -gamma - 2 ln 2, psi(x + 1) = psi(x) + 1/x.
TEST(Speckle, MeanOfTheLogarithm) {
  const double db = 10.0 / std::log(10.0);
  EXPECT_NEAR(MeanLogSpeckleDb(1.0), -2.507, 5e-4);
  EXPECT_NEAR(MeanLogSpeckleDb(1.0), -db * kEulerGamma, 1e-12);
  EXPECT_NEAR(MeanLogSpeckleDb(3.0), db * (1.5 - kEulerGamma - std::log(3.0)), 1e-12);
  EXPECT_NEAR(MeanLogSpeckleDb(1.5), db * (2.0 - kEulerGamma - std::log(4.0) - std::log(1.5)), 1e-12);
  EXPECT_LT(MeanLogSpeckleDb(1.0), MeanLogSpeckleDb(1.1));
  EXPECT_NEAR(MeanLogSpeckleDb(1e6), -db * 0.5e-6, 1e-9);
}

TEST(Speckle, WeightsHaveTheVarianceOfTheLooks) {
  for (int i = 0; i <= 200; ++i) {
    const double looks = 1.0 + 0.05 * i;
    const auto [whole, weight] = LooksAsWeights(looks);
    const double sum = whole + weight;
    ASSERT_GE(weight, 0.0) << looks;
    ASSERT_LT(weight, 1.0) << looks;
    EXPECT_NEAR((whole + weight * weight) / (sum * sum), 1.0 / looks, 1e-12) << looks;
  }
  EXPECT_EQ(LooksAsWeights(1.0), std::make_pair(1, 0.0));
  EXPECT_EQ(LooksAsWeights(4.0), std::make_pair(4, 0.0));
}

TEST(Display, RunsFromMinimumToMaximum) {
  const DisplayParameters<double> display{.db_min = 40.0, .db_max = 120.0};
  EXPECT_DOUBLE_EQ(LogDisplay(display, 40.0), 0.0);
  EXPECT_DOUBLE_EQ(LogDisplay(display, 60.0), 0.25);
  EXPECT_DOUBLE_EQ(LogDisplay(display, 120.0), 1.0);
  EXPECT_DOUBLE_EQ(LogDisplay(display, 200.0), 2.0);  // clipped later
}

}  // namespace
}  // namespace sonarcal
