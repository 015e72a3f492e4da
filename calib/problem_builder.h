// From frames and parameters to a Ceres problem, and to the sums that covariance and identifiability need.
#pragma once

#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "calib/fit.h"
#include "calib/identifiability.h"
#include "calib/parameter_catalog.h"

namespace sonarcal {

// One solve: which parameters move, and all others at their values.
struct FitState {
  std::vector<CatalogEntry> active;  // what the solver moves
  PaperParameters<double> values;    // every parameter

  std::vector<double> Coordinates() const;
  void SetCoordinates(const std::vector<double>& coordinates);
};

// One parameter block (`coordinates`, one value an active entry, kept within the entries' bounds), one
// residual block a frame. Frames, geometry, state and coordinates must outlive the problem.
std::unique_ptr<ceres::Problem> BuildProblem(const std::vector<FitFrame>& frames,
                                             const ImageGeometry& geometry, const FitState& state,
                                             std::vector<double>& coordinates);

// Residuals and Jacobian at the problem's current coordinates, summed over blocks of pixels.
NormalEquations Accumulate(ceres::Problem& problem, const ImageGeometry& geometry,
                           const std::vector<FitFrame>& frames, const FitOptions& options,
                           ResidualSummary* raw = nullptr);

// Half the sum of squares over all frames at a state, without a problem.
double CostAt(const std::vector<FitFrame>& frames, const ImageGeometry& geometry,
              const PaperParameters<double>& parameters);

}  // namespace sonarcal
