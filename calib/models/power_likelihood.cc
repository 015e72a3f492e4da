#include "calib/models/power_likelihood.h"

#include <algorithm>
#include <unsupported/Eigen/SpecialFunctions>

#include "sim/physics/speckle.h"

namespace sonarcal::calib {
namespace {

using sim::SpeckleCdf;
using sim::SpeckleDensity;
using sim::SpeckleSurvival;

constexpr double kTiny = 1e-290;

double Ratio(double power, double mean) {
  return std::min(std::max(power / mean, kMinPowerRatio), kMaxPowerRatio);
}

// Near x = 1 the root loses its digits: x - 1 - ln x = e^2 / 2 - e^3 / 3 + ..., e = x - 1.
LikelihoodTerm Interior(double x, double looks) {
  constexpr double kNear = 1e-4;
  const double e = x - 1.0;
  if (std::abs(e) < kNear)
    return {-std::sqrt(looks) * e * std::sqrt(1.0 - 2.0 / 3.0 * e), std::sqrt(looks) * (1.0 + e / 3.0)};
  const double residual = -std::copysign(std::sqrt(2.0 * looks * (e - std::log(x))), e);
  return {residual, -looks * e / residual};
}

// Term of a probability P = 1 - Q with d ln P / d eta = slope_of_log. Uses Q if it is the smaller one, so
// that nearly certain pixels keep their digits.
LikelihoodTerm Censored(double probability, double rest, double slope_of_log) {
  const double log_probability = rest < 0.5 ? std::log1p(-rest) : std::log(probability);
  const double residual = std::sqrt(-2.0 * log_probability);
  if (residual == 0.0) return {};  // a certain pixel has no information
  return {residual, -slope_of_log / residual};
}

}  // namespace

LikelihoodTerm PowerLikelihood(const RecordedPower& recorded, double mean, double looks) {
  const double x = Ratio(recorded.power, mean);
  switch (recorded.censoring) {
    case Censoring::kAtMost: {
      // A recorded power of 0 is equally unlikely for every mean.
      if (recorded.power == 0.0) return {std::sqrt(-2.0 * std::log(kTiny)), 0.0};
      // For tiny x, F(x) -> (L x)^L / Gamma(L + 1) and x f / F -> L.
      const double below = SpeckleCdf(looks, x);
      if (below < kTiny) return Censored(kTiny, 1.0, -looks);
      const double above = SpeckleSurvival(looks, x);
      return Censored(below, above, -x * SpeckleDensity(looks, x) / below);
    }
    case Censoring::kAtLeast: {
      // For large x, 1 - F -> exp(-L x) and x f / (1 - F) -> L x.
      const double above = SpeckleSurvival(looks, x);
      if (above < kTiny) {
        const double residual = std::sqrt(2.0 * looks * x);
        return {residual, -looks * x / residual};
      }
      const double below = SpeckleCdf(looks, x);
      return Censored(above, below, x * SpeckleDensity(looks, x) / above);
    }
    case Censoring::kNone:
      break;
  }
  return Interior(x, looks);
}

double ExpectedInformation(double lowest, double highest, double mean, double looks) {
  const double a = Ratio(lowest, mean);
  const double b = Ratio(highest, mean);
  // Integral of L^2 (1 - x)^2 f(x) below x, by the moments of the Gamma law.
  const auto interior_below = [&](double x) {
    using Eigen::numext::igamma;
    if (looks == 1.0) return 1.0 - (x * x + 1.0) * std::exp(-x);
    const double z = looks * x;
    return looks * looks *
           (igamma(looks, z) - 2.0 * igamma(looks + 1.0, z) + (1.0 + 1.0 / looks) * igamma(looks + 2.0, z));
  };
  // The probability of a value farther from the mean than one of residual r is at most exp(-r^2 / 2).
  constexpr double kNeverReached = 9.0;
  const double bottom = -Interior(a, looks).residual;
  const double top = -Interior(b, looks).residual;
  if (bottom > kNeverReached) return 0.0;  // all values are clipped
  double information = looks;
  if (top < kNeverReached) {
    information = interior_below(b) + std::pow(b * SpeckleDensity(looks, b), 2) / SpeckleSurvival(looks, b);
  }
  // Clipping at the bottom changes the information of a single look by about a^2 / 2.
  constexpr double kChangesNothing = 1e-4;
  if (bottom > -kNeverReached && a > kChangesNothing) {
    information += -interior_below(a) + std::pow(a * SpeckleDensity(looks, a), 2) / SpeckleCdf(looks, a);
  }
  return std::max(information, 0.0);
}

}  // namespace sonarcal::calib
