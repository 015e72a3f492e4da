// A depth image (range along each ray in metres, 0 for nothing met) as files for programs and for eyes.
#pragma once

#include <cstdint>

#include "core/types/image.h"
#include "core/types/rgb_image.h"

namespace sonarcal::report {

// Whole millimetres; 0 for nothing, 65535 for that and more.
Grid<std::uint16_t> DepthInMillimetres(const Grid<float>& range_m);

// Near is bright, `farthest_m` and beyond dark; white where nothing was met.
RgbImage DepthPicture(const Grid<float>& range_m, double farthest_m);

}  // namespace sonarcal::report
