// `--fail-above NAME=VALUE`: a comparison as a gate in a build or a test bench.
//
// NAME is the path of any number in metrics.json but those of single frames: `intensity_error.polar` and
// `macro.intensity_error.polar` are the mean over frames, `micro.iou` the pooled one, `against.worse` the
// number of headline figures that got worse by more than the noise.
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

// Throws UsageError where a text is not NAME=VALUE.
std::vector<Threshold> ParseThresholds(const std::vector<std::string>& texts);

// A sentence for each threshold that is passed, or whose figure has no value: a gate that can't be judged
// does not open. Throws UsageError where metrics.json has no such figure.
std::vector<std::string> PassedThresholds(const std::vector<Threshold>& thresholds,
                                          const nlohmann::ordered_json& metrics);

}  // namespace sonarcal::metrics
