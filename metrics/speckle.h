// Speckle statistics of an image: its variation about the local mean, and its correlation lengths.
//
//   scintillation index          S = variance / mean^2 of power; 1 for one look, 1 / L for an average of L
//   equivalent number of looks   ENL = 1 / S
//   autocorrelation width        full width at half maximum of the power's autocorrelation, along range
//                                (bins) and azimuth (beams); 1 if neighbours are independent
//
// (Goodman, Speckle Phenomena in Optics, 2nd ed., 2020, Sections 3.2 and 5; Oliver & Quegan, Understanding
// SAR Images, 2004, Section 4.3.)
//
// Power is 10^(dB / 10) if the scale states the dB of its grey levels. Otherwise grey values are used as
// power: the figures of two images with one display can be compared, but S is not that of power, and ENL is
// not a number of looks.
//
// Measured in blocks of 16 bins x 8 beams that lie completely in a region. Each block has its own mean, so
// differences of level between blocks have no effect. With n pixels per block, the mean over blocks of s^2 /
// m^2 (s^2 the unbiased variance) is n / (n L + 1) for independent Gamma pixels, which gives L without bias.
// Limits:
//
// - Speckle cells of several pixels leave fewer independent pixels per block. S is then too low by about the
//   ratio of the cell's area to the block's, and widths of a block or more have no value.
// - A slope within a block counts as variation.
// - Blocks with more than 2 % clipped pixels (0, or full scale) are omitted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

inline constexpr int kSpeckleBlockBins = 16;
inline constexpr int kSpeckleBlockBeams = 8;

// Sums over blocks of one image and region, of one frame or of several pooled. Without a block there is no
// value.
struct SpeckleSums {
  std::int64_t blocks = 0;
  double relative_variance = 0.0;  // sum of s^2 / m^2
  std::array<double, kSpeckleBlockBins / 2> along_range =
      {};  // sum of the autocovariance at lags 1, 2, ... / m^2
  std::array<double, kSpeckleBlockBeams / 2> along_azimuth = {};

  std::optional<double> scintillation_index() const;
  std::optional<double> looks() const;  // none if nothing varies
  std::optional<double> range_width_bins() const;
  std::optional<double> azimuth_width_beams() const;

  SpeckleSums& operator+=(const SpeckleSums& other);
};

// Speckle of both images, at the same pixels.
struct SpeckleMeasures {
  SpeckleSums real_background;  // outside both object regions
  SpeckleSums simulated_background;
  SpeckleSums real_object;  // inside both object regions
  SpeckleSums simulated_object;

  SpeckleMeasures& operator+=(const SpeckleMeasures& other);
};

// Speckle of the pixels of `region`, range_bins x beam_count. Blocks are 1 / `step` of a block apart.
SpeckleSums MeasureSpeckleIn(const Grid<float>& value, const ImageScale& scale, const Mask& region,
                             int step = 1);

// All arrays are range_bins x beam_count; `valid` null: every pixel is valid.
SpeckleMeasures MeasureSpeckle(const Grid<float>& real, const Grid<float>& simulated, const ImageScale& scale,
                               const Mask& real_object, const Mask& simulated_object,
                               const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
