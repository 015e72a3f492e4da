#include "apps/reproduce/summary_rows.h"

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"

namespace sonarcal::reproduce {

bool IsSound(const workflow::RecordingFit& fit) {
  return fit.fit.report.warnings.empty();
}

std::string FittedName(const std::string& model, const workflow::RecordingFit& fit) {
  return model + (IsSound(fit) ? ", fitted" : ", fitted (doubtful)");
}

std::vector<SummaryRow> SyntheticRows(const SyntheticComparison& synthetic) {
  const std::string acoustic = FittedName("acoustic model", synthetic.acoustic);
  const bool sound = IsSound(synthetic.acoustic);
  return {{"paper_initial", "paper model, its own values", &synthetic.fit.before},
          {"paper_fitted", FittedName("paper model", synthetic.fit), &synthetic.fit.after,
           IsSound(synthetic.fit)},
          {"acoustic_initial", "acoustic model, before its fit, expected image", &synthetic.acoustic.before},
          {"acoustic_expected", acoustic + ", expected image", &synthetic.acoustic.after, sound},
          {"acoustic_sample", acoustic + ", a speckled sample", &*synthetic.acoustic.sample_after, sound}};
}

std::vector<SummaryRow> TargetRows(const TargetComparison& target) {
  std::vector<SummaryRow> rows;
  const TargetComparison::Fitted& fitted = target.fitted;
  if (target.paper.fit.usable) {
    rows.push_back({"paper_initial", "paper model, its own values", &target.paper.before});
    rows.push_back({"paper_fitted", FittedName("paper model", target.paper), &target.paper.after,
                    IsSound(target.paper)});
  }
  rows.push_back(
      {"acoustic_found_expected", "acoustic model of the search, expected image", &target.acoustic_expected});
  rows.push_back(
      {"acoustic_found_samples", "acoustic model of the search, speckled samples", &target.acoustic_samples});
  if (fitted.acoustic.fit.usable) {
    const std::string acoustic = FittedName("acoustic model", fitted.acoustic);
    const bool sound = IsSound(fitted.acoustic);
    rows.push_back({"acoustic_expected", acoustic + ", expected image", &fitted.expected, sound});
    rows.push_back({"acoustic_samples", acoustic + ", speckled samples", &fitted.samples, sound});
    rows.push_back({"floor", "the expected image against its own samples", &fitted.floor, false, true});
  }
  rows.push_back({"real_against_real", "the other " + report::RealWord(target.info.synthetic) + " frame",
                  &target.real_against_real, false, true});
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
