// Likelihood of a pixel's power about its mean: Gamma with L looks, censored where the display clips.
//
// With x = p / mu and eta = ln mu, the negative log-likelihood of a power p is L (eta + x) up to what does
// not depend on mu; half the squared deviance residual, with its minimum taken off,
//
//   residual = sign(1 - x) sqrt(2 L (x - 1 - ln x)),        d residual / d eta = L (1 - x) / residual.
//
// A pixel clipped at the bottom (top) of the display says only that its power was at most (at least) p. It
// contributes the probability of that (Tobit): residual = sqrt(-2 ln F(x)), or with 1 - F.
#pragma once

#include <cmath>

namespace sonarcal::calib {

enum class Censoring { kNone, kAtMost, kAtLeast };

// What was recorded in a pixel.
struct RecordedPower {
  double power = 0.0;
  Censoring censoring = Censoring::kNone;
};

struct LikelihoodTerm {
  double residual = 0.0;
  double slope = 0.0;  // d residual / d eta
};

// Limits of the ratio of a power to its mean, for a power of 0 or infinity.
inline constexpr double kMinPowerRatio = 1e-300;
inline constexpr double kMaxPowerRatio = 1e300;

// power >= 0, mean > 0, looks > 0.
LikelihoodTerm PowerLikelihood(const RecordedPower& recorded, double mean, double looks);

// Expected square of the score d (residual^2 / 2) / d eta of a pixel whose display shows powers between
// `lowest` and `highest`: L where nothing is clipped, less where something is. 0 <= lowest < highest, which
// may be infinite; mean > 0, looks > 0.
double ExpectedInformation(double lowest, double highest, double mean, double looks);

}  // namespace sonarcal::calib
