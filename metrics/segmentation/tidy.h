// What is done to the pixels above a threshold before they are called object
// (metrics/segmentation/segmentation.h, step 3).
#pragma once

#include "core/types/mask.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

// Opens, closes, drops and fills as the options say; of all this only pixels where `may_be_object` is set
// (same shape) remain.
void Tidy(Mask& object, const Mask& may_be_object, const SegmentationOptions& options);

}  // namespace sonarcal::metrics
