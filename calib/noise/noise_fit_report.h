// Result of a noise fit, in the words of `fit.json` (calib/fit_report.h).
#pragma once

#include <Eigen/Core>

#include "calib/noise/noise_solver.h"

namespace sonarcal::calib {

// `covariance`: that of solution.value, in the order of its layout. A parameter that the pings do not
// determine is unidentifiable: sigma more than half the prior standard deviation, or more than 20 dB of a
// level. It keeps its value, which with the others describes the pings as well as any, and gets no sigma.
FitReport NoiseReport(const NoiseSolution& solution, const NoiseLaw& start, const Eigen::MatrixXd& covariance,
                      bool fit_span, int frames_used, const NoiseCells& cells);

}  // namespace sonarcal::calib
