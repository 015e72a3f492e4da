// From a model and parameters to a Ceres problem, and to the sums that covariance and identifiability need.
#pragma once

#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "calib/fit_report.h"
#include "calib/identifiability.h"
#include "calib/models/frame_model.h"
#include "calib/parameters/fit_options.h"

namespace sonarcal::calib {

// One solve: which parameters move, and all others at their values.
struct FitState {
  std::vector<int> active;  // entries of the catalog that the solver moves
  ParameterValues values;   // every parameter

  std::vector<double> Coordinates(const std::vector<CatalogEntry>& catalog) const;
  void SetCoordinates(const std::vector<CatalogEntry>& catalog, const std::vector<double>& coordinates);
};

// One parameter block (`coordinates`, one value an active entry, kept within the entries' bounds), one
// residual block a frame and one for the priors. For one thread. Model, catalog (its bounds may be narrower
// than the model's own), state and coordinates must outlive the problem.
std::unique_ptr<ceres::Problem> BuildProblem(const FrameModel& model,
                                             const std::vector<CatalogEntry>& catalog, const FitState& state,
                                             std::vector<double>& coordinates);

// Pixels of a block that counts as independent of the others. What speckle shares across a block's edge is
// lost to a sandwich: of a Gaussian response of width w, a share 0.48 w / n of the variance where blocks are
// n long. So they are at least eight widths long, as far as that leaves a few blocks in a frame.
struct BlockPixels {
  int bins = 1;
  int beams = 1;
};
BlockPixels BlockSize(const FrameModel& model, const FitOptions& options);

// Scores and expected information at a state, with respect to the coordinates of its active entries, summed
// over blocks of pixels. `residuals` (where given) receives their mean and spread.
NormalEquations Accumulate(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                           const FitState& state, const FitOptions& options,
                           ResidualSummary* residuals = nullptr);

// Half the sum of squares over the first `frames` frames, without a problem and without priors.
double CostAt(const FrameModel& model, const ParameterValues& values, int frames);

}  // namespace sonarcal::calib
