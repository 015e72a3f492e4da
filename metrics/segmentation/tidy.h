// Post-processing of the pixels above a threshold (metrics/segmentation/segmentation.h, step 3).
#pragma once

#include "core/types/mask.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

// Opens, closes, removes and fills as the options say. The result contains only pixels where `may_be_object`
// is set (same shape).
void Tidy(Mask& object, const Mask& may_be_object, const SegmentationOptions& options);

}  // namespace sonarcal::metrics
