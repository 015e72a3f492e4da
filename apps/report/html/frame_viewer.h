// Frames of two polar images, one recorded and one simulated, for a reader to go through: a slider, the two
// in turn, on top of each other, their difference and their object regions, polar or as a fan, with the
// values under the pointer. Drawn in the browser (frame_viewer.js) from pictures within the page; folded away
// until it is asked for, and not there where scripts do not run and on paper.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types/image.h"

namespace sonarcal::report {

// Pictures are 8-bit grey PNG of range_bins rows x beam_count columns, nearest range first.
struct ViewerFrame {
  std::string name;
  std::string figures;  // one line about the pair, for people
  PolarAxes axes;
  double full_scale = 255.0;            // what 255 stands for
  std::vector<std::uint8_t> real;       // PNG
  std::vector<std::uint8_t> simulated;  // PNG
  std::vector<std::uint8_t> objects;  // PNG; 1: object in the real image, 2: in the simulated one, 3: in both
};

struct FrameViewer {
  std::string caption;
  std::vector<ViewerFrame> frames;
  bool real_is_synthetic = false;
};

// `number` tells the viewers of one page apart.
std::string FrameViewerHtml(const FrameViewer& viewer, int number);

}  // namespace sonarcal::report
