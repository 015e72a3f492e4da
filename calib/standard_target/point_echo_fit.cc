#include "calib/standard_target/point_echo_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "calib/identifiability.h"

namespace sonarcal::calib {
namespace {

constexpr double kSensitivityPriorDb = 10.0;  // keeps the mean in place; the result has mean 0
constexpr double kLeastSpreadDb = 0.005;
constexpr int kTargetRounds = 12;
constexpr double kTaperBeyond = 0.3;

// Groups of the window's beams, each once.
std::vector<int> GroupsOf(const PointEchoData& data, const EchoWindow& window) {
  std::vector<int> groups;
  if (data.group_of_beam.empty()) return groups;
  for (std::size_t i = 0; i < window.beam_azimuth_rad.size(); ++i) {
    const int group = data.group_of_beam[window.first_beam + i];
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  return groups;
}

// Residuals of a window's pixels, and of the frame's level against the spread of levels. Parameters:
// FrameEcho, PointEcho, and one sensitivity for each of GroupsOf. Derivatives are central differences; those
// by a sensitivity are known.
class WindowCost final : public ceres::CostFunction {
 public:
  WindowCost(const PointEchoData& data, const PointEchoSolution& at, std::size_t index)
      : data_(data),
        window_(data.windows[index]),
        groups_(GroupsOf(data, window_)),
        spread_db_(at.level_spread_db) {
    const FrameEcho& frame = at.frames[index];
    const std::vector<double> power =
        EchoPowerOf(window_, data.setting, at.echo, frame, SensitivityOf(data, at.group_db, window_));
    const double shape_error = data.shape_error * *std::max_element(power.begin(), power.end());
    for (const double variance : VarianceOf(window_, power, std::exp(frame.log_noise)))
      weight_.push_back(1.0 / std::sqrt(at.inflation * (variance + shape_error * shape_error)));
    set_num_residuals(static_cast<int>(weight_.size()) + 1);
    std::vector<int>& sizes = *mutable_parameter_block_sizes();
    sizes = {FrameEcho::kSize, PointEcho::kSize};
    sizes.resize(sizes.size() + groups_.size(), 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    FrameEcho frame;
    std::copy_n(parameters[0], FrameEcho::kSize, frame.data());
    PointEcho echo;
    std::copy_n(parameters[1], PointEcho::kSize, echo.data());
    if (!(frame.range_m > 0.0)) return false;
    const std::vector<double> sensitivity_db = SensitivityAt(parameters);
    const sim::AzimuthResponse<double> azimuth = AzimuthResponseOf(data_.setting, echo);
    const auto power_at = [&](const PointEcho& of_echo, const sim::AzimuthResponse<double>& of_azimuth,
                              const FrameEcho& of_frame) {
      return EchoPowerOf(window_, data_.setting, of_echo, of_azimuth, of_frame, sensitivity_db);
    };
    const std::vector<double> power = power_at(echo, azimuth, frame);
    const double noise = std::exp(frame.log_noise);
    for (std::size_t i = 0; i < power.size(); ++i) {
      residuals[i] = (window_.power[i] - power[i] - noise) * weight_[i];
    }
    residuals[power.size()] = spread_db_ > 0.0 ? frame.level_offset_db / spread_db_ : 0.0;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Differences(frame, jacobians[0], [&](const FrameEcho& at) {
        std::vector<double> mean = power_at(echo, azimuth, at);
        for (double& value : mean) value += std::exp(at.log_noise);
        return mean;
      });
      jacobians[0][power.size() * FrameEcho::kSize + 3] = spread_db_ > 0.0 ? 1.0 / spread_db_ : 0.0;
    }
    if (jacobians[1] != nullptr) {
      Differences(echo, jacobians[1], [&](const PointEcho& at) {
        const bool same_azimuth =
            at.log_azimuth_width == echo.log_azimuth_width && at.azimuth_taper == echo.azimuth_taper;
        return power_at(at, same_azimuth ? azimuth : AzimuthResponseOf(data_.setting, at), frame);
      });
    }
    for (std::size_t group = 0; group < groups_.size(); ++group) {
      if (jacobians[2 + group] == nullptr) continue;
      for (std::size_t i = 0; i < power.size(); ++i) {
        const std::size_t beam = i % window_.beam_azimuth_rad.size();
        constexpr double kLogOfOneDb = 0.1 * std::numbers::ln10;
        jacobians[2 + group][i] =
            GroupOf(beam) == groups_[group] ? -kLogOfOneDb * power[i] * weight_[i] : 0.0;
      }
      jacobians[2 + group][power.size()] = 0.0;
    }
    return true;
  }

 private:
  int GroupOf(std::size_t beam) const { return data_.group_of_beam[window_.first_beam + beam]; }

  std::vector<double> SensitivityAt(double const* const* parameters) const {
    if (groups_.empty()) return SensitivityOf(data_, {}, window_);
    std::vector<double> sensitivity_db;
    for (std::size_t beam = 0; beam < window_.beam_azimuth_rad.size(); ++beam) {
      const auto at = std::find(groups_.begin(), groups_.end(), GroupOf(beam)) - groups_.begin();
      sensitivity_db.push_back(parameters[2 + at][0]);
    }
    return sensitivity_db;
  }

  // Derivatives of the pixels' residuals by the entries of `values`; `mean_of`: mean powers.
  template <typename Values, typename Mean>
  void Differences(const Values& values, double* jacobian, const Mean& mean_of) const {
    for (int entry = 0; entry < Values::kSize; ++entry) {
      constexpr double kRelativeStep = 1e-6;
      const double step = kRelativeStep * std::max(1.0, std::abs(values.data()[entry]));
      Values below = values;
      Values above = values;
      below.data()[entry] -= step;
      above.data()[entry] += step;
      const std::vector<double> mean_below = mean_of(below);
      const std::vector<double> mean_above = mean_of(above);
      for (std::size_t i = 0; i < weight_.size(); ++i) {
        jacobian[i * Values::kSize + entry] = -weight_[i] * (mean_above[i] - mean_below[i]) / (2.0 * step);
      }
      jacobian[weight_.size() * Values::kSize + entry] = 0.0;
    }
  }

  const PointEchoData& data_;
  const EchoWindow& window_;
  std::vector<int> groups_;
  double spread_db_;
  std::vector<double> weight_;
};

std::vector<double*> BlocksOf(const PointEchoData& data, PointEchoSolution& state, std::size_t index) {
  std::vector<double*> blocks = {state.frames[index].data(), state.echo.data()};
  for (const int group : GroupsOf(data, data.windows[index])) blocks.push_back(&state.group_db[group]);
  return blocks;
}

struct PriorResidual {
  double sigma;
  template <typename T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = value[0] / sigma;
    return true;
  }
};

std::vector<int> FixedEntries(const PointEchoFree& free) {
  std::vector<int> fixed;
  if (!free.taper) fixed.push_back(2);
  if (!free.range_slope) fixed.push_back(4);
  if (!free.elevation_width) fixed.push_back(5);
  return fixed;
}

double ShortestLogPulse(const EchoWindow& window) {
  constexpr double kShareOfBin = 0.3;  // a shorter pulse falls between the bins
  return std::log(kShareOfBin * (window.bin_range_m[1] - window.bin_range_m[0]));
}

// Moves `state` to the optimum for the weights at `state`.
ceres::Solver::Summary Solve(const PointEchoData& data, const PointEchoFree& free, PointEchoSolution& state) {
  ceres::Problem problem;
  ceres::Solver::Options options;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  const PointEchoSolution at = state;
  std::vector<int> held;                                  // of a frame's values
  if (data.shape_error > 0.0) held.push_back(2);          // the noise does not show
  if (!(state.level_spread_db > 0.0)) held.push_back(3);  // without a spread of levels, its own level is 0
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    problem.AddResidualBlock(new WindowCost(data, at, i), nullptr, BlocksOf(data, state, i));
    options.linear_solver_ordering->AddElementToGroup(state.frames[i].data(), 0);
    if (!held.empty())
      problem.SetManifold(state.frames[i].data(), new ceres::SubsetManifold(FrameEcho::kSize, held));
  }
  for (double& group : state.group_db) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PriorResidual, 1, 1>(new PriorResidual{kSensitivityPriorDb}), nullptr,
        &group);
    options.linear_solver_ordering->AddElementToGroup(&group, 1);
  }
  double* echo = state.echo.data();
  options.linear_solver_ordering->AddElementToGroup(echo, 1);
  if (const std::vector<int> fixed = FixedEntries(free); !fixed.empty()) {
    problem.SetManifold(echo, new ceres::SubsetManifold(PointEcho::kSize, fixed));
  }
  // Wider than what it may be, because a bound stops steps along the valley of taper and width.
  if (free.taper) {
    problem.SetParameterLowerBound(echo, 2, -kTaperBeyond);
    problem.SetParameterUpperBound(echo, 2, 1.0 + kTaperBeyond);
  }
  problem.SetParameterLowerBound(echo, 3, ShortestLogPulse(data.windows.front()));
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // sums over several threads differ from run to run
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

// Derivatives of a window's residuals.
struct WindowSlopes {
  Eigen::VectorXd residual;
  Eigen::MatrixXd of_frame;
  Eigen::MatrixXd of_shared;  // PointEcho, then all groups
};

WindowSlopes SlopesOf(const PointEchoData& data, PointEchoSolution& state, std::size_t index) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const WindowCost cost(data, state, index);
  const int count = cost.num_residuals();
  const std::vector<int> groups = GroupsOf(data, data.windows[index]);
  std::vector<double*> blocks = BlocksOf(data, state, index);
  std::vector<RowMajor> slopes = {RowMajor(count, FrameEcho::kSize), RowMajor(count, PointEcho::kSize)};
  for (std::size_t i = 0; i < groups.size(); ++i) slopes.emplace_back(count, 1);
  std::vector<double*> targets;
  for (RowMajor& matrix : slopes) targets.push_back(matrix.data());
  WindowSlopes result;
  result.residual.resize(count);
  cost.Evaluate(blocks.data(), result.residual.data(), targets.data());
  result.of_frame = slopes[0];
  result.of_shared = Eigen::MatrixXd::Zero(count, PointEcho::kSize + data.groups);
  result.of_shared.leftCols(PointEcho::kSize) = slopes[1];
  for (std::size_t i = 0; i < groups.size(); ++i) {
    result.of_shared.col(PointEcho::kSize + groups[i]) = slopes[2 + i];
  }
  return result;
}

// Information of the shared values, with those of each frame eliminated, and the scatter of the frames'
// scores.
struct SharedInformation {
  explicit SharedInformation(Eigen::Index size)
      : information(Eigen::MatrixXd::Zero(size, size)), scatter(Eigen::MatrixXd::Zero(size, size)) {}

  // Returns the inverse information of the frame's own values. `rows`: of the residuals that count.
  Eigen::MatrixXd Add(const WindowSlopes& slopes, const std::vector<int>& entries, int own,
                      Eigen::Index rows) {
    const Eigen::MatrixXd frame = slopes.of_frame.topLeftCorner(rows, own);
    const Eigen::MatrixXd shared = slopes.of_shared.topRows(rows)(Eigen::all, entries);
    const Eigen::VectorXd residual = slopes.residual.head(rows);
    Eigen::MatrixXd inverse = (frame.transpose() * frame).inverse();
    const Eigen::MatrixXd cross = shared.transpose() * frame;
    information += shared.transpose() * shared - cross * inverse * cross.transpose();
    const Eigen::VectorXd score =
        shared.transpose() * residual - cross * (inverse * (frame.transpose() * residual));
    scatter += score * score.transpose();
    return inverse;
  }

  Eigen::MatrixXd information;
  Eigen::MatrixXd scatter;
};

// Sets what follows from the derivatives at the solution: covariance, inflation and the errors of the frames'
// levels. Returns the variances of the frames' levels, with what the spread of levels says.
std::vector<double> FindErrors(const PointEchoData& data, const PointEchoFree& free,
                               PointEchoSolution& state) {
  const int shared = PointEcho::kSize + data.groups;
  std::vector<int> fixed = FixedEntries(free);
  if (state.taper_at_bound) fixed.push_back(2);
  if (state.pulse_at_bound) fixed.push_back(3);
  std::vector<int> active;
  std::vector<int> shapes;  // values that each frame shows without regard to its level
  for (int i = 0; i < shared; ++i) {
    if (std::find(fixed.begin(), fixed.end(), i) != fixed.end()) continue;
    active.push_back(i);
    if (i >= 1 && i <= 3) shapes.push_back(i);
  }
  const auto size = static_cast<Eigen::Index>(active.size());
  const auto frames = static_cast<double>(data.windows.size());
  const double spread = state.level_spread_db;
  SharedInformation all(size);
  SharedInformation of_shape(static_cast<Eigen::Index>(shapes.size()));
  std::vector<double> own_variance;
  double squares = 0.0;
  double pixels = 0.0;
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    const WindowSlopes slopes = SlopesOf(data, state, i);
    const Eigen::Index rows = slopes.residual.size();
    const Eigen::MatrixXd inverse =
        all.Add(slopes, active, spread > 0.0 ? FrameEcho::kSize : FrameEcho::kSize - 1, rows);
    own_variance.push_back(spread > 0.0 ? inverse(3, 3) : 0.0);
    of_shape.Add(slopes, shapes, FrameEcho::kSize, rows - 1);
    squares += state.inflation * slopes.residual.head(rows - 1).squaredNorm();
    pixels += static_cast<double>(rows - 1);
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    if (active[i] >= PointEcho::kSize)
      all.information(i, i) += 1.0 / (kSensitivityPriorDb * kSensitivityPriorDb);
  }
  state.chi_square_per_pixel = squares / pixels;
  const Eigen::MatrixXd inverse = all.information.inverse();
  state.covariance = Eigen::MatrixXd::Zero(shared, shared);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) state.covariance(active[i], active[j]) = inverse(i, j);
  }
  // The mean sensitivity is counted in the level.
  if (data.groups > 0) {
    Eigen::MatrixXd change = Eigen::MatrixXd::Identity(shared, shared);
    const double share = 1.0 / data.groups;
    change.row(0).tail(data.groups).setConstant(share);
    change.bottomRightCorner(data.groups, data.groups).array() -= share;
    state.covariance = change * state.covariance * change.transpose();
  }
  // The error of the level comes from the scatter of the frames' levels about it.
  if (spread > 0.0) {
    const double widening = StudentFactor(frames - 1.0);
    state.covariance.row(0) *= widening;
    state.covariance.col(0) *= widening;
  }
  state.frame_level_sigma_db.clear();
  for (const double variance : own_variance) {
    // Without what the spread of levels says.
    constexpr double kLeastInformation = 1e-12;
    const double without =
        spread > 0.0 ? 1.0 / std::max(1.0 / variance - 1.0 / (spread * spread), kLeastInformation) : 0.0;
    state.frame_level_sigma_db.push_back(std::sqrt(without));
  }
  state.inflation = frames >= kFramesForScatter
                        ? std::max(1.0, state.inflation * frames / (frames - 1.0) *
                                            (of_shape.information.inverse() * of_shape.scatter).trace() /
                                            static_cast<double>(shapes.size()))
                        : data.cell_pixels * std::max(1.0, state.chi_square_per_pixel);
  return own_variance;
}

void CentreGroups(PointEchoSolution& state) {
  if (state.group_db.empty()) return;
  const double mean = std::accumulate(state.group_db.begin(), state.group_db.end(), 0.0) /
                      static_cast<double>(state.group_db.size());
  for (double& group : state.group_db) group -= mean;
  state.echo.level_db += mean;
}

void FindMisfit(const PointEchoData& data, PointEchoSolution& state) {
  state.misfit.clear();
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    const EchoWindow& window = data.windows[i];
    const std::vector<double> power = EchoPowerOf(window, data.setting, state.echo, state.frames[i],
                                                  SensitivityOf(data, state.group_db, window));
    const double noise = std::exp(state.frames[i].log_noise);
    const std::vector<double> variance = VarianceOf(window, power, noise);
    double left = 0.0;
    double all = 0.0;
    for (std::size_t j = 0; j < power.size(); ++j) {
      left += std::pow(window.power[j] - power[j] - noise, 2) - variance[j];
      all += power[j] * power[j];
    }
    state.misfit.push_back(std::max(0.0, left) / all);
  }
}

}  // namespace

std::vector<double> SensitivityOf(const PointEchoData& data, const std::vector<double>& group_db,
                                  const EchoWindow& window) {
  std::vector<double> sensitivity_db;
  for (std::size_t i = 0; i < window.beam_azimuth_rad.size(); ++i) {
    const std::size_t beam = window.first_beam + i;
    if (!data.group_of_beam.empty()) {
      sensitivity_db.push_back(group_db[data.group_of_beam[beam]]);
    } else {
      sensitivity_db.push_back(data.sensitivity_db.empty() ? 0.0 : data.sensitivity_db[beam]);
    }
  }
  return sensitivity_db;
}

PointEchoSolution FitPointEcho(const PointEchoData& data, const PointEchoFree& free,
                               const PointEchoSolution& start) {
  PointEchoSolution state = start;
  state.group_db.resize(data.groups, 0.0);
  if (data.windows.size() < 3) state.level_spread_db = 0.0;
  state.iterations = 0;
  for (int round = 0; round < kTargetRounds; ++round) {
    const PointEcho before = state.echo;
    const double spread_before = state.level_spread_db;
    ceres::Solver::Summary summary = Solve(data, free, state);
    state.taper_at_bound = free.taper && (state.echo.azimuth_taper <= 0.0 || state.echo.azimuth_taper >= 1.0);
    if (summary.IsSolutionUsable() && state.taper_at_bound) {
      state.echo.azimuth_taper = std::clamp(state.echo.azimuth_taper, 0.0, 1.0);
      PointEchoFree held = free;
      held.taper = false;
      summary = Solve(data, held, state);
    }
    state.usable = summary.IsSolutionUsable();
    state.termination = ceres::TerminationTypeToString(summary.termination_type);
    state.iterations += static_cast<int>(summary.iterations.size());
    if (round == 0) state.cost_initial = summary.initial_cost;
    state.cost_final = summary.final_cost;
    if (!state.usable) return state;
    CentreGroups(state);
    constexpr double kAtBound = 1e-3;
    state.pulse_at_bound = state.echo.log_pulse < ShortestLogPulse(data.windows.front()) + kAtBound;
    const double inflation_before = state.inflation;
    const std::vector<double> own_variance = FindErrors(data, free, state);
    // Expectation maximisation of the spread of the frames' levels. Their mean is fitted to the same frames,
    // which costs the offsets from it one degree of freedom.
    if (state.level_spread_db > 0.0) {
      const auto frames = static_cast<double>(state.frames.size());
      double variance = 0.0;
      for (std::size_t i = 0; i < state.frames.size(); ++i)
        variance += std::pow(state.frames[i].level_offset_db, 2) / (frames - 1.0) + own_variance[i] / frames;
      state.level_spread_db = std::max(kLeastSpreadDb, std::sqrt(variance));
    }
    constexpr double kSame = 1e-4;
    const bool same_spread = std::abs(state.level_spread_db - spread_before) <= 0.02 * spread_before;
    const bool same_inflation = std::abs(state.inflation - inflation_before) <= 0.02 * inflation_before;
    if (round > 0 && same_spread && same_inflation &&
        std::abs(state.echo.level_db - before.level_db) < kSame &&
        std::abs(state.echo.log_azimuth_width - before.log_azimuth_width) < kSame &&
        std::abs(state.echo.log_pulse - before.log_pulse) < kSame) {
      break;
    }
  }
  FindMisfit(data, state);
  return state;
}

}  // namespace sonarcal::calib
