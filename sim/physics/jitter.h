// Range and azimuth errors of a ray (Park 2024 Section 3.4, Eqs. 25-28):
//
//   sigma(R) = sigma0 g(R) / sqrt(f / f0),   g = sqrt(1 + R^2/R0^2) (default) or 1 + R^2/R0^2
//
// The printed equations lost their roots and brackets; the growth law is therefore an option. The expected
// image under these errors is the image blurred by a Gaussian: `BlurWeight` is that blur, exactly, for echoes
// spread evenly over the interval they start in.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "data_io/types/parameters.h"
#include "data_io/types/units.h"
#include "sim/physics/gsab.h"

namespace sonarcal {

inline constexpr std::array<ParameterTraits, 3> kJitterTraits = {{
    {"sigma_range_m", "m", 0.0, 1.0},
    {"sigma_azimuth_deg", "deg", 0.0, 10.0},
    {"reference_range_m", "m", 0.1, 1000.0},
}};

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

// x Phi(x) + phi(x): the integral of the standard normal distribution from -infinity to x.
template <typename T>
T IntegratedNormalCdf(const T& x) {
  using std::erfc;
  using std::exp;
  return T(0.5) * x * erfc(x * T(-1.0 / std::numbers::sqrt2)) +
         exp(T(-0.5) * x * x) * T(0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2);
}

// Probability that a point spread evenly over [from_low, from_high] lands in [to_low, to_high] after a
// zero-mean Gaussian error of standard deviation sigma > 0. All in one unit.
template <typename T>
T BlurWeight(double from_low, double from_high, double to_low, double to_high, const T& sigma) {
  const T weight = IntegratedNormalCdf(T(to_high - from_low) / sigma) -
                   IntegratedNormalCdf(T(to_high - from_high) / sigma) -
                   IntegratedNormalCdf(T(to_low - from_low) / sigma) +
                   IntegratedNormalCdf(T(to_low - from_high) / sigma);
  return weight * sigma / T(from_high - from_low);
}

}  // namespace sonarcal
