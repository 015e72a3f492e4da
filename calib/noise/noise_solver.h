// Fisher scoring of one noise law, its form given: what calib/noise/noise_fit.cc solves once for each
// candidate.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/noise/noise_fit.h"

namespace sonarcal::calib {

// Where each parameter stands in the vector; -1: it has no place, as it is fixed or absent.
struct NoiseLayout {
  int noise_db = -1;
  int slope = -1;
  int taper = -1;  // the first of one for each beam
  int after_db = -1;
  int after_taper = -1;
  int log_looks = -1;
  int span_db = -1;
  int soft_db = -1;
  int count = 0;
  int beams = 0;
};

struct NoiseSolution {
  NoiseLaw law;
  NoiseLayout layout;
  Eigen::VectorXd value;
  Eigen::VectorXd prior_mean;
  Eigen::VectorXd prior_precision;
  Eigen::MatrixXd information;  // of pings and priors
  double cost_initial = 0.0;    // -log posterior
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;
  bool looks_at_bound = false;
};

inline constexpr double kMinNoiseLooks = 1.0;
inline constexpr double kMaxNoiseLooks = 100.0;
inline constexpr double kLeastSpanDb = 5.0;
inline constexpr double kMostSpanDb = 400.0;
inline constexpr double kMostLevelDb = 500.0;  // either side of 0; of tapers and the soft floor too
inline constexpr double kMostSlopeDbPerM = 1000.0;

// Levenberg-Marquardt. Ends without `converged` where no step that is damped ever more lowers the cost, or
// after options.max_iterations; the law is then the best that was seen, finite and within the bounds above.
// `start` tells the form: which floors it has, its display law and gain. `fit_span`: the span is free, and
// not the looks.
NoiseSolution SolveNoise(const NoiseLaw& start, bool fit_span, const NoiseCounts& counts,
                         const NoiseCells& cells, const std::vector<double>& weight,
                         const NoiseFitOptions& options);

// Derivative of the log likelihood of `counts` alone, without priors.
Eigen::VectorXd NoiseScore(const NoiseSolution& solution, const NoiseCounts& counts, const NoiseCells& cells,
                           const std::vector<double>& weight, double absorption_db_per_m);

}  // namespace sonarcal::calib
