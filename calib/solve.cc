#include "calib/solve.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <optional>

namespace sonarcal::calib {
namespace {

// Ends a solve on request.
class StopCallback final : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::function<bool()>& stop) : stop_(stop) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop_() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& stop_;
};

}  // namespace

SolveSummary SolveFit(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                      const SolveLimits& limits, const std::function<bool()>& stop, FitState& state) {
  std::vector<double> coordinates = state.Coordinates(catalog);
  const auto problem = BuildProblem(model, catalog, state, coordinates);
  ceres::Solver::Options solver;
  solver.max_num_iterations = limits.max_iterations;
  solver.function_tolerance = limits.function_tolerance;
  solver.num_threads = 1;  // threads share the pixels of a frame, not the frames
  solver.logging_type = ceres::SILENT;
  // Residual blocks are few and large; the normal equations of a few dozen unknowns are small.
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  std::optional<StopCallback> callback;
  if (stop) solver.callbacks.push_back(&callback.emplace(stop));
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem.get(), &summary);
  if (stop && stop()) throw FitStopped();
  SolveSummary result{.usable = summary.IsSolutionUsable(),
                      .cost = summary.final_cost,
                      .iterations = static_cast<int>(summary.iterations.size()),
                      .termination = summary.message};
  if (result.usable) state.SetCoordinates(catalog, coordinates);
  return result;
}

}  // namespace sonarcal::calib
