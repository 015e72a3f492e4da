// The derivatives that a solver gets, against central differences of the residuals; and what Ceres is told of
// them, against the sums over every pixel.
#include <ceres/crs_matrix.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/identifiability.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/paper/paper_frame_model.h"
#include "calib/problem_builder.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using Terms = FrameModel::Terms;

std::vector<int> AllOf(const FrameModel& model) {
  std::vector<int> all(model.catalog().size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// `tolerance(entry)`: of the largest derivative by that parameter in any frame.
template <typename Tolerance>
void ExpectDerivativesOfResiduals(const FrameModel& model, const ParameterValues& values,
                                  const std::vector<int>& active, Tolerance tolerance) {
  for (std::size_t k = 0; k < active.size(); ++k) {
    const CatalogEntry& entry = model.catalog()[active[k]];
    // An echo changes by a factor per small move where a pulse begins or ends.
    // Echoes through other range and azimuth errors are gathered anew, without shares below 1e-6 of a pixel.
    const double relative = entry.group == ParameterGroup::kJitter ? 5e-3 : 1e-4;
    const double step = IsPlacement(entry) ? 1e-6 : relative * (entry.logarithmic ? values[active[k]] : 1.0);
    double largest = 0.0;
    double worst = 0.0;
    long kinks = 0;
    for (int frame = 0; frame < model.frame_count(); ++frame) {
      PixelTerms at;
      PixelTerms above;
      PixelTerms below;
      ParameterValues moved = values;
      ASSERT_TRUE(model.Evaluate(frame, values, active, Terms::kDerivatives, at));
      moved[active[k]] = values[active[k]] + step;
      ASSERT_TRUE(model.Evaluate(frame, moved, {}, Terms::kResiduals, above));
      moved[active[k]] = values[active[k]] - step;
      ASSERT_TRUE(model.Evaluate(frame, moved, {}, Terms::kResiduals, below));
      for (std::size_t i = 0; i < at.residual.size(); ++i) {
        const double difference = (above.residual[i] - below.residual[i]) / (2.0 * step);
        // A linear echo that falls below nothing is nothing: at that corner the two sides differ.
        const double bend = (above.residual[i] - 2.0 * at.residual[i] + below.residual[i]) / step;
        if (IsGeometric(entry) && std::abs(bend) > 0.1 * std::abs(difference)) {
          ++kinks;
          continue;
        }
        largest = std::max(largest, std::abs(difference));
        worst = std::max(worst, std::abs(difference - at.slope[i] * at.eta_jacobian[i * active.size() + k]));
      }
    }
    EXPECT_GT(largest, 0.0) << entry.name << " moves nothing";
    EXPECT_LT(kinks, model.frame_count() * static_cast<long>(model.pixel_count()) / 50) << entry.name;
    EXPECT_LT(worst, tolerance(entry) * largest) << entry.name;
  }
}

class SmallTankModels : public ::testing::Test {
 protected:
  // Four views, of which the one from above sees the floor's peak: every parameter of every material moves
  // pixels of some frame.
  sim::Simulator simulator_{testing::SmallTank(), testing::SmallSonar(), testing::SmallTankOptions()};
  std::vector<std::string> materials_ = simulator_.caster().material_names();
};

TEST_F(SmallTankModels, PaperDerivativesEqualCentralDifferences) {
  const sim::ImageGeometry geometry(simulator_.sonar(), simulator_.absorption_db_per_m());
  const std::vector<FitFrame> frames =
      testing::MakeFitFrames(simulator_, [&](const sim::EchoList& echoes, int) {
        return simulator_.RenderExpected(echoes, testing::SmallTankTruth());
      });
  const PaperFrameModel model(frames, geometry, materials_, testing::SmallTankTruth());
  // Rows of cells whose azimuth errors differ by less than 1 % share a kernel, corrected to first order: the
  // slope is that of the kernel, up to 0.01 x |sigma w''| / |w'| away.
  ExpectDerivativesOfResiduals(model, model.Values(testing::SmallTankTruth()), AllOf(model),
                               [](const CatalogEntry& entry) {
                                 if (entry.group != ParameterGroup::kJitter) return 1e-5;
                                 return entry.index > 0 ? 1e-2 : 1e-3;
                               });
}

// Recorded powers that are nothing like the model's: clipped at either end, far above and far below.
std::vector<AcousticFrame> OddFrames(const sim::Simulator& simulator) {
  std::vector<AcousticFrame> frames;
  const std::vector<Pose> poses = testing::SmallTankPoses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    AcousticFrame frame{.index = static_cast<int>(i), .world_from_sonar = poses[i], .recorded = {}};
    const PolarAxes& axes = simulator.sonar().axes;
    for (int pixel = 0; pixel < axes.range_bins * axes.beam_count(); ++pixel) {
      const double power = PowerFromDb(120.0 + 40.0 * std::sin(0.7 * pixel));
      frame.recorded.push_back({power, static_cast<Censoring>(pixel % 3)});
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

ParameterSet AcousticTruth() {
  ParameterSet truth = testing::SmallTankTruth();
  truth.model = EchoModel::kAcoustic;
  for (auto& [name, material] : truth.materials) {
    for (double* amplitude : {&material.gsab.a, &material.gsab.c, &material.gsab.e}) *amplitude *= 1e-2;
  }
  truth.receiver.noise_db = 120.0;
  truth.receiver.noise_slope_db_per_m = 0.3;
  truth.display = {.db_min = 80.0, .db_max = 160.0};
  return truth;
}

TEST_F(SmallTankModels, AcousticDerivativesEqualCentralDifferences) {
  const std::vector<AcousticFrame> frames = OddFrames(simulator_);
  AcousticFrameModel model(simulator_, frames, AcousticTruth());
  std::vector<int> geometric;
  for (const int entry : AllOf(model)) {
    if (IsGeometric(model.catalog()[entry])) geometric.push_back(entry);
  }
  model.Linearise(model.initial_values(), geometric);
  ExpectDerivativesOfResiduals(model, model.initial_values(), AllOf(model),
                               [](const CatalogEntry& entry) { return IsGeometric(entry) ? 1e-3 : 1e-4; });
}

TEST_F(SmallTankModels, DerivativesOfGhostsEqualCentralDifferences) {
  const std::vector<AcousticFrame> frames = OddFrames(simulator_);
  ParameterSet truth = AcousticTruth();
  truth.receiver.noise_db = 100.0;
  truth.mirrors["floor"].loss_db = 3.0;
  truth.mirrors["box"].loss_db = 6.0;
  truth.beam.transmit_even_deg = 10.0;
  truth.beam.transmit_end_deg = 30.0;
  AcousticFrameModel model(simulator_, frames, truth);
  std::vector<int> active;
  std::vector<int> geometric;
  for (const int entry : AllOf(model)) {
    const CatalogEntry& of = model.catalog()[entry];
    if (of.group == ParameterGroup::kPose && of.frame > 0) continue;  // each traces ghosts anew
    active.push_back(entry);
    if (IsGeometric(of)) geometric.push_back(entry);
  }
  model.Linearise(model.initial_values(), geometric);
  ExpectDerivativesOfResiduals(model, model.initial_values(), active,
                               [](const CatalogEntry& entry) { return IsGeometric(entry) ? 1e-3 : 1e-4; });
}

TEST_F(SmallTankModels, CeresGetsTheSumsOverAllPixels) {
  const std::vector<AcousticFrame> frames = OddFrames(simulator_);
  const AcousticFrameModel model(simulator_, frames, AcousticTruth());
  const std::vector<CatalogEntry>& catalog = model.catalog();
  FitState state{.active = {}, .values = model.initial_values()};
  for (const int entry : AllOf(model)) {
    if (!IsGeometric(catalog[entry])) state.active.push_back(entry);
  }
  const auto n = static_cast<Eigen::Index>(state.active.size());
  std::vector<double> coordinates = state.Coordinates(catalog);
  FitProblem of_fit(model, catalog, state, coordinates);
  ceres::Problem& problem = of_fit.problem();
  double cost = 0.0;
  std::vector<double> gradient;
  ceres::CRSMatrix sparse;
  ASSERT_TRUE(problem.Evaluate({}, &cost, nullptr, &gradient, &sparse));
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[row]; i < sparse.rows[row + 1]; ++i)
      jacobian(row, sparse.cols[i]) = sparse.values[i];
  }
  double cost_alone = 0.0;
  ASSERT_TRUE(problem.Evaluate({}, &cost_alone, nullptr, nullptr, nullptr));

  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd expected_gradient = Eigen::VectorXd::Zero(n);
  double expected_cost = 0.0;
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    PixelTerms terms;
    ASSERT_TRUE(model.Evaluate(frame, state.values, state.active, Terms::kInformation, terms));
    for (std::size_t pixel = 0; pixel < terms.residual.size(); ++pixel) {
      Eigen::VectorXd row(n);
      for (Eigen::Index k = 0; k < n; ++k) {
        row(k) = terms.eta_jacobian[pixel * n + k] *
                 catalog[state.active[k]].ValueSlope(state.values[state.active[k]]);
      }
      const double information = std::max(terms.information[pixel], terms.slope[pixel] * terms.slope[pixel]);
      expected += information * row * row.transpose();
      expected_gradient += terms.residual[pixel] * terms.slope[pixel] * row;
      expected_cost += 0.5 * terms.residual[pixel] * terms.residual[pixel];
    }
  }
  EXPECT_NEAR(cost, expected_cost, 1e-9 * expected_cost);
  EXPECT_NEAR(cost_alone, expected_cost, 1e-9 * expected_cost);
  EXPECT_LT((jacobian.transpose() * jacobian - expected).norm(), 1e-9 * expected.norm());
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(gradient.data(), n) - expected_gradient).norm(),
            1e-7 * expected_gradient.norm());

  // The fall to the bottom of the parabola, with and without a coordinate that is held.
  const auto fall_of = [](const Eigen::MatrixXd& information, const Eigen::VectorXd& slope) {
    return 0.5 * slope.dot(information.completeOrthogonalDecomposition().solve(slope));
  };
  const double fall = fall_of(expected, expected_gradient);
  EXPECT_NEAR(of_fit.ExpectedFall(coordinates, {}).value(), fall, 1e-6 * fall);
  // The noise level: not the source level, which the receiver's gain can replace without a loss.
  const auto is_noise = [&](int entry) { return catalog[entry].name == "receiver.noise_db"; };
  const auto held = std::find_if(state.active.begin(), state.active.end(), is_noise) - state.active.begin();
  ASSERT_LT(held, n);
  Eigen::MatrixXd rest = expected;
  rest.row(held).setZero();
  rest.col(held).setZero();
  Eigen::VectorXd rest_gradient = expected_gradient;
  rest_gradient(held) = 0.0;
  const double fall_of_rest = fall_of(rest, rest_gradient);
  EXPECT_NEAR(of_fit.ExpectedFall(coordinates, {static_cast<int>(held)}).value(), fall_of_rest, 1e-6 * fall);
  EXPECT_LT(fall_of_rest, 0.999 * fall);
  std::vector<double> elsewhere = coordinates;
  elsewhere.front() += 0.1;
  EXPECT_FALSE(of_fit.ExpectedFall(elsewhere, {}).has_value()) << "nothing was evaluated there";
}

// As long as nothing moves speckle stays: a second frame of one pose makes no sigma smaller.
TEST_F(SmallTankModels, ARepeatedFrameMakesNoStandardErrorSmaller) {
  const std::vector<AcousticFrame> once = {OddFrames(simulator_).front()};
  const std::vector<AcousticFrame> twice = {once[0], once[0]};
  const auto covariance = [&](const std::vector<AcousticFrame>& frames) {
    const AcousticFrameModel model(simulator_, frames, AcousticTruth());
    FitState state{.active = {}, .values = model.initial_values()};
    for (const int entry : AllOf(model)) {
      const std::string& name = model.catalog()[entry].name;
      if (name == "receiver.noise_db" || name == "material.floor.gsab.C") state.active.push_back(entry);
    }
    EXPECT_EQ(state.active.size(), 2U);
    return JackknifeCovariance(Accumulate(model, model.catalog(), state, {}));
  };
  const Eigen::MatrixXd of_one = covariance(once);
  EXPECT_LT((covariance(twice) - of_one).norm(), 1e-9 * of_one.norm());
}

}  // namespace
}  // namespace sonarcal::calib
