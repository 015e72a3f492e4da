#include "calib/problem_builder.h"

#include <ceres/crs_matrix.h>
#include <ceres/dynamic_autodiff_cost_function.h>

#include <cmath>
#include <utility>

namespace sonarcal {
namespace {

// Derivatives carried at once; Ceres passes over the parameters in strides of it.
constexpr int kStride = 8;

bool Counts(const FitFrame& frame, std::size_t pixel) {
  return frame.use.empty() || frame.use[pixel] != 0;
}

class FrameResidual {
 public:
  FrameResidual(const FitFrame& frame, const ImageGeometry& geometry, const FitState& state)
      : frame_(frame), geometry_(geometry), state_(state) {}

  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    PaperParameters<T> parameters = CastPaperParameters<T>(state_.values);
    for (std::size_t i = 0; i < state_.active.size(); ++i) {
      PaperSlot(parameters, state_.active[i]) = state_.active[i].ValueFromCoordinate(blocks[0][i]);
    }
    if (!(parameters.display.db_max > parameters.display.db_min)) return false;
    const std::vector<T> image = ExpectedPaperImage(frame_.echoes, geometry_, parameters);
    for (std::size_t i = 0; i < image.size(); ++i) {
      residuals[i] = Counts(frame_, i) ? image[i] - frame_.measured[i] : T(0.0);
    }
    return true;
  }

 private:
  const FitFrame& frame_;
  const ImageGeometry& geometry_;
  const FitState& state_;
};

}  // namespace

std::vector<double> FitState::Coordinates() const {
  std::vector<double> coordinates;
  PaperParameters<double> copy = values;
  for (const CatalogEntry& entry : active)
    coordinates.push_back(entry.CoordinateFromValue(PaperSlot(copy, entry)));
  return coordinates;
}

void FitState::SetCoordinates(const std::vector<double>& coordinates) {
  for (std::size_t i = 0; i < active.size(); ++i) {
    PaperSlot(values, active[i]) = active[i].ValueFromCoordinate(coordinates[i]);
  }
}

std::unique_ptr<ceres::Problem> BuildProblem(const std::vector<FitFrame>& frames,
                                             const ImageGeometry& geometry, const FitState& state,
                                             std::vector<double>& coordinates) {
  auto problem = std::make_unique<ceres::Problem>();
  const int active_count = static_cast<int>(state.active.size());
  for (const FitFrame& frame : frames) {
    auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<FrameResidual, kStride>>(
        new FrameResidual(frame, geometry, state));
    cost->AddParameterBlock(active_count);
    cost->SetNumResiduals(static_cast<int>(frame.measured.size()));
    problem->AddResidualBlock(cost.release(), nullptr, coordinates.data());
  }
  for (int i = 0; i < active_count; ++i) {
    const CatalogEntry& entry = state.active[i];
    problem->SetParameterLowerBound(coordinates.data(), i, entry.CoordinateFromValue(entry.lower));
    problem->SetParameterUpperBound(coordinates.data(), i, entry.CoordinateFromValue(entry.upper));
  }
  return problem;
}

NormalEquations Accumulate(ceres::Problem& problem, const ImageGeometry& geometry,
                           const std::vector<FitFrame>& frames, const FitOptions& options,
                           ResidualSummary* raw) {
  std::vector<double> residuals;
  ceres::CRSMatrix jacobian;
  SONARCAL_CHECK(problem.Evaluate({}, nullptr, &residuals, nullptr, &jacobian),
                 "the model gives no value here");
  const int bins = geometry.axes.range_bins;
  const int beams = geometry.axes.beam_count();
  const int block_rows = (bins + options.block_bins - 1) / options.block_bins;
  const int block_cols = (beams + options.block_beams - 1) / options.block_beams;

  NormalEquations equations;
  const int n = jacobian.num_cols;
  const NormalEquations::Block empty{.information = Eigen::MatrixXd::Zero(n, n),
                                     .score = Eigen::VectorXd::Zero(n)};
  equations.information = empty.information;
  equations.blocks.assign(frames.size() * block_rows * block_cols, empty);
  double sum = 0.0;
  Eigen::VectorXd row_values(n);
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const int pixel = row % (bins * beams);
    const int frame = row / (bins * beams);
    if (!Counts(frames[frame], pixel)) continue;
    ++equations.residual_count;
    sum += residuals[row];
    equations.residual_square += residuals[row] * residuals[row];
    row_values.setZero();
    for (int i = jacobian.rows[row]; i < jacobian.rows[row + 1]; ++i) {
      row_values(jacobian.cols[i]) = jacobian.values[i];
    }
    if (row_values.isZero(0.0)) continue;
    NormalEquations::Block& block =
        equations.blocks[(frame * block_rows + pixel / beams / options.block_bins) * block_cols +
                         pixel % beams / options.block_beams];
    block.information.selfadjointView<Eigen::Lower>().rankUpdate(row_values);
    block.score += residuals[row] * row_values;
  }
  std::erase_if(equations.blocks,
                [](const NormalEquations::Block& block) { return block.score.isZero(0.0); });
  for (NormalEquations::Block& block : equations.blocks) {
    block.information = Eigen::MatrixXd(block.information.selfadjointView<Eigen::Lower>());
    equations.information += block.information;
  }
  if (raw != nullptr) {
    const double count = static_cast<double>(equations.residual_count);
    raw->mean = sum / count;
    raw->spread = std::sqrt(std::max(0.0, equations.residual_square / count - raw->mean * raw->mean));
  }
  return equations;
}

double CostAt(const std::vector<FitFrame>& frames, const ImageGeometry& geometry,
              const PaperParameters<double>& parameters) {
  double cost = 0.0;
  for (const FitFrame& frame : frames) {
    const std::vector<double> image = ExpectedPaperImage(frame.echoes, geometry, parameters);
    for (std::size_t i = 0; i < image.size(); ++i) {
      if (!Counts(frame, i)) continue;
      cost += 0.5 * (image[i] - frame.measured[i]) * (image[i] - frame.measured[i]);
    }
  }
  return cost;
}

}  // namespace sonarcal
