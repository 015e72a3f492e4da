#include "calib/models/power_likelihood.h"

#include <algorithm>
#include <unsupported/Eigen/SpecialFunctions>

namespace sonarcal::calib {
namespace {

using Eigen::numext::igamma;
using Eigen::numext::igammac;
using Eigen::numext::lgamma;

constexpr double kTiny = 1e-290;

// Density of a Gamma law with mean 1 and L looks.
double Density(double x, double looks) {
  if (looks == 1.0) return std::exp(-x);
  return std::exp(looks * std::log(looks) - lgamma(looks) + (looks - 1.0) * std::log(x) - looks * x);
}

// Near x = 1 the root loses its digits: x - 1 - ln x = e^2 / 2 - e^3 / 3 + ..., e = x - 1.
LikelihoodTerm Interior(double x, double looks) {
  const double e = x - 1.0;
  const double root =
      std::abs(e) < 1e-4 ? std::abs(e) * std::sqrt(1.0 - 2.0 / 3.0 * e) : std::sqrt(2.0 * (e - std::log(x)));
  const double residual = std::sqrt(looks) * (e < 0.0 ? root : -root);
  const double slope = std::abs(e) < 1e-4 ? std::sqrt(looks) * (1.0 + e / 3.0) : looks * (-e) / residual;
  return {residual, slope};
}

// Term of a probability P = 1 - Q with d ln P / d eta = slope_of_log. Uses Q if it is the smaller one, so
// that nearly certain pixels keep their digits.
LikelihoodTerm Censored(double probability, double rest, double slope_of_log) {
  const double log_probability = rest < 0.5 ? std::log1p(-rest) : std::log(probability);
  const double residual = std::sqrt(-2.0 * log_probability);
  // A certain pixel has no information. Avoids 0 / 0.
  if (residual < 1e-150) return {};
  return {residual, -slope_of_log / residual};
}

}  // namespace

LikelihoodTerm PowerLikelihood(const RecordedPower& recorded, double mean, double looks) {
  const double x = std::min(std::max(recorded.power / mean, kMinPowerRatio), kMaxPowerRatio);
  switch (recorded.censoring) {
    case Censoring::kAtMost: {
      // A recorded power of 0 is equally unlikely for every mean.
      if (recorded.power == 0.0) return {std::sqrt(-2.0 * std::log(kTiny)), 0.0};
      // For tiny x, F(x) -> (L x)^L / Gamma(L + 1) and x f / F -> L.
      const double below = looks == 1.0 ? -std::expm1(-x) : igamma(looks, looks * x);
      if (below < kTiny) return Censored(kTiny, 1.0, -looks);
      const double above = looks == 1.0 ? std::exp(-x) : igammac(looks, looks * x);
      return Censored(below, above, -x * Density(x, looks) / below);
    }
    case Censoring::kAtLeast: {
      // For large x, 1 - F -> exp(-L x) and x f / (1 - F) -> L x.
      const double above = looks == 1.0 ? std::exp(-x) : igammac(looks, looks * x);
      if (above < kTiny) {
        const double residual = std::sqrt(2.0 * looks * x);
        return {residual, -looks * x / residual};
      }
      const double below = looks == 1.0 ? -std::expm1(-x) : igamma(looks, looks * x);
      return Censored(above, below, x * Density(x, looks) / above);
    }
    case Censoring::kNone:
      break;
  }
  return Interior(x, looks);
}

double ExpectedInformation(double lowest, double highest, double mean, double looks) {
  const double a = lowest / mean;
  const double b = highest / mean;
  // Integral of L^2 (1 - x)^2 f(x) below x, by the moments of the Gamma law.
  const auto interior_below = [&](double x) {
    if (looks == 1.0) return 1.0 - (x * x + 1.0) * std::exp(-x);
    const double z = looks * x;
    return looks * looks *
           (igamma(looks, z) - 2.0 * igamma(looks + 1.0, z) + (1.0 + 1.0 / looks) * igamma(looks + 2.0, z));
  };
  double information = looks;
  // The probability beyond x is at most exp(-L (x - 1 - ln x)).
  const auto is_reached = [looks](double x) { return looks * (x - 1.0 - std::log(x)) < 40.0; };
  // All values are clipped.
  if ((a > 1.0 && !is_reached(a)) || !(b > 0.0)) return 0.0;
  if (b < 1.0 || is_reached(b)) {
    const double above = looks == 1.0 ? std::exp(-b) : igammac(looks, looks * b);
    information = interior_below(b);
    if (above > 0.0) information += std::pow(b * Density(b, looks), 2) / above;
  }
  // Clipping at the bottom changes the information of a single look by about a^2 / 2.
  if (a > 1.0 || (a > 1e-4 && is_reached(a))) {
    const double below = looks == 1.0 ? -std::expm1(-a) : igamma(looks, looks * a);
    information += -interior_below(a) + std::pow(a * Density(a, looks), 2) / below;
  }
  return std::max(information, 0.0);
}

}  // namespace sonarcal::calib
