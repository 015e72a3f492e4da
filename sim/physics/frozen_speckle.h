// Power of a pixel whose echo stands still while receiver noise is fresh in every ping.
//
// Of L looks with echo amplitudes s_l and circular Gaussian noise n_l of mean power N, the pixel's power
// z = mean |s_l + n_l|^2 has, given the echo's power q = mean |s_l|^2, mean q + N and variance
// (N^2 + 2 N q) / L. 2 L z / N is noncentral chi-square of 2 L degrees of freedom about 2 L q / N, which is
// a Poisson mixture of Gamma laws:
//
//   P(z <= x N) = sum over j of Poisson(j; L q / N) P(L + j, L x),     P the regularised incomplete Gamma.
//
// At q = 0 it is the Gamma law of speckle.h. For L that is no whole number it interpolates.
#pragma once

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

namespace sonarcal::sim {

// P(z <= ratio N) where the echo's power is echo_to_noise >= 0 times N; 0 at or below 0. looks > 0. Within
// 1e-12.
inline double FrozenPowerCdf(double looks, double echo_to_noise, double ratio) {
  if (!(ratio > 0.0)) return 0.0;
  const double a = looks * echo_to_noise;
  const double y = looks * ratio;
  // Amplitudes spread by 1 / sqrt(2) about their middle; eight such spreads away all is said.
  const double distance = std::sqrt(y) - std::sqrt(a + looks);
  constexpr double kFar = 8.0;
  if (distance > kFar) return 1.0;
  if (distance < -kFar) return 0.0;
  if (!(a > 0.0)) return Eigen::numext::igamma(looks, y);

  // From the largest Poisson term outwards; P(s + 1, y) = P(s, y) - y^s exp(-y) / Gamma(s + 1).
  const double middle = std::floor(a);
  const double weight = std::exp(-a + middle * std::log(a) - std::lgamma(middle + 1.0));
  const double below = Eigen::numext::igamma(looks + middle, y);
  const double step = std::exp((looks + middle) * std::log(y) - y - std::lgamma(looks + middle + 1.0));
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
