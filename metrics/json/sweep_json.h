// The "threshold_sweep" of metrics.json:
//
//   {"method", "setting": unit of the settings, "settings": [...], "frames",
//    "counts": {"ns": [...], "nr": [...], "na": [...]},      pooled
//    "micro" | "macro": {"iou": {"curve": [...], "area", "axis_share"}, and the other ratios}}
//
// Undefined ratios and areas are null.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "metrics/threshold_sweep.h"

namespace sonarcal::metrics {

nlohmann::ordered_json SweepJson(const ThresholdSweep& sweep, SegmentationMethod method);

}  // namespace sonarcal::metrics
