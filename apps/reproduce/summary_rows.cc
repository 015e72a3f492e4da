#include "apps/reproduce/summary_rows.h"

#include <nlohmann/json.hpp>

namespace sonarcal::reproduce {

bool IsSound(const workflow::RecordingFit& fit) {
  return fit.fit.report.warnings.empty();
}

std::string FittedName(const workflow::RecordingFit& fit) {
  return IsSound(fit) ? "paper model, fitted" : "paper model, fitted (doubtful)";
}

std::vector<SummaryRow> SyntheticRows(const SyntheticComparison& synthetic) {
  return {{"paper_initial", "paper model, its own values", &synthetic.fit.before},
          {"paper_fitted", FittedName(synthetic.fit), &synthetic.fit.after, IsSound(synthetic.fit)},
          {"acoustic_initial", "acoustic model, before its fit, expected image", &synthetic.acoustic.before},
          {"acoustic_expected", "acoustic model, fitted, expected image", &synthetic.acoustic.after, true},
          {"acoustic_sample", "acoustic model, fitted, a speckled sample", &*synthetic.acoustic.sample_after,
           true}};
}

std::vector<SummaryRow> TargetRows(const TargetComparison& target) {
  std::vector<SummaryRow> rows;
  const TargetComparison::Fitted& fitted = target.fitted;
  if (target.paper.fit.usable) {
    rows.push_back({"paper_initial", "paper model, its own values", &target.paper.before});
    rows.push_back({"paper_fitted", FittedName(target.paper), &target.paper.after, IsSound(target.paper)});
  }
  rows.push_back(
      {"acoustic_found_expected", "acoustic model of the search, expected image", &target.acoustic_expected});
  rows.push_back(
      {"acoustic_found_samples", "acoustic model of the search, speckled samples", &target.acoustic_samples});
  if (fitted.acoustic.fit.usable) {
    rows.push_back({"acoustic_expected", "acoustic model, fitted, expected image", &fitted.expected, true});
    rows.push_back({"acoustic_samples", "acoustic model, fitted, speckled samples", &fitted.samples, true});
    rows.push_back({"floor", "the expected image against its own samples", &fitted.floor, false, true});
  }
  rows.push_back({"real_against_real", "the other recorded frame", &target.real_against_real, false, true});
  return rows;
}

std::string SummaryJson(const std::vector<SummaryRow>& rows) {
  using Json = nlohmann::ordered_json;
  const auto of = [](const metrics::Statistic& s) { return s.value ? Json(*s.value) : Json(nullptr); };
  Json json = Json::object();
  for (const SummaryRow& row : rows) {
    const metrics::ViewSummary& view = row.metrics->aggregate.macro.polar;
    json[row.key] = {{"name", row.name},
                     {"iou", of(view.At("iou"))},
                     {"ns_over_nr", of(view.At("ns_over_nr"))},
                     {"na_over_ns", of(view.At("na_over_ns"))},
                     {"na_over_nr", of(view.At("na_over_nr"))},
                     {"intensity_error",
                      {{"union", of(view.Over(metrics::IntensityDomain::kUnion).mean_absolute)},
                       {"overlap", of(view.Over(metrics::IntensityDomain::kOverlap).mean_absolute)},
                       {"whole", of(view.Over(metrics::IntensityDomain::kWhole).mean_absolute)}}}};
  }
  return json.dump();
}

}  // namespace sonarcal::reproduce
