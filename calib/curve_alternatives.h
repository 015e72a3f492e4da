// Tests whether the parameters of a backscatter curve are determined separately, or only the curve.
//
// A curve is a sum of three bumps: A exp(-delta^2 / 2 B^2), E exp(-delta^2 / 2 F^2) and C cos^D(delta), which
// is close to a Gaussian of half-width 57.3 / sqrt(D) degrees. The bumps can take each other's places, and
// the likelihood then has several optima, or a valley that is bent. A standard error from the curvature at
// one optimum knows nothing of this. So the optimum is tested, one material after the other:
//
// - Exchange. The fit starts again from curves in which the bumps have exchanged places. An optimum that is
//   better is returned. One that is nearly as good has parameters of its own, and those that differ from the
//   fitted ones by more than a standard error are not determined separately.
// - Profile. Each parameter is held kProfileSigmas standard errors off, either way, and the others of the
//   material follow. Where the cost rises by less than a parabola does, the standard error widens.
//
// The order B < F makes the two Gaussians unique: every optimum is compared in this order.
//
// All this is done on neighbouring pixels taken together (FrameModel::Coarse), where there is such a model.
// Its costs are compared with its own information, and scaled to the sandwich covariance of the fit.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"

namespace sonarcal::calib {

// The optimum that is tested.
struct FittedPoint {
  const ParameterValues& values;
  const std::vector<int>& free;       // catalog entries that the fit moves
  const std::vector<int>& interior;   // those of them that are not at a bound
  const Eigen::MatrixXd& covariance;  // of the coordinates of `interior`
};

struct CurveAlternatives {
  // Optima that the coarse model finds better than the one tested, the best first: where to solve again.
  std::vector<ParameterValues> better;
  std::vector<double> widening;        // of each entry's standard error, by catalog entry: 1 or more
  std::vector<int> not_separate;       // catalog entries
  std::vector<std::string> sentences;  // about them, one a material, without a full stop
};

// `stop`: asked after each step of a solver; the search then ends by throwing FitStopped.
CurveAlternatives FindCurveAlternatives(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                                        const FittedPoint& point, const std::function<bool()>& stop = {});

// Puts the Gaussians of each curve in order, B < F, where all four values are free and the bounds allow it.
// Returns whether any were exchanged.
bool OrderGaussians(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                    ParameterValues& values);

}  // namespace sonarcal::calib
