// Distribution of a pixel's power if its echo is constant while receiver noise is new in every ping.
//
// Given L looks with echo amplitudes s_l and circular Gaussian noise n_l of mean power N, the pixel's power
// is z = mean |s_l + n_l|^2. For an echo power q = mean |s_l|^2, z has mean q + N and variance (N^2 + 2 N q)
// / L. 2 L z / N has a noncentral chi-square distribution with 2 L degrees of freedom and noncentrality 2 L q
// / N, which is a Poisson mixture of Gamma distributions:
//
//   P(z <= x N) = sum over j of Poisson(j; L q / N) P(L + j, L x),     P the regularised incomplete Gamma.
//
// At q = 0 it is the Gamma distribution of speckle.h. The formula interpolates for an L that is not whole.
#pragma once

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

namespace sonarcal::sim {

// P(z <= ratio N) for an echo power of echo_to_noise >= 0 times N; 0 for ratio <= 0. looks > 0. Error below
// 1e-12.
inline double FrozenPowerCdf(double looks, double echo_to_noise, double ratio) {
  if (!(ratio > 0.0)) return 0.0;
  const double a = looks * echo_to_noise;
  const double y = looks * ratio;
  // Amplitudes have a standard deviation of 1 / sqrt(2); far beyond it the result is 0 or 1.
  const double distance = std::sqrt(y) - std::sqrt(a + looks);
  constexpr double kFar = 8.0;
  if (distance > kFar) return 1.0;
  if (distance < -kFar) return 0.0;
  if (!(a > 0.0)) return Eigen::numext::igamma(looks, y);

  // Sums from the largest Poisson term outwards; P(s + 1, y) = P(s, y) - y^s exp(-y) / Gamma(s + 1).
  const double middle = std::floor(a);
  const double weight = std::exp(-a + middle * std::log(a) - Eigen::numext::lgamma(middle + 1.0));
  const double below = Eigen::numext::igamma(looks + middle, y);
  const double step =
      std::exp((looks + middle) * std::log(y) - y - Eigen::numext::lgamma(looks + middle + 1.0));
  constexpr double kNegligible = 1e-15;
  double sum = 0.0;
  double w = weight;
  double p = below;
  double d = step;
  double above = middle;
  while (w > kNegligible && p > 0.0) {
    above += 1.0;
    sum += w * p;
    p -= d;
    d *= y / (looks + above);
    w *= a / above;
  }
  w = weight;
  p = below;
  d = step;
  double j = middle;
  while (j >= 1.0) {
    w *= j / a;
    if (w < kNegligible) break;
    d *= (looks + j) / y;
    p += d;
    sum += w * p;
    j -= 1.0;
  }
  return std::clamp(sum, 0.0, 1.0);
}

}  // namespace sonarcal::sim
