// Tests whether the parameters of a backscatter curve are determined separately, or only the curve.
//
// A curve is a sum of three bumps: A exp(-delta^2 / 2 B^2), E exp(-delta^2 / 2 F^2) and C cos^D(delta), which
// is close to a Gaussian of half-width 57.3 / sqrt(D) degrees. The bumps can take each other's places. The
// likelihood then has several optima, or a bent valley, and a standard error from the curvature at one
// optimum is too small. So the optimum is tested, one material after the other:
//
// - Exchange. The fit starts again from curves with exchanged bumps. A better optimum is returned. One that
//   is nearly as good has other parameters. Those that differ from the fitted ones by more than a standard
//   error are not determined separately.
// - Profile. Each parameter is fixed kProfileSigmas standard errors away, on either side, and the others of
//   the material are fitted. If the cost rises by less than a parabola, the standard error is widened.
//
// The order B < F makes the two Gaussians unique: every optimum is compared in this order.
//
// The tests use blocks of pixels (FrameModel::Coarse) if the model has them. Costs are compared with the
// information of the same blocks, and scaled to the sandwich covariance of the fit.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"

namespace sonarcal::calib {

// Min gain of a better optimum, per pixel of a speckle cell. Rays at edges change the cost of a frame by more
// than a smaller gain.
inline constexpr double kBetterCurveNats = 0.25;

// Optimum to test.
struct FittedPoint {
  const ParameterValues& values;
  const std::vector<int>& free;       // catalog entries that the fit moves
  const std::vector<int>& interior;   // those of `free` that are not at a bound
  const Eigen::MatrixXd& covariance;  // of the coordinates of `interior`
};

struct CurveAlternatives {
  // Optima that the coarse model prefers to the tested one, best first. The caller solves again from them.
  std::vector<ParameterValues> better;
  std::vector<double> widening;        // factor on the standard error, per catalog entry: 1 or more
  std::vector<int> not_separate;       // catalog entries
  std::vector<std::string> sentences;  // one per material, without a full stop, for `not_separate`
};

// `stop` is called after each step of a solver. If it returns true, the search throws FitStopped.
CurveAlternatives FindCurveAlternatives(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                                        const FittedPoint& point, const std::function<bool()>& stop = {});

// Puts the Gaussians of each curve in the order B < F, if all four values are free and the bounds allow it.
// Returns true if any were exchanged.
bool OrderGaussians(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                    ParameterValues& values);

}  // namespace sonarcal::calib
