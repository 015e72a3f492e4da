#include "calib/paper/paper_likelihood.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonarcal::calib {
namespace {

double NormalDensity(double z) {
  return std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}
double NormalBelow(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

constexpr double kRoundedBelow = 4.0;  // levels; the curve meets x there

}  // namespace

ValueAndSlope RoundedLevels(double x, double variance_over_mean) {
  constexpr int kSteps = 12;
  constexpr double kDithered = 0.7;
  // A smaller variance gives a staircase. Rounding errors cancel beyond its first step.
  constexpr double kFirstStep = 0.12;
  constexpr double kOtherSteps = 0.3;
  if (x >= kRoundedBelow || variance_over_mean >= kUnroundedLevels) return {x, 1.0};
  const double growth = std::min(variance_over_mean, kDithered);
  const double unrounded = std::max(0.0, (variance_over_mean - kDithered) / (kUnroundedLevels - kDithered));
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

PaperLikelihood::PaperLikelihood(const PaperNoise& noise) : noise_(noise), per_sigma_(1.0 / noise.sigma) {
  constexpr double kStep = kRoundedBelow / kIntervals;
  const double below_end = std::nextafter(kRoundedBelow, 0.0);
  for (int i = 0; i <= kIntervals; ++i)
    rounded_[i] = RoundedLevels(std::min(i * kStep, below_end), noise.variance_levels);
}

ValueAndSlope PaperLikelihood::Interpolated(double x) const {
  constexpr double kStep = kRoundedBelow / kIntervals;
  // Without a branch: which pixels are faint cannot be predicted.
  const double within = std::min(x, kRoundedBelow);
  const int i = std::min(static_cast<int>(within / kStep), kIntervals - 1);
  const double t = within / kStep - i;
  const auto& [a, a_slope] = rounded_[i];
  const auto& [b, b_slope] = rounded_[i + 1];
  const double rise = b - a;
  const double bend_a = kStep * a_slope - rise;
  const double bend_b = rise - kStep * b_slope;
  const double bend = (1.0 - t) * bend_a + t * bend_b;
  const double value = a + t * rise + t * (1.0 - t) * bend;
  const double slope = (rise + (1.0 - 2.0 * t) * bend + t * (1.0 - t) * (bend_b - bend_a)) / kStep;
  const bool rounds = x < kRoundedBelow;
  return {rounds ? value : x, rounds ? slope : 1.0};
}

ValueAndSlope PaperLikelihood::ExpectedRecorded(double mean, double level) const {
  if (mean <= 0.0) return {0.0, 0.0};
  ValueAndSlope result{mean, 1.0};
  if (level > 0.0 && noise_.variance_levels < kUnroundedLevels) {
    result = Interpolated(mean / level);
    result.value *= level;
  }
  const double s = noise_.knee_sigma;
  if (1.0 - mean < 6.0 * s) {
    const double z = (1.0 - mean) / s;
    const double above = s * NormalDensity(z) - (1.0 - mean) * NormalBelow(-z);
    result.value -= above;
    result.slope -= NormalBelow(-z);
  }
  return result;
}

PaperResidual PaperLikelihood::Residual(double mean, double recorded, double level) const {
  ValueAndSlope expected = ExpectedRecorded(mean, level);
  // A lit pixel that the model shades below black keeps an upward slope.
  if (mean < 0.0 && recorded > 0.0) expected = {mean, 1.0};
  return {(expected.value - recorded) * per_sigma_, expected.slope * per_sigma_};
}

void PaperLikelihood::Residuals(std::span<const double> mean, std::span<const double> recorded, double level,
                                std::span<PaperResidual> residuals) const {
  for (std::size_t i = 0; i < mean.size(); ++i) residuals[i] = Residual(mean[i], recorded[i], level);
}

}  // namespace sonarcal::calib
