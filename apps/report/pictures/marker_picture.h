// A camera picture with its markers: the outline of every marker projected by the pose (blue; orange if left
// out), and from each corner the residual, measured minus projected, enlarged.
#pragma once

#include <cstdint>

#include "calib/markers/marker_poses.h"
#include "core/types/image.h"
#include "core/types/rgb_image.h"

namespace sonarcal::report {

inline constexpr double kResidualEnlarged = 200.0;

RgbImage MarkerPicture(const Grid<std::uint8_t>& grey, const calib::MarkerFramePose& frame);

}  // namespace sonarcal::report
