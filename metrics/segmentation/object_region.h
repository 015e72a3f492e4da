// Region in which the object of a frame is searched: a box around one material of the scene's model. The box
// comes from the model, not from either image. It improves every ratio, because nothing outside it can be
// detected as the object. Every report therefore states it.
#pragma once

#include <string>

#include "core/types/mask.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

// Range bins and beams of a polar image, from `begin` to before `end`; empty by default.
struct PixelBox {
  int bin_begin = 0;
  int bin_end = 0;
  int beam_begin = 0;
  int beam_end = 0;

  bool empty() const { return bin_begin >= bin_end || beam_begin >= beam_end; }
  bool operator==(const PixelBox&) const = default;
};

// Width of the box beyond the model's pixels, on each side.
struct ObjectMargin {
  int bins = 12;
  int beams = 12;
};

struct ObjectSearch {
  std::string material;  // material of the scene
  ObjectMargin margin = {};
};

// Box around the object's pixels, cut at the image's borders. Empty if the object has no pixel.
PixelBox BoxOf(const Mask& object, const ObjectMargin& margin);

// Mask that is set inside the box.
Mask MaskOf(const PixelBox& box, int range_bins, int beams);

// Default segmentation inside such a box: Otsu's threshold, all components. The floor around an object can be
// as bright as the object, so the box has no background that is known to be dark.
SegmentationOptions SegmentationInBox();

}  // namespace sonarcal::metrics
