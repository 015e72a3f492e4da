// Frames of the paper's model in blocks of pixels, for the search of start values: a tenth of the work, with
// nearly all the information of the pixels on curves and display.
#pragma once

#include <vector>

#include "calib/paper/paper_frame_model.h"

namespace sonarcal::calib {

struct CoarsePaperFrames {
  sim::ImageGeometry geometry;
  std::vector<FitFrame> frames;  // recorded values are means over blocks, not rounded
};

// Makes blocks of at most `most` bins x `most` beams that divide the image evenly.
CoarsePaperFrames MakeCoarse(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                             int most = 4);

}  // namespace sonarcal::calib
