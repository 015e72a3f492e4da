// Builds the Ceres problem of a fit, and the sums for covariance and identifiability.
#pragma once

#include <ceres/problem.h>

#include <optional>
#include <vector>

#include "calib/fit_report.h"
#include "calib/identifiability.h"
#include "calib/models/frame_model.h"
#include "calib/parameters/fit_options.h"

namespace sonarcal::calib {

// State of one solve: the parameters that move, and the values of all.
struct FitState {
  std::vector<int> active;  // catalog entries that the solver moves
  ParameterValues values;   // every parameter

  std::vector<double> Coordinates(const std::vector<CatalogEntry>& catalog) const;
  void SetCoordinates(const std::vector<CatalogEntry>& catalog, const std::vector<double>& coordinates);
};

// Half the sum of squares of all frames, its gradient by the coordinates of the active entries, and its
// expected information; without priors.
struct CostSlopes {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double cost = 0.0;
};
CostSlopes SlopesOfCost(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                        const FitState& state);

// Adds slope . (x - at) + (x - at) . weight (x - at) / 2 to the cost at the coordinates x. The weight is
// positive definite.
struct CostCorrection {
  Eigen::VectorXd at;
  Eigen::VectorXd slope;
  Eigen::MatrixXd weight;
};

// A problem with one parameter block (`coordinates`, one value per active entry, within the bounds of the
// entries), one residual block per frame, one for the priors, and one for the correction if there is any. For
// one thread. Model, catalog (its bounds may be narrower than those of the model), state and coordinates must
// outlive it.
class FitProblem {
 public:
  FitProblem(const FrameModel& model, const std::vector<CatalogEntry>& catalog, const FitState& state,
             std::vector<double>& coordinates, std::optional<CostCorrection> correction = std::nullopt);

  ceres::Problem& problem() { return problem_; }

  // Returns by how much the cost is expected to fall from `coordinates` to its lowest point, if coordinates
  // other than `held` move: g^T H^-1 g / 2 of gradient g and expected information H, with priors. Nullopt if
  // derivatives were not evaluated there last.
  std::optional<double> ExpectedFall(const std::vector<double>& coordinates,
                                     const std::vector<int>& held) const;

 private:
  class FrameCost;

  const std::vector<CatalogEntry>& catalog_;
  const FitState& state_;
  std::optional<CostCorrection> correction_;
  ceres::Problem problem_;
  std::vector<const FrameCost*> frames_;  // they belong to the problem
};

// Size of a block that counts as nearly independent of the others: at least eight widths of pulse and beam,
// as far as a frame still has a few blocks.
struct BlockPixels {
  int bins = 1;
  int beams = 1;
  // Variance of a sum over a frame, over the variance that blocks give which count as independent. The
  // difference is the speckle that two blocks share at their edge (SharedAtEdges).
  double variance_factor = 1.0;
};
BlockPixels BlockSize(const FrameModel& model, const FitOptions& options);
BlockPixels BlockSize(const FrameModel::SpeckleCell& cell, int range_bins, int beams,
                      const FitOptions& options);

// Fraction of the variance of a sum over `extent` pixels in a row that blocks of `block` pixels miss if they
// count as independent. Speckle of a Gaussian response of this half-power width (pixels) has the correlation
// c(k) = exp(-2 ln 2 k^2 / width^2) between powers k pixels apart, so an inner edge cuts sum |k| c(k) of
// the sum c(k) that each pixel adds. For wide responses that is 0.48 width / block per edge.
double SharedAtEdges(double width, int block, int extent);

// Returns scores and expected information at a state, by the coordinates of its active entries, summed over
// blocks of pixels. Sets mean and spread in `residuals` if it is given.
NormalEquations Accumulate(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                           const FitState& state, const FitOptions& options,
                           ResidualSummary* residuals = nullptr);

// Returns numerical errors of the score, one vector per pose: its difference from the score by other rays,
// over the square root of 2. Both models have the same frames and are about one point.
std::vector<Eigen::VectorXd> ScoreErrors(const FrameModel& model, const FrameModel& by_other_rays,
                                         const std::vector<CatalogEntry>& catalog, const FitState& state);

// Half the sum of squares of a frame, without a problem and without priors; and of the first `frames` frames.
double CostOfFrame(const FrameModel& model, const ParameterValues& values, int frame);
double CostAt(const FrameModel& model, const ParameterValues& values, int frames);

}  // namespace sonarcal::calib
