#include "metrics/segmentation/object_region.h"

#include <algorithm>

namespace sonarcal::metrics {

PixelBox BoxOf(const Mask& object, const ObjectMargin& margin) {
  SONARCAL_CHECK(margin.bins >= 0 && margin.beams >= 0, "margins {} and {}", margin.bins, margin.beams);
  PixelBox box{.bin_begin = object.rows(), .beam_begin = object.cols()};
  for (int bin = 0; bin < object.rows(); ++bin) {
    for (int beam = 0; beam < object.cols(); ++beam) {
      if (object(bin, beam) == 0) continue;
      box.bin_begin = std::min(box.bin_begin, bin);
      box.bin_end = bin + 1;
      box.beam_begin = std::min(box.beam_begin, beam);
      box.beam_end = std::max(box.beam_end, beam + 1);
    }
  }
  if (box.empty()) return {};
  return {.bin_begin = std::max(0, box.bin_begin - margin.bins),
          .bin_end = std::min(object.rows(), box.bin_end + margin.bins),
          .beam_begin = std::max(0, box.beam_begin - margin.beams),
          .beam_end = std::min(object.cols(), box.beam_end + margin.beams)};
}

Mask MaskOf(const PixelBox& box, int range_bins, int beams) {
  SONARCAL_CHECK(box.bin_end <= range_bins && box.beam_end <= beams,
                 "box to bin {} and beam {}, image {} x {}", box.bin_end, box.beam_end, range_bins, beams);
  Mask mask(range_bins, beams);
  for (int bin = box.bin_begin; bin < box.bin_end; ++bin) {
    for (int beam = box.beam_begin; beam < box.beam_end; ++beam) mask(bin, beam) = 1;
  }
  return mask;
}

SegmentationOptions SegmentationInBox() {
  SegmentationOptions options;
  options.method = SegmentationMethod::kOtsu;
  options.largest_component_only = false;
  return options;
}

}  // namespace sonarcal::metrics
