#include "calib/solve.h"

#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/solver.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace sonarcal::calib {
namespace {

// Solves with an active set of bounds. Ceres moves each coordinate that leaves its bounds back to the bound.
// The step of correlated coordinates is then wrong, and convergence is slow. So coordinates at a bound are
// held if the cost falls beyond it, and freed if the cost falls inwards.
class BoundedSolve {
 public:
  BoundedSolve(FitProblem& of_fit, std::vector<double>& coordinates, const SolveLimits& limits,
               const std::function<bool()>& stop)
      : of_fit_(of_fit),
        problem_(of_fit.problem()),
        coordinates_(coordinates),
        limits_(limits),
        watch_(*this, stop) {
    for (int k = 0; k < size(); ++k) {
      lower_.push_back(problem_.GetParameterLowerBound(coordinates.data(), k));
      upper_.push_back(problem_.GetParameterUpperBound(coordinates.data(), k));
    }
  }

  SolveSummary Run() {
    SolveSummary result;
    held_ = Stopped();
    int rounds = 2 * size() + 1;
    while (true) {
      Solve(result);
      const std::vector<int> stopped = Stopped();
      const bool same = stopped == held_ && !watch_.reached_bound;
      if (!result.usable || same || result.iterations >= limits_.max_iterations || --rounds == 0)
        return result;
      held_ = stopped;
    }
  }

 private:
  // Ends a solve on request, when another coordinate reaches a bound, and when the cost hardly falls or is
  // expected to fall hardly any more. Ceres alone would take one more step to see that.
  class Watch final : public ceres::IterationCallback {
   public:
    Watch(const BoundedSolve& solve, const std::function<bool()>& stop) : solve_(solve), stop_(stop) {}

    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
      if (stop_ && stop_()) return ceres::SOLVER_ABORT;
      const std::vector<int> sides = solve_.Sides();
      if (summary.iteration == 0) at_start_ = sides;
      for (std::size_t k = 0; k < sides.size(); ++k)
        reached_bound = reached_bound || (sides[k] != 0 && at_start_[k] == 0);
      converged = summary.step_is_successful && solve_.IsLow(summary);
      return reached_bound || converged ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
    }

    bool reached_bound = false;
    bool converged = false;

   private:
    const BoundedSolve& solve_;
    const std::function<bool()>& stop_;
    std::vector<int> at_start_;
  };

  int size() const { return static_cast<int>(coordinates_.size()); }

  // True if further steps would lower the cost by less than the tolerance.
  bool IsLow(const ceres::IterationSummary& after) const {
    const double tolerance = std::max(limits_.function_tolerance * after.cost, limits_.least_fall);
    if (after.iteration > 0 && after.cost_change < tolerance) return true;
    const std::optional<double> fall = of_fit_.ExpectedFall(coordinates_, held_);
    return fall && *fall < tolerance;
  }

  // Per coordinate: -1 at the lower bound, 1 at the upper one, 0 between them.
  std::vector<int> Sides() const {
    std::vector<int> sides;
    for (int k = 0; k < size(); ++k) {
      const int above = coordinates_[k] >= upper_[k] ? 1 : 0;
      sides.push_back(coordinates_[k] <= lower_[k] ? -1 : above);
    }
    return sides;
  }

  // Returns the coordinates at a bound beyond which the cost falls.
  std::vector<int> Stopped() {
    std::vector<int> stopped;
    const std::vector<int> sides = Sides();
    if (std::ranges::all_of(sides, [](int side) { return side == 0; })) return stopped;
    std::vector<double> gradient;
    problem_.SetManifold(coordinates_.data(), nullptr);
    if (!problem_.Evaluate({}, nullptr, nullptr, &gradient, nullptr)) return stopped;
    for (int k = 0; k < size(); ++k) {
      if (sides[k] * gradient[k] < 0.0) stopped.push_back(k);
    }
    return stopped;
  }

  void Solve(SolveSummary& result) {
    watch_.reached_bound = false;
    watch_.converged = false;
    problem_.SetManifold(coordinates_.data(),
                         held_.empty() ? nullptr : new ceres::SubsetManifold(size(), held_));
    ceres::Solver::Options solver;
    solver.max_num_iterations = limits_.max_iterations - result.iterations;
    solver.function_tolerance = limits_.function_tolerance;
    solver.num_threads = 1;  // threads share the pixels of a frame, not the frames
    solver.logging_type = ceres::SILENT;
    // Residual blocks are few and large; the normal equations of a few dozen unknowns are small.
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.initial_trust_region_radius = radius_;
    solver.update_state_every_iteration = true;
    solver.callbacks.push_back(&watch_);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem_, &summary);
    result.usable = summary.IsSolutionUsable();
    result.cost = summary.final_cost;
    result.converged = watch_.converged || summary.termination_type == ceres::CONVERGENCE;
    result.termination = watch_.converged
                             ? "converged: further steps would lower the cost by less than the tolerance"
                             : summary.message;
    if (summary.iterations.empty()) return;                                // every coordinate is held
    result.iterations += static_cast<int>(summary.iterations.size()) - 1;  // without the start
    radius_ = summary.iterations.back().trust_region_radius;
  }

  FitProblem& of_fit_;
  ceres::Problem& problem_;
  std::vector<double>& coordinates_;
  const SolveLimits& limits_;
  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<int> held_;
  Watch watch_;
  double radius_ = ceres::Solver::Options().initial_trust_region_radius;
};

}  // namespace

SolveSummary SolveFit(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                      const SolveLimits& limits, const std::function<bool()>& stop, FitState& state,
                      std::optional<CostCorrection> correction) {
  std::vector<double> coordinates = state.Coordinates(catalog);
  FitProblem problem(model, catalog, state, coordinates, std::move(correction));
  SolveSummary result = BoundedSolve(problem, coordinates, limits, stop).Run();
  if (stop && stop()) throw FitStopped();
  if (result.usable) state.SetCoordinates(catalog, coordinates);
  return result;
}

double MoveByCheaperModel(const FrameModel& model, const FrameModel& cheaper,
                          const std::vector<CatalogEntry>& catalog, const SolveLimits& limits,
                          const std::function<bool()>& stop, FitState& state) {
  constexpr double kDamping = 0.1;  // share of the information
  const CostSlopes right = SlopesOfCost(model, catalog, state);
  const CostSlopes cheap = SlopesOfCost(cheaper, catalog, state);
  const std::vector<double> coordinates = state.Coordinates(catalog);
  const auto n = static_cast<Eigen::Index>(coordinates.size());
  CostCorrection correction{.at = Eigen::Map<const Eigen::VectorXd>(coordinates.data(), n),
                            .slope = right.gradient - cheap.gradient,
                            .weight = kDamping * right.information};
  for (Eigen::Index k = 0; k < n; ++k) {
    const double step = catalog[state.active[k]].StepSigma();
    correction.weight(k, k) += kDamping / (step * step);
  }
  FitState moved = state;
  if (!SolveFit(cheaper, catalog, limits, stop, moved, std::move(correction)).usable) return 0.0;
  const double fall = right.cost + CostOfPriors(catalog, state.active, state.values) -
                      CostAt(model, moved.values, model.frame_count()) -
                      CostOfPriors(catalog, moved.active, moved.values);
  if (!(fall > 0.0)) return 0.0;
  state = std::move(moved);
  return fall;
}

}  // namespace sonarcal::calib
