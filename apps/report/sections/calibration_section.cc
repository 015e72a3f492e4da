#include "apps/report/sections/calibration_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/report/pictures/saturation_pictures.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/fit_section.h"
#include "apps/workflow/calibration/calibration_plan.h"

namespace sonarcal::report {
namespace {

// Mean absolute difference over the whole polar image, in percent of full scale.
std::string ErrorPercent(const metrics::MetricsReport& metrics) {
  const metrics::Statistic& error =
      metrics.aggregate.macro.polar.Over(metrics::IntensityDomain::kWhole).mean_absolute;
  return error.value ? fmt::format("{:.2f} %", 100.0 * *error.value) : "an unknown share";
}

std::string AgreementSentence(const workflow::Calibration& calibration) {
  const workflow::RecordingFit& of = calibration.evaluation;
  if (!of.sample_after || !of.sample_pair) return "The agreement could not be measured.";
  return fmt::format(
      "A simulated frame differs from the frame of the recording by {} of full scale, mean over {}; two "
      "simulated frames of one pose differ by {}, which is the lowest error possible apart from chance.",
      ErrorPercent(*of.sample_after), of.judged_on_held_out ? "the held-out frames" : "the frames used",
      ErrorPercent(*of.sample_pair));
}

}  // namespace

void AddCalibration(HtmlReport& report, const workflow::Calibration& calibration, bool is_synthetic,
                    const std::string& recording) {
  std::string open = "The recording determines every value that was fitted.";
  if (!calibration.open.empty())
    open = "The recording does not determine: " + fmt::format("{}.", fmt::join(calibration.open, "; "));
  AddFitOpening(report, calibration.evaluation, {AgreementSentence(calibration), open});
  AddSyntheticCallout(report, is_synthetic, recording);
  AddFitWarnings(report, calibration.evaluation.fit.report);
  AddFitKeyFigures(report, calibration.evaluation);
  report.Section("Decisions");
  Table table{
      .caption = "Decisions, in their order",
      .columns = {{"Stage"}, {"Choice", "", false}, {"Reason", "", false}},
      .rows = {},
      .notes = {"Gains are those of the log-likelihood of the held-out frames, with standard errors."}};
  for (const workflow::CalibrationDecision& decision : calibration.plan.decided)
    table.rows.push_back({{std::string(ToString(decision.stage)), decision.choice, decision.reason}});
  report.Add(table);
  if (!calibration.fit.fit.report.ambiguities.empty()) {
    report.Section("Other explanations");
    report.Paragraph(
        "The geometry of a sonar is known relative to its scene. These errors would look the same:");
    report.List(calibration.fit.fit.report.ambiguities);
  }
  report.Section("Before and after");
  AddFitComparison(report, calibration.evaluation);
  AddUnexplained(report, calibration.evaluation);
  const workflow::RecordingFit& evaluation = calibration.evaluation;
  AddSaturation(report, evaluation.fit.report, evaluation.axes, evaluation.streaked_frames,
                evaluation.after.real_is_synthetic);
  report.Section("Fitted values");
  report.Paragraph("These values come from the last fit, to all frames used.");
  AddFittedValues(report, calibration.fit);
}

std::string CalibrationText(const workflow::Calibration& calibration) {
  std::string text = AgreementSentence(calibration) + "\n";
  for (const std::string& sentence : calibration.evaluation.fit.report.warnings)
    text += fmt::format("warning: {}\n", sentence);
  for (const workflow::CalibrationDecision& decision : calibration.plan.decided)
    text += fmt::format("  {:<10} {} ({})\n", ToString(decision.stage), decision.choice, decision.reason);
  for (const calib::FittedParameter& parameter : calibration.fit.fit.report.parameters) {
    if (!parameter.sigma ||
        !(parameter.name.starts_with("geometry.") || parameter.name.starts_with("object.")))
      continue;
    text += fmt::format("  {:<32} {:>9.4f} +- {:.4f} {}\n", parameter.name, parameter.value, *parameter.sigma,
                        parameter.unit);
  }
  for (const std::string& sentence : calibration.fit.fit.report.ambiguities) text += "  " + sentence + "\n";
  for (const std::string& sentence : calibration.open) text += "  not determined: " + sentence + "\n";
  return text;
}

}  // namespace sonarcal::report
