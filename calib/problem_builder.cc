#include "calib/problem_builder.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

class FrameCost final : public ceres::CostFunction {
 public:
  FrameCost(const FrameModel& model, const std::vector<CatalogEntry>& catalog, const FitState& state,
            int frame)
      : model_(model), catalog_(catalog), state_(state), frame_(frame) {
    set_num_residuals(static_cast<int>(model.pixel_count()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(state.active.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    FitState state = state_;
    state.SetCoordinates(catalog_, {blocks[0], blocks[0] + state.active.size()});
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    PixelTerms terms;
    if (!model_.Evaluate(frame_, state.values, state.active, derivatives, terms)) return false;
    std::copy(terms.residual.begin(), terms.residual.end(), residuals);
    if (!derivatives) return true;
    const std::size_t count = state.active.size();
    std::vector<double> value_slope;
    for (const int entry : state.active)
      value_slope.push_back(catalog_[entry].ValueSlope(state.values[entry]));
    for (std::size_t pixel = 0; pixel < terms.residual.size(); ++pixel) {
      for (std::size_t k = 0; k < count; ++k) {
        jacobians[0][pixel * count + k] =
            terms.slope[pixel] * terms.eta_jacobian[pixel * count + k] * value_slope[k];
      }
    }
    return true;
  }

 private:
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
    SONARCAL_CHECK(model.Evaluate(frame, state.values, state.active, true, terms),
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
    if (!model.Evaluate(frame, values, {}, false, terms)) return std::numeric_limits<double>::infinity();
    for (const double residual : terms.residual) cost += 0.5 * residual * residual;
  }
  return cost;
}

}  // namespace sonarcal
