// A yes or no for each pixel of an image of the same shape: 1 is yes, 0 is no, and nothing else occurs.
#pragma once

#include <algorithm>
#include <cstdint>

#include "data_io/types/image.h"

namespace sonarcal {

using Mask = Grid<std::uint8_t>;

inline std::int64_t CountSet(const Mask& mask) {
  return std::count_if(mask.values().begin(), mask.values().end(), [](std::uint8_t set) { return set != 0; });
}

}  // namespace sonarcal
