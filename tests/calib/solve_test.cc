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
  EXPECT_TRUE(solved.converged);
  EXPECT_FALSE(solved.termination.empty());
}

TEST_F(BoundedSolve, ItEndsOnceNoStepIsWorthwhile) {
  Solve({kC, kD, kE});
  const ParameterValues best = state_.values;
  const double cost = CostAt(model_, best, 1);
  state_.values[kC] *= 1.01;
  state_.values[kE] *= 1.01;
  const double above = CostAt(model_, state_.values, 1) - cost;
  ASSERT_GT(above, 0.0);
  const FitState start = state_;
  EXPECT_EQ(SolveFit(model_, catalog_, {.least_fall = 2.0 * above}, {}, state_).iterations, 0);
  for (const int entry : state_.active) EXPECT_NEAR(state_.values[entry] / start.values[entry], 1.0, 1e-12);
  EXPECT_GT(SolveFit(model_, catalog_, {.least_fall = 0.1 * above}, {}, state_).iterations, 0);
  EXPECT_LT(CostAt(model_, state_.values, 1), cost + 0.1 * above);
}

// The cheaper model has other pixels of the same curve, and so another optimum. Its slope is corrected, so
// that moves end at the optimum of the right one.
TEST_F(BoundedSolve, MovesByACheaperModelEndAtTheRightOptimum) {
  const testing::CurveModel cheaper{
      {.truth = {.a = 0.1, .b_deg = 5.0, .c = 0.002, .d = 1.8, .e = 0.01, .f_deg = 11.0}, .seed = 2}};
  Solve({kC, kD, kE});
  const double lowest = CostAt(model_, state_.values, 1);
  state_.values[kC] *= 1.5;
  state_.values[kD] *= 0.8;
  const double before = CostAt(model_, state_.values, 1);
  double fallen = 0.0;
  for (int move = 0; move < 3; ++move)
    fallen += MoveByCheaperModel(model_, cheaper, catalog_, {.function_tolerance = 1e-12}, {}, state_);
  EXPECT_NEAR(before - CostAt(model_, state_.values, 1), fallen, 1e-6 * before);
  EXPECT_LT(CostAt(model_, state_.values, 1), lowest + 0.02);

  FitState of_cheaper{.active = state_.active, .values = state_.values};
  SolveFit(cheaper, catalog_, {.function_tolerance = 1e-12}, {}, of_cheaper);
  EXPECT_GT(CostAt(model_, of_cheaper.values, 1), lowest + 0.2) << "without the correction";
}

TEST_F(BoundedSolve, AMoveThatRaisesTheCostIsNotMade) {
  Solve({kC, kD, kE});
  const ParameterValues best = state_.values;
  // A curve of another shape and level: its corrected optimum is far from here.
  const testing::CurveModel wrong{
      {.truth = {.a = 0.1, .b_deg = 5.0, .c = 0.2, .d = 0.5, .e = 0.5, .f_deg = 30.0}, .seed = 3}};
  EXPECT_GE(MoveByCheaperModel(model_, wrong, catalog_, {}, {}, state_), 0.0);
  EXPECT_LE(CostAt(model_, state_.values, 1), CostAt(model_, best, 1) + 1e-9);
}

}  // namespace
}  // namespace sonarcal::calib
