// Colour picture for display: overlays, reports. Row 0 at the top, 8 bits each of red, green and blue.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/types/image.h"

namespace sonarcal {

using RgbImage = Grid<std::array<std::uint8_t, 3>>;

// Luminance by ITU-R BT.601; equals the channels' value if all three are equal.
inline Grid<std::uint8_t> GreyOf(const RgbImage& rgb) {
  Grid<std::uint8_t> grey(rgb.rows(), rgb.cols());
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    const auto& [r, g, b] = rgb.values()[i];
    grey.values()[i] = static_cast<std::uint8_t>(std::lround(0.299 * r + 0.587 * g + 0.114 * b));
  }
  return grey;
}

}  // namespace sonarcal
