#include "calib/solve.h"

#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/solver.h>

#include <algorithm>

namespace sonarcal::calib {
namespace {

// Solves with an active set of bounds. Ceres moves each coordinate that leaves its bounds back to the bound.
// The step of correlated coordinates is then wrong, and convergence is slow. So coordinates at a bound are
// held if the cost falls beyond it, and freed if the cost falls inwards.
class BoundedSolve {
 public:
  BoundedSolve(ceres::Problem& problem, std::vector<double>& coordinates, const std::function<bool()>& stop)
      : problem_(problem), coordinates_(coordinates), watch_(*this, stop) {
    for (int k = 0; k < size(); ++k) {
      lower_.push_back(problem.GetParameterLowerBound(coordinates.data(), k));
      upper_.push_back(problem.GetParameterUpperBound(coordinates.data(), k));
    }
  }

  SolveSummary Run(const SolveLimits& limits) {
    SolveSummary result;
    held_ = Stopped();
    int rounds = 2 * size() + 1;
    while (true) {
      const SolveLimits left{.function_tolerance = limits.function_tolerance,
                             .max_iterations = limits.max_iterations - result.iterations};
      Solve(left, result);
      const std::vector<int> stopped = Stopped();
      const bool same = stopped == held_ && !watch_.reached_bound;
      if (!result.usable || same || result.iterations >= limits.max_iterations || --rounds == 0)
        return result;
      held_ = stopped;
    }
  }

 private:
  // Ends a solve on request, and when another coordinate reaches a bound.
  class Watch final : public ceres::IterationCallback {
   public:
    Watch(const BoundedSolve& solve, const std::function<bool()>& stop) : solve_(solve), stop_(stop) {}

    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
      if (stop_ && stop_()) return ceres::SOLVER_ABORT;
      const std::vector<int> sides = solve_.Sides();
      if (summary.iteration == 0) at_start_ = sides;
      for (std::size_t k = 0; k < sides.size(); ++k)
        reached_bound = reached_bound || (sides[k] != 0 && at_start_[k] == 0);
      return reached_bound ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
    }

    bool reached_bound = false;

   private:
    const BoundedSolve& solve_;
    const std::function<bool()>& stop_;
    std::vector<int> at_start_;
  };

  int size() const { return static_cast<int>(coordinates_.size()); }

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

  void Solve(const SolveLimits& limits, SolveSummary& result) {
    watch_.reached_bound = false;
    problem_.SetManifold(coordinates_.data(),
                         held_.empty() ? nullptr : new ceres::SubsetManifold(size(), held_));
    ceres::Solver::Options solver;
    solver.max_num_iterations = limits.max_iterations;
    solver.function_tolerance = limits.function_tolerance;
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
    result.termination = summary.message;
    if (summary.iterations.empty()) return;                                // every coordinate is held
    result.iterations += static_cast<int>(summary.iterations.size()) - 1;  // without the start
    radius_ = summary.iterations.back().trust_region_radius;
  }

  ceres::Problem& problem_;
  std::vector<double>& coordinates_;
  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<int> held_;
  Watch watch_;
  double radius_ = ceres::Solver::Options().initial_trust_region_radius;
};

}  // namespace

SolveSummary SolveFit(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                      const SolveLimits& limits, const std::function<bool()>& stop, FitState& state) {
  std::vector<double> coordinates = state.Coordinates(catalog);
  const auto problem = BuildProblem(model, catalog, state, coordinates);
  const SolveSummary result = BoundedSolve(*problem, coordinates, stop).Run(limits);
  if (stop && stop()) throw FitStopped();
  if (result.usable) state.SetCoordinates(catalog, coordinates);
  return result;
}

}  // namespace sonarcal::calib
