// Files of the pictures of one compared frame: recorded, simulated, overlay (as in Park 2024 Figs. 11c and
// 12c), and object regions (Fig. 13), each polar and as a fan.
//
// Polar pictures have the nearest range at the top and are stretched to a readable shape. In fans, ahead is
// up.
#pragma once

#include <filesystem>

#include "core/types/image.h"
#include "metrics/compare.h"

namespace sonarcal::report {

// Writes frame_0003_polar_real.png and its seven siblings. `metrics.masks` must be set.
void WritePictures(const std::filesystem::path& folder, const PolarImage& real, const PolarImage& simulated,
                   const metrics::FrameMetrics& metrics);

}  // namespace sonarcal::report
