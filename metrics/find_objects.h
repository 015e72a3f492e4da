// Object regions of a pair of frames, by the rules of CompareOptions. The simulated region comes from the
// segmentation or from the echoes. The real region comes from the segmentation, anywhere or near the
// simulated one. Includes the counts of a sweep over the segmentation's setting.
#pragma once

#include <vector>

#include "metrics/compare.h"

namespace sonarcal::metrics {

struct ObjectRegions {
  Segmentation real;
  Segmentation simulated;
  std::vector<Occupancy> sweep;  // in the order of SweepSettings of the options
};

// Both images have one shape; region and valid have that shape or are null. Throws DataError as Segment does.
ObjectRegions FindObjects(const PolarImage& real, const PolarImage& simulated, const CompareOptions& options,
                          const Mask* region, const Mask* valid);

}  // namespace sonarcal::metrics
