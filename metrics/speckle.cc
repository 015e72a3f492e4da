#include "metrics/speckle.h"

#include <cmath>
#include <span>

#include "core/types/units.h"
#include "metrics/compare.h"

namespace sonarcal::metrics {
namespace {

constexpr int kBlockPixels = kSpeckleBlockBins * kSpeckleBlockBeams;
constexpr double kBlockRounding = 1e-12;  // relative variance of a block with equal pixels
constexpr double kMaxClipped = 0.02 * kBlockPixels;

Grid<double> Power(const Grid<float>& value, const ImageScale& scale) {
  const std::optional<double> span_db = DbSpan(scale);
  const double nepers = span_db.value_or(0.0) * kNeperPerDb;  // nepers of power over full scale
  Grid<double> power(value.rows(), value.cols());
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double share = static_cast<double>(value.values()[i]) / scale.full_scale;
    power.values()[i] = span_db ? std::exp(nepers * share) : share;
  }
  return power;
}

// Full width at half maximum; `sums` at lags 1, 2, ...
std::optional<double> Width(double at_zero, std::span<const double> sums) {
  if (!(at_zero > 0.0)) return std::nullopt;
  double before = 1.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double here = sums[i] / at_zero;
    if (here <= 0.5) return 2.0 * (static_cast<double>(i) + (before - 0.5) / (before - here));
    before = here;
  }
  return std::nullopt;
}

void AddBlock(const Grid<double>& power, int first_bin, int first_beam, SpeckleSums& sums) {
  double sum = 0.0;
  for (int bin = 0; bin < kSpeckleBlockBins; ++bin) {
    for (int beam = 0; beam < kSpeckleBlockBeams; ++beam) sum += power(first_bin + bin, first_beam + beam);
  }
  const double mean = sum / kBlockPixels;
  if (!(mean > 0.0)) return;
  double off[kSpeckleBlockBins][kSpeckleBlockBeams];
  double square = 0.0;
  for (int bin = 0; bin < kSpeckleBlockBins; ++bin) {
    for (int beam = 0; beam < kSpeckleBlockBeams; ++beam) {
      off[bin][beam] = power(first_bin + bin, first_beam + beam) / mean - 1.0;
      square += off[bin][beam] * off[bin][beam];
    }
  }
  const double variance = square / (kBlockPixels - 1);
  ++sums.blocks;
  if (variance < kBlockRounding) return;
  sums.relative_variance += variance;
  // Subtracting the block's own mean lowers every covariance by the variance of that mean.
  const double of_mean = variance / kBlockPixels;
  for (int lag = 1; lag <= kSpeckleBlockBins / 2; ++lag) {
    double product = 0.0;
    for (int bin = 0; bin + lag < kSpeckleBlockBins; ++bin) {
      for (int beam = 0; beam < kSpeckleBlockBeams; ++beam) product += off[bin][beam] * off[bin + lag][beam];
    }
    sums.along_range[lag - 1] += product / ((kSpeckleBlockBins - lag) * kSpeckleBlockBeams) + of_mean;
  }
  for (int lag = 1; lag <= kSpeckleBlockBeams / 2; ++lag) {
    double product = 0.0;
    for (const auto& row : off) {
      for (int beam = 0; beam + lag < kSpeckleBlockBeams; ++beam) product += row[beam] * row[beam + lag];
    }
    sums.along_azimuth[lag - 1] += product / (kSpeckleBlockBins * (kSpeckleBlockBeams - lag)) + of_mean;
  }
}

}  // namespace

std::optional<double> SpeckleSums::scintillation_index() const {
  if (blocks == 0) return std::nullopt;
  const double mean = relative_variance / static_cast<double>(blocks);
  return mean / (1.0 - mean / kBlockPixels);  // s^2 / m^2 is at most the number of pixels
}

std::optional<double> SpeckleSums::looks() const {
  if (!(relative_variance > 0.0)) return std::nullopt;
  return 1.0 / *scintillation_index();
}

std::optional<double> SpeckleSums::range_width_bins() const {
  return Width(relative_variance, along_range);
}

std::optional<double> SpeckleSums::azimuth_width_beams() const {
  return Width(relative_variance, along_azimuth);
}

SpeckleSums& SpeckleSums::operator+=(const SpeckleSums& other) {
  blocks += other.blocks;
  relative_variance += other.relative_variance;
  for (std::size_t i = 0; i < along_range.size(); ++i) along_range[i] += other.along_range[i];
  for (std::size_t i = 0; i < along_azimuth.size(); ++i) along_azimuth[i] += other.along_azimuth[i];
  return *this;
}

SpeckleMeasures& SpeckleMeasures::operator+=(const SpeckleMeasures& other) {
  real_background += other.real_background;
  simulated_background += other.simulated_background;
  real_object += other.real_object;
  simulated_object += other.simulated_object;
  return *this;
}

SpeckleSums MeasureSpeckleIn(const Grid<float>& value, const ImageScale& scale, const Mask& region,
                             int step) {
  const Grid<double> power = Power(value, scale);
  SpeckleSums sums;
  const auto usable = [&](int first_bin, int first_beam) {
    int clipped = 0;
    for (int bin = first_bin; bin < first_bin + kSpeckleBlockBins; ++bin) {
      for (int beam = first_beam; beam < first_beam + kSpeckleBlockBeams; ++beam) {
        if (region(bin, beam) == 0) return false;
        const double grey = value(bin, beam);
        clipped += grey <= 0.0 || grey >= scale.full_scale;
      }
    }
    return clipped <= kMaxClipped;
  };
  for (int bin = 0; bin + kSpeckleBlockBins <= value.rows(); bin += kSpeckleBlockBins / step) {
    for (int beam = 0; beam + kSpeckleBlockBeams <= value.cols(); beam += kSpeckleBlockBeams / step) {
      if (usable(bin, beam)) AddBlock(power, bin, beam, sums);
    }
  }
  return sums;
}

SpeckleMeasures MeasureSpeckle(const Grid<float>& real, const Grid<float>& simulated, const ImageScale& scale,
                               const Mask& real_object, const Mask& simulated_object, const Mask* valid) {
  Mask background(real.rows(), real.cols());
  Mask object(real.rows(), real.cols());
  for (std::size_t i = 0; i < background.size(); ++i) {
    if (valid != nullptr && valid->values()[i] == 0) continue;
    const bool in_real = real_object.values()[i] != 0;
    const bool in_simulated = simulated_object.values()[i] != 0;
    background.values()[i] = !in_real && !in_simulated ? 1 : 0;
    object.values()[i] = in_real && in_simulated ? 1 : 0;
  }
  constexpr int kHalfOver = 2;  // overlapping blocks, because an object has few
  return {.real_background = MeasureSpeckleIn(real, scale, background),
          .simulated_background = MeasureSpeckleIn(simulated, scale, background),
          .real_object = MeasureSpeckleIn(real, scale, object, kHalfOver),
          .simulated_object = MeasureSpeckleIn(simulated, scale, object, kHalfOver)};
}

}  // namespace sonarcal::metrics
