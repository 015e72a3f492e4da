// Pictures of one compared frame, as PNG: recorded, simulated, overlay (as in Park 2024 Figs. 11c and 12c),
// and object regions (Fig. 13), each polar and as a fan.
//
// Polar pictures have the nearest range at the top and are stretched to a readable shape. In fans, ahead is
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

// Makes the pictures of successive frames and keeps the geometry of the fan.
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

// Returns the pictures reduced to the width of a page, so that a report of large images stays small.
FramePictures ForPage(const FramePictures& pictures);

// Writes frame_0003_polar_real.png and its seven siblings.
void WritePictures(const std::filesystem::path& folder, const FramePictures& pictures);

}  // namespace sonarcal::report
