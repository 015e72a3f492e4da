// The derivatives that Ceres gets, against central differences of the residuals it gets.
#include <ceres/crs_matrix.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/paper_frame_model.h"
#include "calib/problem_builder.h"
#include "tests/calib/small_tank.h"

namespace sonarcal {
namespace {

// By parameter, then by residual.
using Columns = std::vector<std::vector<double>>;

Columns Dense(const ceres::CRSMatrix& matrix) {
  Columns dense(matrix.num_cols, std::vector<double>(matrix.num_rows, 0.0));
  for (int row = 0; row < matrix.num_rows; ++row) {
    for (int i = matrix.rows[row]; i < matrix.rows[row + 1]; ++i)
      dense[matrix.cols[i]][row] = matrix.values[i];
  }
  return dense;
}

// Four views, of which the one from above sees the floor's peak: every parameter of every material moves
// pixels of some frame.
TEST(PaperJacobian, EqualsCentralDifferencesForEveryParameter) {
  const Simulator simulator(testing::SmallTank(), testing::SmallSonar(), testing::SmallTankOptions());
  const ImageGeometry geometry(simulator.sonar(), simulator.absorption_db_per_m());
  const std::vector<FitFrame> frames = testing::MakeFitFrames(simulator, [&](const EchoList& echoes, int) {
    return simulator.RenderExpected(echoes, testing::SmallTankTruth());
  });
  const std::vector<std::string> materials = {"floor", "box"};
  const PaperFrameModel model(frames, geometry, materials, testing::SmallTankTruth());
  const std::vector<CatalogEntry>& catalog = model.catalog();
  FitState state{.active = std::vector<int>(catalog.size()),
                 .values = model.Values(testing::SmallTankTruth())};
  std::iota(state.active.begin(), state.active.end(), 0);
  std::vector<double> coordinates = state.Coordinates(catalog);
  const auto problem = BuildProblem(model, catalog, state, coordinates);
  ceres::CRSMatrix jacobian;
  ASSERT_TRUE(problem->Evaluate({}, nullptr, nullptr, nullptr, &jacobian));
  const Columns analytic = Dense(jacobian);

  for (std::size_t parameter = 0; parameter < coordinates.size(); ++parameter) {
    const CatalogEntry& entry = catalog[parameter];
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
      worst = std::max(worst, std::abs(difference - analytic[parameter][row]));
    }
    // Rows of cells whose azimuth errors differ by less than 1 % share a kernel, corrected to first order:
    // the slope is that of the kernel, up to 0.01 x |sigma w''| / |w'| away.
    const bool shares_kernels = entry.group == ParameterGroup::kJitter && entry.index > 0;
    EXPECT_GT(largest, 0.0) << entry.name << " moves nothing";
    EXPECT_LT(worst, (shares_kernels ? 1e-2 : 1e-6) * largest) << entry.name;
  }
}

}  // namespace
}  // namespace sonarcal
