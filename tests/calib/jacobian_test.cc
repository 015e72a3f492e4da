// The derivatives that Ceres gets, against central differences of the image itself.
#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calib/problem_builder.h"
#include "tests/calib/small_tank.h"

namespace sonarcal {
namespace {

TEST(PaperJacobianTest, EqualsCentralDifferencesForEveryParameter) {
  const Simulator simulator(testing::SmallTank(), testing::SmallSonar(), testing::SmallTankOptions());
  const ImageGeometry geometry(simulator.sonar(), simulator.absorption_db_per_m());
  std::vector<FitFrame> frames = testing::MakeFitFrames(simulator, [&](const EchoList& echoes, int) {
    return simulator.RenderExpected(echoes, testing::SmallTankTruth());
  });
  frames.resize(1);
  FitState state{.active = BuildCatalog({"floor", "box"}), .values = {}};
  state.values = PaperParametersFor(testing::SmallTankTruth(), {"floor", "box"});
  std::vector<double> coordinates = state.Coordinates();
  const auto problem = BuildProblem(frames, geometry, state, coordinates);
  ceres::CRSMatrix jacobian;
  ASSERT_TRUE(problem->Evaluate({}, nullptr, nullptr, nullptr, &jacobian));
  std::vector<std::vector<double>> dense(jacobian.num_cols, std::vector<double>(jacobian.num_rows, 0.0));
  for (int row = 0; row < jacobian.num_rows; ++row) {
    for (int i = jacobian.rows[row]; i < jacobian.rows[row + 1]; ++i)
      dense[jacobian.cols[i]][row] = jacobian.values[i];
  }

  for (std::size_t parameter = 0; parameter < coordinates.size(); ++parameter) {
    const auto residuals_at = [&](double step) {
      const double saved = coordinates[parameter];
      coordinates[parameter] = saved + step;
      std::vector<double> residuals;
      EXPECT_TRUE(problem->Evaluate({}, nullptr, &residuals, nullptr, nullptr));
      coordinates[parameter] = saved;
      return residuals;
    };
    const double step = 1e-4;
    const std::vector<double> above = residuals_at(step);
    const std::vector<double> below = residuals_at(-step);
    double largest = 0.0;
    double worst = 0.0;
    for (int row = 0; row < jacobian.num_rows; ++row) {
      const double difference = (above[row] - below[row]) / (2.0 * step);
      largest = std::max(largest, std::abs(difference));
      worst = std::max(worst, std::abs(difference - dense[parameter][row]));
    }
    // Central differences are good to the square of the step; the blur that rows share to the square of a
    // hundredth.
    EXPECT_GT(largest, 0.0) << state.active[parameter].name;
    EXPECT_LT(worst, 1e-3 * largest) << state.active[parameter].name;
  }
}

}  // namespace
}  // namespace sonarcal
