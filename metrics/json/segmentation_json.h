// The "segmentation" of metrics.json: {"method", "parameters": {the parameters of the method, and the
// tidying}}.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

nlohmann::ordered_json SegmentationJson(const SegmentationOptions& options);

}  // namespace sonarcal::metrics
