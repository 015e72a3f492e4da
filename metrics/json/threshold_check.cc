#include "metrics/json/threshold_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"

namespace sonarcal::metrics {
namespace {

// Value at a path of names and dots; null if there is none.
const nlohmann::ordered_json* Find(const nlohmann::ordered_json& metrics, std::string_view path) {
  const nlohmann::ordered_json* node = &metrics;
  for (std::size_t begin = 0; begin <= path.size() && node != nullptr;) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key(path.substr(begin, end - begin));
    node = node->contains(key) ? &(*node)[key] : nullptr;
    begin = end + 1;
  }
  return node;
}

}  // namespace

std::vector<Threshold> ParseThresholds(const std::vector<std::string>& texts) {
  std::vector<Threshold> thresholds;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    Threshold threshold;
    const std::string_view value =
        equals == std::string::npos ? std::string_view() : std::string_view(text).substr(equals + 1);
    if (equals == 0 || equals == std::string::npos || !ParseNumber(value, threshold.limit) ||
        !std::isfinite(threshold.limit)) {
      throw UsageError("--fail-above '{}', expected NAME=VALUE such as intensity_error.polar=0.1",
                       Printable(text));
    }
    threshold.name = text.substr(0, equals);
    thresholds.push_back(std::move(threshold));
  }
  return thresholds;
}

std::vector<std::string> PassedThresholds(const std::vector<Threshold>& thresholds,
                                          const nlohmann::ordered_json& metrics) {
  std::vector<std::string> sentences;
  for (const Threshold& threshold : thresholds) {
    const nlohmann::ordered_json* node = Find(metrics, "macro." + threshold.name);
    if (node == nullptr) node = Find(metrics, threshold.name);
    if (node == nullptr || !(node->is_number() || node->is_null())) {
      throw UsageError(
          "--fail-above: metrics.json has no figure '{}', expected one such as "
          "intensity_error.polar, intensity.overlap.rmse, micro.ns_over_nr or against.worse",
          Printable(threshold.name));
    }
    if (node->is_null()) {
      sentences.push_back(fmt::format("{} has no value, so it is not known to be within {:g}", threshold.name,
                                      threshold.limit));
    } else if (node->get<double>() > threshold.limit) {
      sentences.push_back(
          fmt::format("{} is {:.4g}, more than {:g}", threshold.name, node->get<double>(), threshold.limit));
    }
  }
  return sentences;
}

}  // namespace sonarcal::metrics
