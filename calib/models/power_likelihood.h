// Likelihood of a pixel's power about its mean: Gamma with L looks, censored at the ends of the display.
//
// With x = p / mu and eta = ln mu, the negative log-likelihood of a power p is L (eta + x), up to terms that
// do not depend on mu. Half the squared deviance residual equals it minus its minimum:
//
//   residual = sign(1 - x) sqrt(2 L (x - 1 - ln x)),        d residual / d eta = L (1 - x) / residual.
//
// For a pixel clipped at the bottom (top) of the display, it is only known that its power was at most (at
// least) p. It contributes the probability of that (Tobit): residual = sqrt(-2 ln F(x)), or with 1 - F.
#pragma once

#include <cmath>

namespace sonarcal::calib {

enum class Censoring { kNone, kAtMost, kAtLeast };

// Recorded power of a pixel.
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

// Requires power >= 0, mean > 0, looks > 0.
LikelihoodTerm PowerLikelihood(const RecordedPower& recorded, double mean, double looks);

// Expected square of the score d (residual^2 / 2) / d eta of a pixel whose display shows powers between
// `lowest` and `highest`. L without clipping, otherwise less. 0 <= lowest < highest, which may be infinite;
// mean > 0, looks > 0.
double ExpectedInformation(double lowest, double highest, double mean, double looks);

}  // namespace sonarcal::calib
