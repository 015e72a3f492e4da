#include "calib/problem_builder.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <memory>

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
  const NormalEquations::Block empty{.information = Eigen::MatrixXd::Zero(n, n),
                                     .score = Eigen::VectorXd::Zero(n)};
  equations.information = empty.information;
  equations.blocks.assign(static_cast<std::size_t>(model.frame_count()) * block_rows * block_cols, empty);
  Eigen::VectorXd value_slope(n);
  for (Eigen::Index k = 0; k < n; ++k)
    value_slope(k) = catalog[state.active[k]].ValueSlope(state.values[state.active[k]]);

  double sum = 0.0;
  PixelTerms terms;
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    SONARCAL_CHECK(model.Evaluate(frame, state.values, state.active, true, terms),
                   "the model gives no value here");
    for (std::size_t pixel = 0; pixel < terms.residual.size(); ++pixel) {
      if (!model.Counts(frame, pixel)) continue;
      const double residual = terms.residual[pixel];
      ++equations.residual_count;
      sum += residual;
      equations.residual_square += residual * residual;
      const Eigen::VectorXd row =
          Eigen::Map<const Eigen::VectorXd>(&terms.eta_jacobian[pixel * n], n).cwiseProduct(value_slope);
      if (row.isZero(0.0)) continue;
      const int bin = static_cast<int>(pixel) / beams;
      const int beam = static_cast<int>(pixel) % beams;
      NormalEquations::Block& block =
          equations
              .blocks[(static_cast<std::size_t>(frame) * block_rows + bin / options.block_bins) * block_cols +
                      beam / options.block_beams];
      block.information.selfadjointView<Eigen::Lower>().rankUpdate(row, terms.information[pixel]);
      block.score += residual * terms.slope[pixel] * row;
    }
  }
  std::erase_if(equations.blocks,
                [](const NormalEquations::Block& block) { return block.score.isZero(0.0); });
  for (NormalEquations::Block& block : equations.blocks) {
    block.information = Eigen::MatrixXd(block.information.selfadjointView<Eigen::Lower>());
    equations.information += block.information;
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
