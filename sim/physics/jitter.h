// Range and azimuth errors of a ray (Park 2024 Section 3.4, Eqs. 25-28):
//
//   sigma(R) = sigma0 g(R) / sqrt(f / f0),   g = sqrt(1 + R^2/R0^2) (default) or 1 + R^2/R0^2
//
// The printed equations lack their roots and brackets, so the growth law is an option. The expected image
// under these errors is the image blurred by a Gaussian. `GaussianBlurWeight` is this blur, exact for echoes
// spread evenly over their interval.
#pragma once

#include <cmath>
#include <numbers>

#include "core/types/parameters.h"
#include "core/types/units.h"

namespace sonarcal::sim {

// g(R) / sqrt(f / f0).
template <typename T>
T JitterGrowthFactor(const JitterParameters<T>& jitter, double range_m, double frequency_hz) {
  using std::sqrt;
  const T growth = T(1.0) + T(range_m * range_m) / (jitter.reference_range_m * jitter.reference_range_m);
  const double frequency_factor = std::sqrt(frequency_hz / jitter.reference_frequency_hz);
  return (jitter.growth == JitterGrowth::kRoot ? T(sqrt(growth)) : growth) / T(frequency_factor);
}

template <typename T>
T JitterSigmaRangeM(const JitterParameters<T>& jitter, double range_m, double frequency_hz) {
  return jitter.sigma_range_m * JitterGrowthFactor(jitter, range_m, frequency_hz);
}

template <typename T>
T JitterSigmaAzimuthRad(const JitterParameters<T>& jitter, double range_m, double frequency_hz) {
  return RadFromDeg(jitter.sigma_azimuth_deg) * JitterGrowthFactor(jitter, range_m, frequency_hz);
}

// Probability that a point, spread evenly over one interval, lands in another after a zero-mean Gaussian
// error; and its derivative by the error's standard deviation.
struct BlurWeight {
  double value = 0.0;
  double slope = 0.0;  // d value / d sigma

  // Value for a sigma that a solver differentiates.
  template <typename T>
  T At(const T& sigma, double sigma_value) const {
    return T(value) + T(slope) * (sigma - T(sigma_value));
  }
};

// Weight from [from_low, from_high] to [to_low, to_high], all in the unit of sigma > 0. With H(x) = x Phi(x /
// sigma) + sigma phi(x / sigma), the integral of the normal distribution function,
//   weight = (H(to_high - from_low) - H(to_high - from_high) - H(to_low - from_low) + H(to_low - from_high))
//            / width
// and dH / dsigma = phi(x / sigma).
inline BlurWeight GaussianBlurWeight(double from_low, double from_high, double to_low, double to_high,
                                     double sigma) {
  BlurWeight weight;
  const auto add = [&](double sign, double x) {
    const double z = x / sigma;
    const double density = std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
    weight.value += sign * (0.5 * x * std::erfc(-z / std::numbers::sqrt2) + sigma * density);
    weight.slope += sign * density;
  };
  add(1.0, to_high - from_low);
  add(-1.0, to_high - from_high);
  add(-1.0, to_low - from_low);
  add(1.0, to_low - from_high);
  weight.value /= from_high - from_low;
  weight.slope /= from_high - from_low;
  return weight;
}

}  // namespace sonarcal::sim
