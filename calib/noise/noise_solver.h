// Fisher scoring of a noise law of given form. calib/noise/noise_fit.cc calls it once per candidate.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/noise/noise_fit.h"

namespace sonarcal::calib {

// Index of each parameter in the vector; -1 if it is fixed or absent.
struct NoiseLayout {
  int noise_db = -1;
  int slope = -1;
  int taper = -1;  // first of one per beam
  int after_db = -1;
  int after_taper = -1;
  int log_looks = -1;
  int logit_diffuse = -1;
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
  double cost_initial = 0.0;    // -log posterior probability
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;
  bool looks_at_bound = false;
  bool diffuse_at_bound = false;
};

// Least number of looks that a fit may find: fewer than one is texture, which only the K laws have.
inline double MinNoiseLooks(sim::SpeckleLaw law) {
  return law == sim::SpeckleLaw::kK || law == sim::SpeckleLaw::kKDiffuse ? sim::kLeastTexturedLooks : 1.0;
}
// Diffuse shares that a fit may find. The K law and exponential power are the limits beyond.
inline constexpr double kMinDiffuseShare = 0.001;
inline constexpr double kMaxDiffuseShare = 0.999;
inline constexpr double kMaxNoiseLooks = 100.0;
inline constexpr double kLeastSpanDb = 5.0;
inline constexpr double kMaxSpanDb = 400.0;
inline constexpr double kMaxLevelDb = 500.0;  // max magnitude; also for tapers and the soft floor
inline constexpr double kMaxSlopeDbPerM = 1000.0;

// Levenberg-Marquardt. Ends without `converged` if no step lowers the cost at any damping, or after
// options.max_iterations. The law is then the best one found, finite and within the bounds above. `start`
// gives the form: its floors, display law and gain. `fit_span`: frees the span instead of the looks.
// FitsSoftDb decides whether soft_db is free.
NoiseSolution SolveNoise(const NoiseLaw& start, bool fit_span, const NoiseCounts& counts,
                         const NoiseCells& cells, const std::vector<double>& weight,
                         const NoiseFitOptions& options);

// Derivative of the log likelihood of `counts` alone, without priors.
Eigen::VectorXd NoiseScore(const NoiseSolution& solution, const NoiseCounts& counts, const NoiseCells& cells,
                           const std::vector<double>& weight, double absorption_db_per_m);

struct NoiseLevel {
  double level_db = 0.0;  // relative to the law
  double sigma_db = 0.0;  // of independent pixels
};

// Maximum likelihood of one factor for the noise of all cells, such as that of a ping of other level.
NoiseLevel FitNoiseLevel(const NoiseLaw& law, const NoiseCounts& counts, const NoiseCells& cells,
                         const std::vector<double>& weight, double absorption_db_per_m);

}  // namespace sonarcal::calib
