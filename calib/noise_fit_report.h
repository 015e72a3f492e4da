// What a noise fit found, in the words of `fit.json` (calib/fit_report.h).
#pragma once

#include <Eigen/Core>

#include "calib/noise_solver.h"

namespace sonarcal {

// `covariance` of solution.value, in the order of its layout.
FitReport NoiseReport(const NoiseSolution& solution, const NoiseLaw& start, const Eigen::MatrixXd& covariance,
                      bool fit_span, int frames_used);

}  // namespace sonarcal
