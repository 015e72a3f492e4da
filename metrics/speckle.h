// How an image scatters about its local mean, and over how many bins and beams: its speckle.
//
//   scintillation index   S = variance / mean^2 of power; 1 for one look, 1 / L for an average of L
//   equivalent number of looks   ENL = 1 / S
//   autocorrelation width   full width at half maximum of the power's autocorrelation, along range (bins)
//                           and azimuth (beams); 1 where neighbours are independent
//
// (Goodman, Speckle Phenomena in Optics, 2nd ed., 2020, Sections 3.2 and 5; Oliver & Quegan, Understanding
// SAR Images, 2004, Section 4.3.)
//
// Power is 10^(dB / 10) where the scale states the dB of its grey levels. Where it does not, grey values
// stand for power: figures of two images of one display still compare, but S is not that of power, and ENL
// counts no looks.
//
// Measured in blocks of 16 bins x 8 beams that lie wholly in a region, each by its own mean, so that levels
// which differ between blocks do not count. With n pixels a block, the mean over blocks of s^2 / m^2 (s^2 the
// unbiased variance) is n / (n L + 1) for independent Gamma pixels, which gives L without bias. Grain of
// several pixels leaves fewer independent ones in a block: S comes out low by about the grain's area over the
// block's, and widths of a block and more have no value. A slope within a block counts as scatter. Blocks in
// which more than 2 % of the pixels are clipped (0, or full scale) are left out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

inline constexpr int kSpeckleBlockBins = 16;
inline constexpr int kSpeckleBlockBeams = 8;

// Sums over blocks of one image and region, of one frame or of several pooled. No block, no value.
struct SpeckleSums {
  std::int64_t blocks = 0;
  double relative_variance = 0.0;  // of s^2 / m^2
  std::array<double, kSpeckleBlockBins / 2> along_range =
      {};  // of the autocovariance at lags 1, 2, ... / m^2
  std::array<double, kSpeckleBlockBeams / 2> along_azimuth = {};

  std::optional<double> scintillation_index() const;
  std::optional<double> looks() const;  // none where nothing varies
  std::optional<double> range_width_bins() const;
  std::optional<double> azimuth_width_beams() const;

  SpeckleSums& operator+=(const SpeckleSums& other);
};

// Of both images, at the same pixels.
struct SpeckleMeasures {
  SpeckleSums real_background;  // of neither object region
  SpeckleSums simulated_background;
  SpeckleSums real_object;  // of both object regions
  SpeckleSums simulated_object;

  SpeckleMeasures& operator+=(const SpeckleMeasures& other);
};

// Of the pixels of `region` alone, range_bins x beam_count; a block begins every 1 / `step` of a block.
SpeckleSums MeasureSpeckleIn(const Grid<float>& value, const ImageScale& scale, const Mask& region,
                             int step = 1);

// Everything range_bins x beam_count; `valid` null: every pixel counts.
SpeckleMeasures MeasureSpeckle(const Grid<float>& real, const Grid<float>& simulated, const ImageScale& scale,
                               const Mask& real_object, const Mask& simulated_object,
                               const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
