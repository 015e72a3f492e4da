// Tiny images and masks, written as they look.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::testing {

// {"..#", "##."}: '#' is object. All lines of one length.
inline Mask MaskOf(const std::vector<std::string>& lines) {
  Mask mask(static_cast<int>(lines.size()), static_cast<int>(lines.at(0).size()));
  for (int row = 0; row < mask.rows(); ++row) {
    for (int col = 0; col < mask.cols(); ++col) mask(row, col) = lines[row].at(col) == '#' ? 1 : 0;
  }
  return mask;
}

inline Grid<float> GridOf(const std::vector<std::vector<float>>& rows) {
  Grid<float> grid(static_cast<int>(rows.size()), static_cast<int>(rows.at(0).size()));
  for (int row = 0; row < grid.rows(); ++row) {
    for (int col = 0; col < grid.cols(); ++col) grid(row, col) = rows[row].at(col);
  }
  return grid;
}

inline PolarAxes SmallAxes(int range_bins, int beams) {
  PolarAxes axes{1.0, 3.0, range_bins, {}};
  for (int beam = 0; beam < beams; ++beam) axes.beam_azimuth_rad.push_back(0.02 * (beam - 0.5 * (beams - 1)));
  return axes;
}

// Grey speckle (exponential power shown over 80 dB) on a background of `level`, with a block 20 dB brighter
// at rows [30, 60), columns [10, 25).
inline PolarImage SpeckledBlock(std::uint64_t seed, double level = 20.0) {
  std::mt19937_64 random(seed);
  std::exponential_distribution<double> power;
  PolarImage image{SmallAxes(120, 40), {}, Grid<float>(120, 40)};
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 40; ++col) {
      const bool in_block = row >= 30 && row < 60 && col >= 10 && col < 25;
      const double level_db = level + (in_block ? 20.0 : 0.0) + 10.0 * std::log10(power(random));
      image.value(row, col) = static_cast<float>(std::round(std::clamp(level_db / 80.0, 0.0, 1.0) * 255.0));
    }
  }
  return image;
}

}  // namespace sonarcal::testing
