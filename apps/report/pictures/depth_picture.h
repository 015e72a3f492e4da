// A depth image (range along each ray in metres, 0 if nothing was hit) as files for programs and for display.
#pragma once

#include <cstdint>

#include "core/types/image.h"
#include "core/types/rgb_image.h"

namespace sonarcal::report {

// Returns whole millimetres; 0 if nothing was hit, 65535 for that range and more.
Grid<std::uint16_t> DepthInMillimetres(const Grid<float>& range_m);

// Near is bright, `farthest_m` and beyond dark; white if nothing was hit.
RgbImage DepthPicture(const Grid<float>& range_m, double farthest_m);

}  // namespace sonarcal::report
