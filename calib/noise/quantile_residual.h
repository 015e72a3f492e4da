// Residual of a value that is only known to lie in an interval, such as a grey level or a clipped value. It
// is the standard normal quantile of its cumulative probability under a law (Dunn & Smyth, J. Comput. Graph.
// Statist. 5(3), 1996). There, the place in the interval is random; here, the mean over it has a closed form.
// For values that follow the law, the mean is 0 and the mean square is 1, for any intervals.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/SpecialFunctions>

namespace sonarcal::calib {

// Moments of the residual over its interval.
struct QuantileMoments {
  double mean = 0.0;
  double square = 0.0;
};

// A bound of the interval: the probability below it, and the probability beyond it with all its digits.
struct QuantileBound {
  double below = 0.0;
  double beyond = 1.0;
};

inline QuantileMoments QuantileResidual(const QuantileBound& lower, const QuantileBound& upper) {
  constexpr double kSmallestChance = 1e-300;  // a residual of 37
  constexpr double kPointShare = 1e-9;        // fraction of the tail; a narrower interval counts as a point
  const auto quantile = [&](const QuantileBound& bound) {
    return bound.below < 0.5 ? Eigen::numext::ndtri(std::max(bound.below, kSmallestChance))
                             : -Eigen::numext::ndtri(std::max(bound.beyond, kSmallestChance));
  };
  const auto density = [](double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi); };
  const bool low_side = lower.below < 0.5;
  const double chance = low_side ? upper.below - lower.below : lower.beyond - upper.beyond;
  const double tail = low_side ? upper.below : lower.beyond;
  const double a = quantile(lower);
  const double b = quantile(upper);
  if (!(chance > std::max(kSmallestChance, kPointShare * tail))) return {.mean = a, .square = a * a};
  return {.mean = (density(a) - density(b)) / chance,
          .square = 1.0 + (a * density(a) - b * density(b)) / chance};
}

}  // namespace sonarcal::calib
