// Comparisons of `reproduce`, one row per way to simulate. The terminal, the report and metrics.json have the
// same rows.
#pragma once

#include <string>
#include <vector>

#include "apps/reproduce/synthetic_comparison.h"
#include "apps/reproduce/target_comparison.h"

namespace sonarcal::reproduce {

struct SummaryRow {
  std::string key;   // in metrics.json
  std::string name;  // for people
  const metrics::MetricsReport* metrics = nullptr;
  bool strong = false;  // a fitted model as it is to be read
  bool muted = false;   // no simulation of a model: what to read the others beside
};

// Whether a fit has no warnings. One that has is not printed in bold.
bool IsSound(const workflow::RecordingFit& fit);

// "MODEL, fitted", and "(doubtful)" if the fit has warnings.
std::string FittedName(const std::string& model, const workflow::RecordingFit& fit);

// On the held-out frames of a synthetic case.
std::vector<SummaryRow> SyntheticRows(const SyntheticComparison& synthetic);

// On the held-out frame of a target. A fit without a usable solution has no rows.
std::vector<SummaryRow> TargetRows(const TargetComparison& target);

// {key: {"name", "iou", "ns_over_nr", "na_over_ns", "na_over_nr", "intensity_error": {"union", "overlap",
// "whole"}}} of the polar images, as JSON text.
std::string SummaryJson(const std::vector<SummaryRow>& rows);

}  // namespace sonarcal::reproduce
