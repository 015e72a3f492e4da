#include "calib/problem_builder.h"

#include <ceres/cost_function.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

// A frame's pixels, a hundred thousand residuals, as few residuals as there are parameters and one more, with
// the same cost, gradient and J^T J: with J^T J = V diag(l) V^T,
//
//   J' = diag(sqrt(l)) V^T,  r' = diag(1 / sqrt(l)) V^T J^T r,  and the rest of |r| in the last residual.
//
// That is all that a Levenberg-Marquardt step asks for; the large Jacobian is never stored.
class FrameCost final : public ceres::CostFunction {
 public:
  FrameCost(const FrameModel& model, const std::vector<CatalogEntry>& catalog, const FitState& state,
            int frame)
      : model_(model), catalog_(catalog), state_(state), frame_(frame) {
    set_num_residuals(static_cast<int>(state.active.size()) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(state.active.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    FitState state = state_;
    state.SetCoordinates(catalog_, {blocks[0], blocks[0] + state.active.size()});
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    thread_local PixelTerms terms;  // keeps its memory from one evaluation to the next
    if (!model_.Evaluate(frame_, state.values, state.active,
                         derivatives ? FrameModel::Terms::kDerivatives : FrameModel::Terms::kResiduals,
                         terms)) {
      return false;
    }
    const auto pixels = static_cast<Eigen::Index>(terms.residual.size());
    const Eigen::Map<const Eigen::VectorXd> residual(terms.residual.data(), pixels);
    const auto n = static_cast<Eigen::Index>(state.active.size());
    Eigen::Map<Eigen::VectorXd> out(residuals, n + 1);
    out.setZero();
    if (!derivatives) {
      out(n) = residual.norm();
      return true;
    }
    Eigen::VectorXd value_slope(n);
    for (Eigen::Index k = 0; k < n; ++k)
      value_slope(k) = catalog_[state.active[k]].ValueSlope(state.values[state.active[k]]);
    Eigen::Map<RowMajor> rows(terms.eta_jacobian.data(), pixels, n);
    const Eigen::Map<const Eigen::VectorXd> slope(terms.slope.data(), pixels);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    constexpr Eigen::Index kChunk = 1024;
    for (Eigen::Index first = 0; first < pixels; first += kChunk) {
      const Eigen::Index count = std::min(kChunk, pixels - first);
      const RowMajor chunk =
          slope.segment(first, count).asDiagonal() * rows.middleRows(first, count) * value_slope.asDiagonal();
      information.noalias() += chunk.transpose() * chunk;
      gradient.noalias() += chunk.transpose() * residual.segment(first, count);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
    const double smallest = 1e-14 * std::max(solver.eigenvalues()(n - 1), 0.0);
    Eigen::Map<RowMajor> jacobian(jacobians[0], n + 1, n);
    jacobian.setZero();
    for (Eigen::Index k = 0; k < n; ++k) {
      const double eigenvalue = solver.eigenvalues()(k);
      if (!(eigenvalue > smallest)) continue;  // a direction that moves nothing has no gradient either
      const double root = std::sqrt(eigenvalue);
      jacobian.row(k) = root * solver.eigenvectors().col(k).transpose();
      out(k) = solver.eigenvectors().col(k).dot(gradient) / root;
    }
    out(n) = std::sqrt(std::max(residual.squaredNorm() - out.squaredNorm(), 0.0));
    return true;
  }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  const FrameModel& model_;
  const std::vector<CatalogEntry>& catalog_;
  const FitState& state_;
  int frame_;
};

}  // namespace

std::vector<double> FitState::Coordinates(const std::vector<CatalogEntry>& catalog) const {
  std::vector<double> coordinates;
  for (const int entry : active) coordinates.push_back(catalog[entry].CoordinateFromValue(values[entry]));
  return coordinates;
}

void FitState::SetCoordinates(const std::vector<CatalogEntry>& catalog,
                              const std::vector<double>& coordinates) {
  for (std::size_t i = 0; i < active.size(); ++i) {
    values[active[i]] = catalog[active[i]].ValueFromCoordinate(coordinates[i]);
  }
}

std::unique_ptr<ceres::Problem> BuildProblem(const FrameModel& model,
                                             const std::vector<CatalogEntry>& catalog, const FitState& state,
                                             std::vector<double>& coordinates) {
  auto problem = std::make_unique<ceres::Problem>();
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    problem->AddResidualBlock(new FrameCost(model, catalog, state, frame), nullptr, coordinates.data());
  }
  for (std::size_t i = 0; i < state.active.size(); ++i) {
    const CatalogEntry& entry = catalog[state.active[i]];
    const int index = static_cast<int>(i);
    problem->SetParameterLowerBound(coordinates.data(), index, entry.CoordinateFromValue(entry.lower));
    problem->SetParameterUpperBound(coordinates.data(), index, entry.CoordinateFromValue(entry.upper));
  }
  return problem;
}

NormalEquations Accumulate(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                           const FitState& state, const FitOptions& options, ResidualSummary* residuals) {
  const int beams = model.beams();
  const int block_rows = (model.range_bins() + options.block_bins - 1) / options.block_bins;
  const int block_cols = (beams + options.block_beams - 1) / options.block_beams;
  const auto n = static_cast<Eigen::Index>(state.active.size());

  NormalEquations equations;
  equations.information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd value_slope(n);
  for (Eigen::Index k = 0; k < n; ++k)
    value_slope(k) = catalog[state.active[k]].ValueSlope(state.values[state.active[k]]);

  double sum = 0.0;
  PixelTerms terms;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Rows rows(options.block_bins * options.block_beams, n);
  Eigen::VectorXd scores(rows.rows());
  Eigen::VectorXd roots(rows.rows());
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    SONARCAL_CHECK(model.Evaluate(frame, state.values, state.active, FrameModel::Terms::kInformation, terms),
                   "the model gives no value here");
    const Eigen::Map<const Rows> jacobian(terms.eta_jacobian.data(),
                                          static_cast<Eigen::Index>(model.pixel_count()), n);
    for (int block_row = 0; block_row < block_rows; ++block_row) {
      for (int block_col = 0; block_col < block_cols; ++block_col) {
        Eigen::Index count = 0;
        for (int bin = block_row * options.block_bins;
             bin < std::min((block_row + 1) * options.block_bins, model.range_bins()); ++bin) {
          for (int beam = block_col * options.block_beams;
               beam < std::min((block_col + 1) * options.block_beams, beams); ++beam) {
            const std::size_t pixel = static_cast<std::size_t>(bin) * beams + beam;
            if (!model.Counts(frame, pixel)) continue;
            const double residual = terms.residual[pixel];
            ++equations.residual_count;
            sum += residual;
            equations.residual_square += residual * residual;
            rows.row(count) =
                jacobian.row(static_cast<Eigen::Index>(pixel)).cwiseProduct(value_slope.transpose());
            scores(count) = residual * terms.slope[pixel];
            roots(count) = std::sqrt(terms.information[pixel]);
            ++count;
          }
        }
        if (count == 0) continue;
        NormalEquations::Block block;
        block.score = rows.topRows(count).transpose() * scores.head(count);
        if (block.score.isZero(0.0)) continue;
        const Rows weighted = roots.head(count).asDiagonal() * rows.topRows(count);
        block.information = weighted.transpose() * weighted;
        equations.information += block.information;
        equations.blocks.push_back(std::move(block));
      }
    }
  }
  if (residuals != nullptr) {
    const double count = static_cast<double>(equations.residual_count);
    residuals->mean = sum / count;
    residuals->spread =
        std::sqrt(std::max(0.0, equations.residual_square / count - residuals->mean * residuals->mean));
  }
  return equations;
}

double CostAt(const FrameModel& model, const ParameterValues& values, int frames) {
  double cost = 0.0;
  PixelTerms terms;
  for (int frame = 0; frame < frames; ++frame) {
    if (!model.Evaluate(frame, values, {}, FrameModel::Terms::kResiduals, terms))
      return std::numeric_limits<double>::infinity();
    for (const double residual : terms.residual) cost += 0.5 * residual * residual;
  }
  return cost;
}

}  // namespace sonarcal
