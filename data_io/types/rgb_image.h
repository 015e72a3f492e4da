// A colour picture for people: overlays, reports. Row 0 at the top, 8 bits each of red, green and blue.
#pragma once

#include <array>
#include <cstdint>

#include "data_io/types/image.h"

namespace sonarcal {

using RgbImage = Grid<std::array<std::uint8_t, 3>>;

}  // namespace sonarcal
