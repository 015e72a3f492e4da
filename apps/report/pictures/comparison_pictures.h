// The pictures of one compared frame, as PNG: recorded, simulated, both on top of each other (as in Park 2024
// Figs. 11c and 12c), and the object regions (Fig. 13), each polar and as a fan.
//
// Polar pictures have the nearest range at the top and are stretched to a readable shape; fans look ahead,
// up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/imaging/fan_image.h"
#include "metrics/compare.h"

namespace sonarcal::report {

struct ViewPictures {
  std::vector<std::uint8_t> real;
  std::vector<std::uint8_t> simulated;
  std::vector<std::uint8_t> overlay;
  std::vector<std::uint8_t> regions;
};

struct FramePictures {
  int index = 0;
  std::string name;
  ViewPictures polar;
  ViewPictures fan;
};

// Makes the pictures of frame after frame and keeps the fan's geometry from one to the next.
class PictureMaker {
 public:
  explicit PictureMaker(int height_px = 480) : height_px_(height_px) {}

  // `metrics.masks` must be set.
  FramePictures Make(const PolarImage& real, const PolarImage& simulated,
                     const metrics::FrameMetrics& metrics);

 private:
  int height_px_;
  std::optional<FanMap> map_;
};

// The same no wider than a page shows them, so that a report of large images can still be handed around.
FramePictures ForPage(const FramePictures& pictures);

// Writes frame_0003_polar_real.png and its seven siblings.
void WritePictures(const std::filesystem::path& folder, const FramePictures& pictures);

}  // namespace sonarcal::report
