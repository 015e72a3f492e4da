// Solves with bounds: at the end, the cost falls in no direction that the bounds allow. Slopes are
// differences of the cost, not those of the solver. SYNTHETIC pixels (tests/calib/curve_model.h).
#include "calib/solve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/calib/curve_model.h"

namespace sonarcal::calib {
namespace {

constexpr int kC = 2;
constexpr int kD = 3;
constexpr int kE = 4;

class BoundedSolve : public ::testing::Test {
 protected:
  SolveSummary Solve(std::vector<int> active) {
    state_.active = std::move(active);
    return SolveFit(model_, catalog_, {.function_tolerance = 1e-12}, {}, state_);
  }

  double Coordinate(int entry) const { return catalog_[entry].CoordinateFromValue(state_.values[entry]); }

  // Slope of the cost by the coordinate of an entry.
  double Slope(int entry) const {
    constexpr double kStep = 1e-5;
    double cost[2] = {};
    for (const int side : {0, 1}) {
      ParameterValues values = state_.values;
      values[entry] = catalog_[entry].ValueFromCoordinate(Coordinate(entry) + (2 * side - 1) * kStep);
      cost[side] = CostAt(model_, values, 1);
    }
    return (cost[1] - cost[0]) / (2.0 * kStep);
  }

  testing::CurveModel model_{
      {.truth = {.a = 0.1, .b_deg = 5.0, .c = 0.002, .d = 1.8, .e = 0.01, .f_deg = 11.0}}};
  std::vector<CatalogEntry> catalog_ = model_.catalog();
  FitState state_{.active = {}, .values = model_.truth()};
};

TEST_F(BoundedSolve, ABoundThatStopsAValueLeavesTheOthersAtTheirOptimum) {
  catalog_[kD].upper = 1.0;  // the truth is 1.8
  state_.values[kC] = 0.02;
  state_.values[kD] = 0.5;
  state_.values[kE] = 0.1;
  const SolveSummary solved = Solve({kC, kD, kE});
  ASSERT_TRUE(solved.usable) << solved.termination;
  EXPECT_DOUBLE_EQ(state_.values[kD], 1.0);
  EXPECT_LT(Slope(kD), -1.0) << "the cost falls beyond the bound";
  EXPECT_NEAR(Slope(kC), 0.0, 0.05);
  EXPECT_NEAR(Slope(kE), 0.0, 0.05);
}

TEST_F(BoundedSolve, AValueThatStartsAtABoundLeavesItIfTheCostFallsInwards) {
  state_.values[kD] = catalog_[kD].lower;
  const SolveSummary solved = Solve({kC, kD, kE});
  ASSERT_TRUE(solved.usable) << solved.termination;
  EXPECT_GT(state_.values[kD], 1.0);
  for (const int entry : {kC, kD, kE}) EXPECT_NEAR(Slope(entry), 0.0, 0.05) << catalog_[entry].name;
}

TEST_F(BoundedSolve, NothingMovesIfBoundsStopEveryValue) {
  catalog_[kD].upper = 1.0;
  state_.values[kD] = 1.0;
  const double cost = CostAt(model_, state_.values, 1);
  const SolveSummary solved = Solve({kD});
  ASSERT_TRUE(solved.usable) << solved.termination;
  EXPECT_DOUBLE_EQ(state_.values[kD], 1.0);
  EXPECT_NEAR(solved.cost, cost, 1e-9 * cost);
  EXPECT_FALSE(solved.termination.empty());
}

}  // namespace
}  // namespace sonarcal::calib
