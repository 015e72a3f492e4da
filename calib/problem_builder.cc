#include "calib/problem_builder.h"

#include <ceres/cost_function.h>
#include <ceres/crs_matrix.h>
#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace sonarcal {
namespace {

// Derivatives carried at once through the shading of cells.
constexpr int kStride = 8;
using Dual = ceres::Jet<double, kStride>;

bool Counts(const FitFrame& frame, std::size_t pixel) {
  return frame.use.empty() || frame.use[pixel] != 0;
}

// A frame's expected image minus the recorded one. Its derivatives are those of the forward model in dual
// numbers; Ceres' own wrapper would carry them through the blur pixel by pixel, which is ten times the work.
class FrameCost final : public ceres::CostFunction {
 public:
  FrameCost(const FitFrame& frame, const ImageGeometry& geometry, const FitState& state)
      : frame_(frame), geometry_(geometry), state_(state) {
    set_num_residuals(static_cast<int>(frame.measured.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(state.active.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const double* coordinates = blocks[0];
    const PaperParameters<double> parameters = ParametersAt<double>([&](int i) { return coordinates[i]; });
    if (!(parameters.display.db_max > parameters.display.db_min)) return false;
    const PaperImageEvaluation evaluation(frame_.echoes, geometry_, parameters);
    const std::vector<double>& image = evaluation.image();
    for (std::size_t i = 0; i < image.size(); ++i) {
      residuals[i] = Counts(frame_, i) ? image[i] - frame_.measured[i] : 0.0;
    }
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const int count = static_cast<int>(state_.active.size());
    for (int first = 0; first < count; first += kStride) {
      const auto derivatives = evaluation.Derivatives(ParametersAt<Dual>([&](int i) {
        return i >= first && i < first + kStride ? Dual(coordinates[i], i - first) : Dual(coordinates[i]);
      }));
      WriteColumns(derivatives, first, std::min(kStride, count - first), jacobians[0]);
    }
    return true;
  }

 private:
  template <typename T, typename CoordinateAt>
  PaperParameters<T> ParametersAt(const CoordinateAt& coordinate_at) const {
    PaperParameters<T> parameters = CastPaperParameters<T>(state_.values);
    for (std::size_t i = 0; i < state_.active.size(); ++i) {
      PaperSlot(parameters, state_.active[i]) =
          state_.active[i].ValueFromCoordinate(coordinate_at(static_cast<int>(i)));
    }
    return parameters;
  }

  void WriteColumns(const std::vector<std::vector<double>>& derivatives, int first, int columns,
                    double* jacobian) const {
    const std::size_t stride = state_.active.size();
    for (std::size_t i = 0; i < frame_.measured.size(); ++i) {
      double* row = jacobian + i * stride + first;
      const bool counts = Counts(frame_, i);
      for (int k = 0; k < columns; ++k) row[k] = counts ? derivatives[k][i] : 0.0;
    }
  }

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
    problem->AddResidualBlock(new FrameCost(frame, geometry, state), nullptr, coordinates.data());
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
