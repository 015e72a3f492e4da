// Separate parts of metrics.json.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "metrics/json/against.h"
#include "metrics/measures/residuals.h"

namespace sonarcal::metrics {

// The value; null without one.
nlohmann::ordered_json Nullable(const std::optional<double>& value);

nlohmann::ordered_json AgainstJson(const Against& against);

// Null if no frame was added.
nlohmann::ordered_json ResidualsJson(const ResidualCollector& residuals,
                                     const std::vector<ResidualTable>& by_scene);

}  // namespace sonarcal::metrics
