// Expected recorded value of a pixel in the paper's model, and the residual of a fit.
//
// A recording holds whole grey levels between 0 and full scale. The expected recorded value of a pixel whose
// unclamped mean is x is therefore not x:
//
// - Near 0 it is rounded. A pixel of a third of a level is recorded as 0, unless it varies from frame to
//   frame. The rays of a pixel are few, so its variance is proportional to its mean and dithers the rounding.
//   Only the first levels matter, because at higher levels the rounding errors cancel over many pixels.
// - Near full scale it is clipped. With a standard deviation s of single pixels, E[min(x + s n, 1)] has a
//   soft knee.
//
// The residual is (expected recorded value - recorded value) / sigma. It has zero mean at the true parameters
// for any law of the noise, and pixels at either end of the scale cause no bias.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonarcal::calib {

struct PaperNoise {
  double sigma = 0.1;            // standard deviation of a recorded pixel from the model, full scale 1
  double knee_sigma = 0.05;      // as `sigma`, for a pixel near full scale
  double variance_levels = 0.7;  // variance / mean of a faint pixel, both in grey levels
};

struct PaperResidual {
  double residual = 0.0;
  double slope = 0.0;  // d residual / d mean
};

namespace internal {

inline double NormalDensity(double z) {
  return std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}
inline double NormalBelow(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

struct ValueAndSlope {
  double value = 0.0;
  double slope = 0.0;
};

// E[round(X)] for a mean of x >= 0, in grey levels.
inline ValueAndSlope RoundedLevels(double x, double variance_over_mean) {
  constexpr double kRoundedBelow = 4.0;  // levels; the curve meets x there
  constexpr int kSteps = 12;
  // A variance this large comes from rays of a whole level and more each. Rounding then does not matter.
  constexpr double kDithered = 0.7;
  constexpr double kUnrounded = 1.3;
  // A smaller variance gives a staircase. Rounding errors cancel beyond its first step.
  constexpr double kFirstStep = 0.12;
  constexpr double kOtherSteps = 0.3;
  if (x >= kRoundedBelow || variance_over_mean >= kUnrounded) return {x, 1.0};
  const double growth = std::min(variance_over_mean, kDithered);
  const double unrounded = std::max(0.0, (variance_over_mean - kDithered) / (kUnrounded - kDithered));
  ValueAndSlope sum;
  for (int k = 1; k <= kSteps; ++k) {
    const double least = k == 1 ? kFirstStep : kOtherSteps;
    const double s = std::sqrt(least * least + growth * x);
    const double z = (x - k + 0.5) / s;
    sum.value += NormalBelow(z);
    sum.slope += NormalDensity(z) * (1.0 / s - 0.5 * z * growth / (s * s));
  }
  return {sum.value + unrounded * (x - sum.value), sum.slope + unrounded * (1.0 - sum.slope)};
}

}  // namespace internal

// Expected recorded value of a pixel with this unclamped mean. `level`: one grey level, 0 if values are not
// rounded. All as fractions of full scale.
inline internal::ValueAndSlope ExpectedRecorded(double mean, double level, const PaperNoise& noise) {
  internal::ValueAndSlope result{mean, 1.0};
  if (level > 0.0) {
    if (mean <= 0.0) return {0.0, 0.0};
    result = internal::RoundedLevels(mean / level, noise.variance_levels);
    result.value *= level;
  } else if (mean <= 0.0) {
    return {0.0, 0.0};
  }
  const double s = noise.knee_sigma;
  const double z = (1.0 - mean) / s;
  if (z < 6.0) {
    const double above = s * internal::NormalDensity(z) - (1.0 - mean) * internal::NormalBelow(-z);
    result.value -= above;
    result.slope -= internal::NormalBelow(-z);
  }
  return result;
}

inline PaperResidual PaperPixelResidual(double mean, double recorded, double level, const PaperNoise& noise) {
  internal::ValueAndSlope expected = ExpectedRecorded(mean, level, noise);
  // A lit pixel that the model shades below black keeps an upward slope.
  if (mean < 0.0 && recorded > 0.0) expected = {mean, 1.0};
  return {(expected.value - recorded) / noise.sigma, expected.slope / noise.sigma};
}

}  // namespace sonarcal::calib
