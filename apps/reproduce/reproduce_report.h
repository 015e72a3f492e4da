// The report of `reproduce`: the synthetic case beside the published tables, the frames of real targets, and
// other recordings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"
#include "apps/reproduce/synthetic_comparison.h"
#include "apps/reproduce/target_comparison.h"

namespace sonarcal::reproduce {

// A recording that is read and shown, no more: it has no pose and no scene.
struct ShownRecording {
  std::string name;
  std::string failure;  // why it could not be read; empty where it could
  RecordingInfo info;
  int frame_count = 0;
  PolarImage first;  // frame
};

// The comparison of a target's case, or the reason for its absence.
struct TargetResult {
  std::string name;
  std::optional<TargetComparison> comparison;
  std::string absent;
};

struct Reproduction {
  SyntheticComparison synthetic;
  std::vector<TargetResult> targets;
  std::vector<ShownRecording> shown;
};

report::HtmlReport MakeReproductionReport(const Reproduction& reproduction,
                                          const nlohmann::ordered_json& provenance);

// The text of metrics.json: the held-out frames of the synthetic case after the fit of the paper's model in
// the form of `compare`, and beside it "metrics_before", "acoustic" (the same of the acoustic model, and of a
// sample), "summary" (apps/reproduce/summary_rows.h), "data_sets" with the published values, and one member
// per target, such as "bomb".
std::string ReproductionMetricsJson(const Reproduction& reproduction);

}  // namespace sonarcal::reproduce
