#include "calib/noise/noise_histogram.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/imaging/saturation.h"

namespace sonarcal::calib {
namespace {

// Converts a dense count. Leaves out levels that do not occur.
NoiseCounts Sparse(const std::vector<int>& dense, int cells, int levels) {
  NoiseCounts counts(cells);
  for (int cell = 0; cell < cells; ++cell) {
    const int* of_cell = &dense[static_cast<std::size_t>(cell) * levels];
    for (int level = 0; level < levels; ++level) {
      if (of_cell[level] > 0) counts[cell].push_back({level, of_cell[level]});
    }
  }
  return counts;
}

}  // namespace

int NoiseCells::EndOfBand(int band) const {
  return std::min(first_bin + (band + 1) * band_bins, last_bin);
}

double NoiseCells::RangeM(int band) const {
  const int first = first_bin + band * band_bins;
  return axes.range_min_m + 0.5 * (first + EndOfBand(band)) * axes.range_bin_m();
}

NoiseCounts CountGrey(const PolarImage& image, const NoiseCells& cells) {
  if (image.scale.quantity != Quantity::kGrey || image.scale.full_scale != cells.full_scale) {
    throw DataError(
        "a noise law is fitted to grey images of one full scale; one is {} of {}, expected grey of {}",
        ToString(image.scale.quantity), image.scale.full_scale, cells.full_scale);
  }
  std::string why;
  if (!image.axes.Matches(cells.axes, &why)) {
    throw DataError("a noise law is fitted to pings of one geometry: {}", why);
  }
  const int levels = cells.full_scale + 1;
  std::vector<int> dense(static_cast<std::size_t>(cells.count()) * levels);
  const std::vector<AzimuthStreak> streaks = FindAzimuthStreaks(image, cells.valid ? &*cells.valid : nullptr);
  const auto is_streak = [&](int bin) {
    return std::ranges::any_of(
        streaks, [bin](const AzimuthStreak& of) { return bin >= of.first_bin && bin < of.end_bin; });
  };
  for (int bin = cells.first_bin; bin < cells.last_bin; ++bin) {
    if (is_streak(bin)) continue;
    const int band = (bin - cells.first_bin) / cells.band_bins;
    for (int beam = 0; beam < cells.beams(); ++beam) {
      if (cells.valid && (*cells.valid)(bin, beam) == 0) continue;
      const double value = std::round(std::clamp<double>(image.value(bin, beam), 0.0, cells.full_scale));
      ++dense[static_cast<std::size_t>(band * cells.beams() + beam) * levels + static_cast<int>(value)];
    }
  }
  return Sparse(dense, cells.count(), levels);
}

NoiseCounts AddCounts(std::span<const NoiseCounts> pings, const NoiseCells& cells) {
  const int levels = cells.full_scale + 1;
  std::vector<int> dense(static_cast<std::size_t>(cells.count()) * levels);
  for (const NoiseCounts& ping : pings) {
    for (int cell = 0; cell < cells.count(); ++cell) {
      for (const auto& [level, count] : ping[cell])
        dense[static_cast<std::size_t>(cell) * levels + level] += count;
    }
  }
  return Sparse(dense, cells.count(), levels);
}

}  // namespace sonarcal::calib
