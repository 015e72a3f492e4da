// Frames with fewer pixels, for searches: the mean power of blocks of neighbouring pixels, on coarser axes. A
// search over blocks smaller than a speckle cell loses little. Blocks mix beams of different pings, so a
// frame has one pose here.
#pragma once

#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/models/coarse_frame_model.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"

namespace sonarcal::calib {

struct BlockedFrames {
  SonarModel sonar;
  ParameterSet parameters;  // values per beam are means over blocks; a beam table counts in blocks
  std::vector<AcousticFrame> frames;
};

// Throws DataError if the table of the beam pattern is invalid.
BlockedFrames InBlocks(const SonarModel& sonar, const ParameterSet& parameters,
                       const std::vector<AcousticFrame>& frames, const PixelBlock& block);

// Block of about the size of half a speckle cell, at least one pixel.
PixelBlock BlockOfHalfACell(const SonarModel& sonar, const ParameterSet& parameters);

}  // namespace sonarcal::calib
