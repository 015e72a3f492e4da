#include "core/math/bisection.h"

#include <gtest/gtest.h>

#include <numbers>

namespace sonarcal {
namespace {

TEST(BisectionTest, FindsARootToTheLastDigit) {
  EXPECT_DOUBLE_EQ(Bisection(0.0, 4.0, [](double x) { return x * x < 2.0; }), std::numbers::sqrt2);
}

TEST(BisectionTest, AConditionThatDoesNotChangeGivesAnEnd) {
  EXPECT_DOUBLE_EQ(Bisection(-3.0, 5.0, [](double) { return true; }), 5.0);
  EXPECT_DOUBLE_EQ(Bisection(-3.0, 5.0, [](double) { return false; }), -3.0);
}

}  // namespace
}  // namespace sonarcal
