// One solve of the least-squares problem of a fit.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/problem_builder.h"

namespace sonarcal::calib {

struct SolveLimits {
  double function_tolerance = 1e-8;  // fall of the cost that ends it, as a fraction of the cost
  double least_fall = 0.0;           // the same, as a difference
  int max_iterations = 100;
};

struct SolveSummary {
  bool usable = false;
  bool converged = false;  // false: the limit of iterations ended it
  double cost = 0.0;       // half the sum of squares, including priors
  int iterations = 0;
  std::string termination;
};

// Moves the active entries of `state` to the nearest optimum, unless there is no usable solution. Throws
// FitStopped if `stop` returns true.
SolveSummary SolveFit(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                      const SolveLimits& limits, const std::function<bool()>& stop, FitState& state,
                      std::optional<CostCorrection> correction = std::nullopt);

// Moves the active entries of `state` to the optimum of a cheaper model of the same entries, whose slope is
// corrected to that of `model` where it starts. Along a bent valley, one such move goes as far as many steps.
// Returns by how much the cost of `model` fell, with priors. If it did not fall, nothing moves: 0.
double MoveByCheaperModel(const FrameModel& model, const FrameModel& cheaper,
                          const std::vector<CatalogEntry>& catalog, const SolveLimits& limits,
                          const std::function<bool()>& stop, FitState& state);

}  // namespace sonarcal::calib
