// The object regions of a pair of frames, by the rules of CompareOptions: one segmentation for both images,
// or the simulated region from its echoes; the real one anywhere, or near the simulated one; and the counts
// of a sweep over the segmentation's setting.
#pragma once

#include <vector>

#include "metrics/compare.h"

namespace sonarcal::metrics {

struct ObjectRegions {
  Segmentation real;
  Segmentation simulated;
  std::vector<Occupancy> sweep;  // at SweepSettings of the options, in their order
};

// Images of one shape; region and valid: that shape, or null. Throws DataError as Segment does.
ObjectRegions FindObjects(const PolarImage& real, const PolarImage& simulated, const CompareOptions& options,
                          const Mask* region, const Mask* valid);

}  // namespace sonarcal::metrics
