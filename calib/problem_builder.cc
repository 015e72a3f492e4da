#include "calib/problem_builder.h"

#include <ceres/cost_function.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/models/pixel_math.h"
#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Directions with less than this fraction of the largest eigenvalue of the information have no effect.
constexpr double kWithoutEffect = 1e-14;

// Number of range bins evaluated together. Their Jacobian stays in the first-level cache.
int BandBins(const FrameModel& model) {
  constexpr int kPixels = 256;
  return std::max(1, kPixels / model.beams());
}

// d value / d coordinate of the active entries.
Eigen::VectorXd ValueSlopes(const std::vector<CatalogEntry>& catalog, const FitState& state) {
  Eigen::VectorXd slopes(static_cast<Eigen::Index>(state.active.size()));
  for (std::size_t k = 0; k < state.active.size(); ++k) {
    slopes(static_cast<Eigen::Index>(k)) = catalog[state.active[k]].ValueSlope(state.values[state.active[k]]);
  }
  return slopes;
}

// Calls work(band, first bin, last bin) for runs of `bins_per_band` range bins, in any order.
template <typename Work>
void ForBands(int range_bins, int bins_per_band, const Work& work) {
  const int bands = (range_bins + bins_per_band - 1) / bins_per_band;
  tbb::parallel_for(0, bands, [&](int band) {
    work(band, band * bins_per_band, std::min((band + 1) * bins_per_band, range_bins));
  });
}

// Sums over the pixels of a frame.
struct FrameSums {
  RowMajor information;      // expected information, or more if the model is far off; lower triangle
  Eigen::VectorXd gradient;  // gradient of half the sum of squares
  double residual_square = 0.0;
};

// With derivatives or without. Adds bands in order, so that the result does not depend on the number of
// threads.
std::optional<FrameSums> SumFrame(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                                  const FitState& state, int frame, bool derivatives) {
  const auto evaluation =
      model.At(frame, state.values, state.active,
               derivatives ? FrameModel::Terms::kInformation : FrameModel::Terms::kResiduals);
  if (evaluation == nullptr) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(derivatives ? state.active.size() : 0);
  const Eigen::VectorXd value_slope = derivatives ? ValueSlopes(catalog, state) : Eigen::VectorXd();
  const int band_bins = BandBins(model);
  std::vector<FrameSums> bands((model.range_bins() + band_bins - 1) / band_bins);
  std::atomic<bool> valid{true};
  ForBands(model.range_bins(), band_bins, [&](int band, int first, int last) {
    thread_local PixelTerms terms;  // keeps its memory from one band to the next
    if (!evaluation->Bins(first, last, terms)) {
      valid = false;
      return;
    }
    const auto pixels = static_cast<Eigen::Index>(terms.residual.size());
    const Eigen::Map<const Eigen::VectorXd> residual(terms.residual.data(), pixels);
    bands[band].residual_square = residual.squaredNorm();
    if (!derivatives) return;
    // At least the square of the slope, so that |r'| cannot exceed |r|.
    thread_local std::vector<double> weight;
    thread_local std::vector<double> along;
    weight.clear();
    along.clear();
    for (std::size_t i = 0; i < terms.residual.size(); ++i) {
      const double of = std::max(terms.information[i], terms.slope[i] * terms.slope[i]);
      if (of == 0.0) continue;  // pixels that no parameter moves
      if (weight.size() < i) {
        const auto row = terms.eta_jacobian.begin() + static_cast<std::ptrdiff_t>(i) * n;
        std::copy(row, row + n, terms.eta_jacobian.begin() + static_cast<std::ptrdiff_t>(weight.size()) * n);
      }
      weight.push_back(of);
      along.push_back(terms.slope[i] * terms.residual[i]);
    }
    bands[band].information = RowMajor::Zero(n, n);
    bands[band].gradient = Eigen::VectorXd::Zero(n);
    terms.eta_jacobian.resize(terms.eta_jacobian.size() + pixel_math::kRowPadding, 0.0);
    pixel_math::AddOuterProducts(terms.eta_jacobian.data(), weight.data(), along.data(),
                                 static_cast<int>(weight.size()), static_cast<int>(n),
                                 bands[band].information.data(), bands[band].gradient.data());
  });
  if (!valid) return std::nullopt;
  FrameSums sums{.information = RowMajor::Zero(n, n), .gradient = Eigen::VectorXd::Zero(n)};
  for (const FrameSums& band : bands) {
    sums.residual_square += band.residual_square;
    if (!derivatives || band.gradient.size() == 0) continue;
    sums.information += band.information;
    sums.gradient += band.gradient;
  }
  if (derivatives) {
    const Eigen::MatrixXd full = sums.information.selfadjointView<Eigen::Lower>();
    sums.information = value_slope.asDiagonal() * full * value_slope.asDiagonal();
    sums.gradient = value_slope.cwiseProduct(sums.gradient);
  }
  return sums;
}

// Rows of the Jacobian of some pixels, with their weights.
class BlockRows {
 public:
  void Clear() {
    jacobian_.clear();
    information_.clear();
    along_.clear();
  }

  void Add(const PixelTerms& terms, std::size_t pixel, Eigen::Index columns) {
    const auto row = terms.eta_jacobian.begin() + static_cast<std::ptrdiff_t>(pixel) * columns;
    jacobian_.insert(jacobian_.end(), row, row + columns);
    information_.push_back(terms.information[pixel]);
    along_.push_back(terms.residual[pixel] * terms.slope[pixel]);
  }

  // Adds to the lower triangle of `information`.
  void AddTo(RowMajor& information, Eigen::VectorXd& score) {
    jacobian_.resize(jacobian_.size() + pixel_math::kRowPadding, 0.0);
    pixel_math::AddOuterProducts(jacobian_.data(), information_.data(), along_.data(),
                                 static_cast<int>(along_.size()), static_cast<int>(score.size()),
                                 information.data(), score.data());
  }

 private:
  std::vector<double> jacobian_;
  std::vector<double> information_;
  std::vector<double> along_;
};

// Indices of the active entries that a frame depends on.
std::vector<int> ColumnsOf(int frame, const std::vector<CatalogEntry>& catalog, const FitState& state) {
  std::vector<int> columns;
  for (std::size_t k = 0; k < state.active.size(); ++k) {
    const CatalogEntry& entry = catalog[state.active[k]];
    if (entry.frame < 0 || entry.frame == frame) columns.push_back(static_cast<int>(k));
  }
  return columns;
}

// State with these of its active entries alone.
FitState WithColumns(const FitState& state, const std::vector<int>& columns) {
  FitState of{.active = {}, .values = state.values};
  for (const int k : columns) of.active.push_back(state.active[k]);
  return of;
}

// Prior of the active entries.
class PriorCost final : public ceres::CostFunction {
 public:
  PriorCost(const std::vector<CatalogEntry>& catalog, const FitState& state)
      : catalog_(catalog), state_(state) {
    set_num_residuals(static_cast<int>(state.active.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(state.active.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t n = state_.active.size();
    if (jacobians != nullptr && jacobians[0] != nullptr) std::fill_n(jacobians[0], n * n, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
      const CatalogEntry& entry = catalog_[state_.active[k]];
      const double root = entry.prior ? 1.0 / entry.prior->sigma : 0.0;
      residuals[k] = entry.prior ? root * (blocks[0][k] - entry.prior->coordinate) : 0.0;
      if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][k * n + k] = root;
    }
    return true;
  }

 private:
  const std::vector<CatalogEntry>& catalog_;
  const FitState& state_;
};

// A correction as a sum of squares: residual R (x - at) + R^-T slope for the weight R^T R.
class CorrectionCost final : public ceres::CostFunction {
 public:
  explicit CorrectionCost(const CostCorrection& correction) : at_(correction.at) {
    const Eigen::LLT<Eigen::MatrixXd> weight(correction.weight);
    SONARCAL_CHECK(weight.info() == Eigen::Success, "the weight of a correction is positive definite");
    root_ = weight.matrixU();
    offset_ = weight.matrixL().solve(correction.slope);
    set_num_residuals(static_cast<int>(at_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(at_.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(blocks[0], at_.size());
    Eigen::Map<Eigen::VectorXd>(residuals, at_.size()) = root_ * (x - at_) + offset_;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<RowMajor>(jacobians[0], at_.size(), at_.size()) = root_;
    return true;
  }

 private:
  Eigen::VectorXd at_;
  Eigen::MatrixXd root_;
  Eigen::VectorXd offset_;
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

// Replaces the hundred thousand residuals of a frame by one residual per parameter that it depends on and one
// more. Cost and gradient g are the same. J^T J is replaced by the expected information V diag(l) V^T (Fisher
// scoring; J^T J from the slopes of single pixels is a noisy estimate of it):
//
//   J' = diag(sqrt(l)) V^T,  r' = diag(1 / sqrt(l)) V^T g,  and the rest of |r| in the last residual.
//
// A Levenberg-Marquardt step needs only this, so the large Jacobian is never stored.
class FitProblem::FrameCost final : public ceres::CostFunction {
 public:
  FrameCost(const FrameModel& model, const std::vector<CatalogEntry>& catalog, const FitState& state,
            int frame)
      : model_(model),
        catalog_(catalog),
        state_(state),
        frame_(frame),
        columns_(ColumnsOf(frame, catalog, state)) {
    mine_ = WithColumns(state, columns_);
    set_num_residuals(static_cast<int>(columns_.size()) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(state.active.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    FitState all = state_;
    all.SetCoordinates(catalog_, {blocks[0], blocks[0] + state_.active.size()});
    const FitState state{.active = mine_.active, .values = std::move(all.values)};
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    // The solver tries a step first and asks for derivatives if it was good. They cost little more than the
    // residuals alone, so they are computed at once and kept.
    const std::vector<double> point(blocks[0], blocks[0] + state_.active.size());
    if (!sums_ || point != point_) {
      sums_ = SumFrame(model_, catalog_, state, frame_, true);
      point_ = point;
    }
    const auto& sums = sums_;
    if (!sums) return false;
    const auto n = static_cast<Eigen::Index>(columns_.size());
    Eigen::Map<Eigen::VectorXd> out(residuals, n + 1);
    out.setZero();
    if (!derivatives) {
      out(n) = std::sqrt(sums->residual_square);
      return true;
    }
    Eigen::Map<RowMajor> jacobian(jacobians[0], n + 1, static_cast<Eigen::Index>(state_.active.size()));
    jacobian.setZero();
    if (n > 0) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sums->information);
      const double smallest = kWithoutEffect * std::max(solver.eigenvalues()(n - 1), 0.0);
      for (Eigen::Index k = 0; k < n; ++k) {
        const double eigenvalue = solver.eigenvalues()(k);
        if (!(eigenvalue > smallest)) continue;  // a direction without effect has no gradient either
        const double root = std::sqrt(eigenvalue);
        jacobian(k, columns_) = root * solver.eigenvectors().col(k).transpose();
        out(k) = solver.eigenvectors().col(k).dot(sums->gradient) / root;
      }
    }
    out(n) = std::sqrt(std::max(sums->residual_square - out.squaredNorm(), 0.0));
    return true;
  }

  // Adds gradient and information at this point. Returns false if it was not evaluated last.
  bool AddSlopes(const std::vector<double>& point, CostSlopes& slopes) const {
    if (!sums_ || point != point_) return false;
    slopes.information(columns_, columns_) += sums_->information;
    slopes.gradient(columns_) += sums_->gradient;
    return true;
  }

 private:
  const FrameModel& model_;
  const std::vector<CatalogEntry>& catalog_;
  const FitState& state_;
  int frame_;
  mutable std::optional<FrameSums> sums_;  // at this point
  mutable std::vector<double> point_;
  std::vector<int> columns_;  // of the entries that it depends on, among all active ones
  FitState mine_;             // with these active entries only
};

FitProblem::FitProblem(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                       const FitState& state, std::vector<double>& coordinates,
                       std::optional<CostCorrection> correction)
    : catalog_(catalog), state_(state), correction_(std::move(correction)) {
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    auto cost = std::make_unique<FrameCost>(model, catalog, state, frame);
    frames_.push_back(cost.get());
    problem_.AddResidualBlock(cost.release(), nullptr, coordinates.data());
  }
  problem_.AddResidualBlock(new PriorCost(catalog, state), nullptr, coordinates.data());
  if (correction_) problem_.AddResidualBlock(new CorrectionCost(*correction_), nullptr, coordinates.data());
  for (std::size_t i = 0; i < state.active.size(); ++i) {
    const CatalogEntry& entry = catalog[state.active[i]];
    const int index = static_cast<int>(i);
    problem_.SetParameterLowerBound(coordinates.data(), index,
                                    entry.CoordinateFromValue(entry.solve_lower()));
    problem_.SetParameterUpperBound(coordinates.data(), index,
                                    entry.CoordinateFromValue(entry.solve_upper()));
  }
}

std::optional<double> FitProblem::ExpectedFall(const std::vector<double>& coordinates,
                                               const std::vector<int>& held) const {
  const auto n = static_cast<Eigen::Index>(coordinates.size());
  CostSlopes slopes{.information = Eigen::MatrixXd::Zero(n, n), .gradient = Eigen::VectorXd::Zero(n)};
  for (const FrameCost* frame : frames_) {
    if (!frame->AddSlopes(coordinates, slopes)) return std::nullopt;
  }
  if (correction_) {
    const Eigen::VectorXd moved = Eigen::Map<const Eigen::VectorXd>(coordinates.data(), n) - correction_->at;
    slopes.information += correction_->weight;
    slopes.gradient += correction_->slope + correction_->weight * moved;
  }
  std::vector<Eigen::Index> moving;
  for (Eigen::Index k = 0; k < n; ++k) {
    const CatalogEntry& entry = catalog_[state_.active[k]];
    if (entry.prior) {
      const double weight = 1.0 / (entry.prior->sigma * entry.prior->sigma);
      slopes.information(k, k) += weight;
      slopes.gradient(k) += weight * (coordinates[k] - entry.prior->coordinate);
    }
    if (std::ranges::find(held, k) == held.end()) moving.push_back(k);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(slopes.information(moving, moving).eval());
  const Eigen::VectorXd along = solver.eigenvectors().transpose() * slopes.gradient(moving);
  const double smallest = kWithoutEffect * solver.eigenvalues().maxCoeff();
  double fall = 0.0;
  for (Eigen::Index k = 0; k < along.size(); ++k) {
    if (solver.eigenvalues()(k) > smallest) fall += 0.5 * along(k) * along(k) / solver.eigenvalues()(k);
  }
  return fall;
}

BlockPixels BlockSize(const FrameModel& model, const FitOptions& options) {
  return BlockSize(model.speckle_cell(), model.range_bins(), model.beams(), options);
}

BlockPixels BlockSize(const FrameModel::SpeckleCell& cell, int range_bins, int beams,
                      const FitOptions& options) {
  constexpr double kWidths = 8.0;
  const auto along = [](int given, double width, int extent, int fewest) {
    const int wanted = static_cast<int>(std::ceil(kWidths * width - 1e-6));
    return std::max(given, std::min(wanted, extent / fewest));
  };
  BlockPixels block{.bins = along(options.block_bins, cell.bins, range_bins, 4),
                    .beams = along(options.block_beams, cell.beams, beams, 2)};
  block.variance_factor = 1.0 / ((1.0 - SharedAtEdges(cell.bins, block.bins, range_bins)) *
                                 (1.0 - SharedAtEdges(cell.beams, block.beams, beams)));
  return block;
}

double SharedAtEdges(double width, int block, int extent) {
  constexpr double kWidths = 3.0;  // beyond it, the correlation is below 4e-6
  const int inner_edges = (extent - 1) / block;
  const int farthest = std::min(block, static_cast<int>(std::ceil(kWidths * width)));
  double cut = 0.0;
  double all = 1.0;
  for (int k = 1; k <= farthest; ++k) {
    const double correlation = std::exp(-2.0 * std::numbers::ln2 * k * k / (width * width));
    cut += 2.0 * k * correlation;
    all += 2.0 * correlation;
  }
  return inner_edges * cut / (all * extent);
}

NormalEquations Accumulate(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                           const FitState& state, const FitOptions& options, ResidualSummary* residuals) {
  const int beams = model.beams();
  const BlockPixels block_size = BlockSize(model, options);
  const auto n = static_cast<Eigen::Index>(state.active.size());
  const Eigen::VectorXd value_slope = ValueSlopes(catalog, state);
  struct Band {
    std::vector<NormalEquations::Block> blocks;
    double sum = 0.0;
    double square = 0.0;
    long count = 0;
  };

  NormalEquations equations;
  equations.variance_factor = block_size.variance_factor;
  equations.information = Eigen::MatrixXd::Zero(n, n);
  equations.prior = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const CatalogEntry& entry = catalog[state.active[k]];
    if (entry.prior) equations.prior(k) = 1.0 / (entry.prior->sigma * entry.prior->sigma);
  }
  double sum = 0.0;
  std::map<int, std::vector<NormalEquations::Block>> of_pose;
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    const std::vector<int> columns = ColumnsOf(frame, catalog, state);
    const FitState of_frame = WithColumns(state, columns);
    const auto m = static_cast<Eigen::Index>(columns.size());
    const Eigen::VectorXd of_columns = value_slope(columns);
    const auto evaluation = model.At(frame, state.values, of_frame.active, FrameModel::Terms::kInformation);
    SONARCAL_CHECK(evaluation != nullptr, "the model gives no value here");
    std::vector<Band> bands((model.range_bins() + block_size.bins - 1) / block_size.bins);
    ForBands(model.range_bins(), block_size.bins, [&](int band_idx, int first, int last) {
      thread_local PixelTerms terms;
      thread_local BlockRows rows;
      terms.repeat_factor.clear();  // may be from another model
      SONARCAL_CHECK(evaluation->Bins(first, last, terms), "the model gives no value here");
      Band& band = bands[band_idx];
      for (int first_beam = 0; first_beam < beams; first_beam += block_size.beams) {
        rows.Clear();
        for (int bin = first; bin < last; ++bin) {
          for (int beam = first_beam; beam < std::min(first_beam + block_size.beams, beams); ++beam) {
            if (!model.Counts(frame, static_cast<std::size_t>(bin) * beams + beam)) continue;
            const std::size_t i = static_cast<std::size_t>(bin - first) * beams + beam;
            const double residual = terms.residual[i];
            const double whitened =
                terms.repeat_factor.empty() ? residual : residual / terms.repeat_factor[i];
            ++band.count;
            band.sum += whitened;
            band.square += whitened * whitened;
            rows.Add(terms, i, m);
          }
        }
        RowMajor information = RowMajor::Zero(m, m);
        Eigen::VectorXd score = Eigen::VectorXd::Zero(m);
        rows.AddTo(information, score);
        const Eigen::MatrixXd full = information.selfadjointView<Eigen::Lower>();
        band.blocks.push_back({.columns = columns,
                               .information = of_columns.asDiagonal() * full * of_columns.asDiagonal(),
                               .score = of_columns.cwiseProduct(score)});
      }
    });
    std::vector<NormalEquations::Block> blocks;
    for (Band& band : bands) {
      sum += band.sum;
      equations.residual_square += band.square;
      equations.residual_count += band.count;
      for (NormalEquations::Block& block : band.blocks) {
        equations.information(columns, columns) += block.information;
        blocks.push_back(std::move(block));
      }
    }
    // Frames of one pose share their speckle, and so their blocks.
    std::vector<NormalEquations::Block>& shared = of_pose[model.first_of_pose(frame)];
    if (shared.empty()) {
      shared = std::move(blocks);
      continue;
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) AddBlock(blocks[i], shared[i]);
  }
  for (auto& [frame, blocks] : of_pose) {
    for (NormalEquations::Block& block : blocks) {
      if (!block.score.isZero(0.0)) equations.blocks.push_back(std::move(block));
    }
  }
  if (residuals != nullptr) {
    const auto count = static_cast<double>(equations.residual_count);
    residuals->mean = sum / count;
    residuals->spread =
        std::sqrt(std::max(0.0, equations.residual_square / count - residuals->mean * residuals->mean));
  }
  return equations;
}

CostSlopes SlopesOfCost(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                        const FitState& state) {
  const auto n = static_cast<Eigen::Index>(state.active.size());
  CostSlopes slopes{.information = Eigen::MatrixXd::Zero(n, n), .gradient = Eigen::VectorXd::Zero(n)};
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    const std::vector<int> columns = ColumnsOf(frame, catalog, state);
    const auto sums = SumFrame(model, catalog, WithColumns(state, columns), frame, true);
    SONARCAL_CHECK(sums.has_value(), "the model gives no value here");
    slopes.information(columns, columns) += sums->information;
    slopes.gradient(columns) += sums->gradient;
    slopes.cost += 0.5 * sums->residual_square;
  }
  return slopes;
}

std::vector<Eigen::VectorXd> ScoreErrors(const FrameModel& model, const FrameModel& by_other_rays,
                                         const std::vector<CatalogEntry>& catalog, const FitState& state) {
  std::map<int, Eigen::VectorXd> of_pose;  // frames of one pose have the same rays
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    const std::vector<int> columns = ColumnsOf(frame, catalog, state);
    const FitState of_frame = WithColumns(state, columns);
    const auto sums = SumFrame(model, catalog, of_frame, frame, true);
    const auto others = SumFrame(by_other_rays, catalog, of_frame, frame, true);
    SONARCAL_CHECK(sums && others, "the model gives no value here");
    Eigen::VectorXd error = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(state.active.size()));
    error(columns) = (sums->gradient - others->gradient) / std::numbers::sqrt2;
    const auto [found, added] = of_pose.try_emplace(model.first_of_pose(frame), error);
    if (!added) found->second += error;
  }
  std::vector<Eigen::VectorXd> errors;
  for (auto& [frame, error] : of_pose) errors.push_back(std::move(error));
  return errors;
}

double CostOfFrame(const FrameModel& model, const ParameterValues& values, int frame) {
  const auto sums = SumFrame(model, model.catalog(), {.active = {}, .values = values}, frame, false);
  return sums ? 0.5 * sums->residual_square : std::numeric_limits<double>::infinity();
}

double CostAt(const FrameModel& model, const ParameterValues& values, int frames) {
  double cost = 0.0;
  for (int frame = 0; frame < frames; ++frame) cost += CostOfFrame(model, values, frame);
  return cost;
}

}  // namespace sonarcal::calib
