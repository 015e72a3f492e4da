// Interactive viewer of frame pairs, one recorded and one simulated polar image. Offers a slider, both images
// in turn, an overlay, their difference and their object regions, polar or as a fan, with the values under
// the pointer. The browser draws them (frame_viewer.js) from pictures within the page. The viewer is
// collapsed at first. It is absent on paper and without scripts.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/types/image.h"

namespace sonarcal::report {

// Pictures are 8-bit grey PNG with range_bins rows x beam_count columns, nearest range first.
struct ViewerFrame {
  std::string name;
  std::string figures;  // one line about the pair, for display
  PolarAxes axes;
  double full_scale = 255.0;            // value that 255 stands for
  std::vector<std::uint8_t> real;       // PNG
  std::vector<std::uint8_t> simulated;  // PNG
  std::vector<std::uint8_t> objects;  // PNG; 1: object in the real image, 2: in the simulated one, 3: in both
};

struct FrameViewer {
  std::string caption;
  std::vector<ViewerFrame> frames;
  bool real_is_synthetic = false;
};

// `number` distinguishes the viewers of one page. `store` puts a picture into the page and returns its id.
std::string FrameViewerHtml(const FrameViewer& viewer, int number,
                            const std::function<std::string(const std::vector<std::uint8_t>&)>& store);

}  // namespace sonarcal::report
