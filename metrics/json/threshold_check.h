// `--fail-above NAME=VALUE`: a comparison as a check in a build or on a test bench.
//
// NAME is the path of any number in metrics.json, except those of single frames: `intensity_error.polar` and
// `macro.intensity_error.polar` are the mean over frames, `micro.iou` the pooled value, `against.worse` the
// number of headline figures that became significantly worse.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace sonarcal::metrics {

struct Threshold {
  std::string name;
  double limit = 0.0;
};

// Throws UsageError if a text is not NAME=VALUE.
std::vector<Threshold> ParseThresholds(const std::vector<std::string>& texts);

// One sentence for each threshold that is exceeded, or whose figure has no value: a figure without a value
// fails the check. Throws UsageError if metrics.json has no such figure.
std::vector<std::string> PassedThresholds(const std::vector<Threshold>& thresholds,
                                          const nlohmann::ordered_json& metrics);

}  // namespace sonarcal::metrics
