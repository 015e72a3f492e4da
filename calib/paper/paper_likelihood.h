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

#include <array>
#include <span>

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

// E[round(X)] for a mean of x >= 0, in grey levels, and its slope. Sums probabilities of the first levels.
struct ValueAndSlope {
  double value = 0.0;
  double slope = 0.0;
};
ValueAndSlope RoundedLevels(double x, double variance_over_mean);

// Variances over means beyond this give the same residuals, in grey levels: rays of a whole level and more
// each, so that rounding does not matter.
inline constexpr double kUnroundedLevels = 1.3;

// Expected recorded values of pixels with this noise.
class PaperLikelihood {
 public:
  explicit PaperLikelihood(const PaperNoise& noise);

  const PaperNoise& noise() const { return noise_; }

  // `mean`: unclamped mean of a pixel. `level`: one grey level, 0 if values are not rounded. All as fractions
  // of full scale.
  ValueAndSlope ExpectedRecorded(double mean, double level) const;
  PaperResidual Residual(double mean, double recorded, double level) const;
  // Residuals of several pixels with values of one level.
  void Residuals(std::span<const double> mean, std::span<const double> recorded, double level,
                 std::span<PaperResidual> residuals) const;

 private:
  // RoundedLevels by cubic interpolation. The slope is that of the interpolated curve. The error is below
  // 1e-7 levels.
  ValueAndSlope Interpolated(double x) const;

  static constexpr int kIntervals = 2048;
  PaperNoise noise_;
  double per_sigma_;
  std::array<ValueAndSlope, kIntervals + 1> rounded_{};
};

}  // namespace sonarcal::calib
