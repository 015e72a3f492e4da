// Separate parts of metrics.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "metrics/json/against.h"
#include "metrics/measures/residuals.h"

namespace sonarcal::metrics {

nlohmann::ordered_json AgainstJson(const Against& against);

// Null if no frame was added.
nlohmann::ordered_json ResidualsJson(const ResidualCollector& residuals,
                                     const std::vector<ResidualTable>& by_scene);

}  // namespace sonarcal::metrics
