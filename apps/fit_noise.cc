#include "apps/fit_noise.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/compare_recordings.h"
#include "apps/provenance.h"
#include "apps/report/noise_section.h"
#include "apps/report/paper_files.h"
#include "apps/report/report_end.h"
#include "apps/run_output.h"
#include "calib/noise/noise_fit.h"
#include "data_io/files/atomic_output.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

Json ResidualJson(const ResidualSummary& residual) {
  return {{"mean", residual.mean}, {"spread", residual.spread}};
}

Json AgreementJson(const NoiseAgreement& agreement) {
  return {{"ks", agreement.ks},
          {"wasserstein_1_grey", agreement.wasserstein_grey},
          {"cell_ks_median", agreement.cell_ks_median},
          {"cell_ks_p95", agreement.cell_ks_p95},
          {"cell", fmt::format("{} bins x {} beams", kJudgeBins, kJudgeBeams)},
          {"whitened_residual", ResidualJson(agreement.whitened)},
          {"nats_per_pixel", agreement.nats_per_pixel}};
}

Json ChoicesJson(const NoiseFit& fit) {
  Json choices = Json::array();
  for (const NoiseModelChoice& choice : fit.choices) {
    choices.push_back({{"display_law", ToString(choice.display)},
                       {"speckle", ToString(choice.speckle)},
                       {"time_varied_gain", ToString(choice.time_varied_gain)},
                       {"floor_after_gain", choice.floor_after_gain},
                       {"nats_per_pixel", choice.nats_per_pixel},
                       {"converged", choice.converged},
                       {"chosen", choice.chosen}});
  }
  return choices;
}

std::pair<double, double> WindowM(const NoiseCells& cells) {
  const PolarAxes& axes = cells.axes;
  return {axes.range_min_m + cells.first_bin * axes.range_bin_m(),
          axes.range_min_m + cells.last_bin * axes.range_bin_m()};
}

double ShareLeftOut(const NoiseFit& fit) {
  double left_out = 0.0;
  for (const double weight : fit.weight) left_out += weight == 0.0;
  return left_out / static_cast<double>(fit.weight.size());
}

std::string FitJson(const NoiseFit& fit) {
  const auto [near_m, far_m] = WindowM(fit.cells);
  const Json extra = {{"window", {{"found_by_rule", fit.window_found}, {"range_m", {near_m, far_m}}}},
                      {"model_choice", ChoicesJson(fit)},
                      {"speckle", ToString(fit.law.speckle)},
                      {"agreement",
                       {{"judged_on_held_out", fit.judged_on_held_out},
                        {"judged_apart_from_choice", fit.judged_apart_from_choice},
                        {"odd_bands_held_out", fit.bands_held_out},
                        {"frames_chosen_on", fit.frames_chosen_on},
                        {"frames_judged_on", fit.frames_judged_on},
                        {"frames_used", AgreementJson(fit.used)},
                        {"frames_judged", AgreementJson(fit.judged)},
                        {"share_of_cells_left_out", ShareLeftOut(fit)}}}};
  const std::string members = extra.dump();
  return FitReportJson(fit.report, members.substr(1, members.size() - 2));
}

NoiseFitOptions ToNoiseOptions(const FitCommandOptions& options) {
  NoiseFitOptions noise;
  noise.held_out = options.held_out;
  noise.range_min_m = options.range_min_m;
  noise.range_max_m = options.range_max_m;
  noise.reject_beyond = options.reject_beyond;
  noise.find_background = options.find_background;
  noise.hold_out_bands = options.hold_out_bands;
  if (!options.params.empty()) noise.display = ReadParameters(options.params).display;
  noise.progress = [&options](const std::string& line) { PrintNote(options.common, line); };
  return noise;
}

Provenance ProvenanceOf(const FitCommandOptions& options, const NoiseFit& fit) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Provenance provenance{.command = "fit",
                        .configuration = {{"noise_only", true},
                                          {"real", options.real.string()},
                                          {"params", options.params.string()},
                                          {"out", options.out.string()},
                                          {"held_out", fit.report.frames_held_out},
                                          {"range_min_m", number(options.range_min_m)},
                                          {"range_max_m", number(options.range_max_m)},
                                          {"reject_beyond", options.reject_beyond},
                                          {"find_background", options.find_background},
                                          {"hold_out_bands", options.hold_out_bands}},
                        .inputs = {options.real}};
  if (!options.params.empty()) provenance.inputs.push_back(options.params);
  return provenance;
}

std::string SummaryText(const NoiseFit& fit, const std::string& recording, const std::filesystem::path& out) {
  const std::size_t pings = fit.report.frames_used.size();
  std::string text = fmt::format("{}: noise law of {} ping{}, {}\n", recording, pings, pings == 1 ? "" : "s",
                                 NoiseJudgedText(fit));
  if (fit.window_found) text += "  " + NoiseWindowText(fit) + "\n";
  text += fmt::format(
      "  display {}, {} speckle, gain {}, {}\n", ToString(fit.law.display.law), ToString(fit.law.speckle),
      ToString(fit.law.receiver.time_varied_gain),
      fit.law.receiver.noise_after_gain_db ? "floors before and behind the gain" : "floor before the gain");
  for (const FittedParameter& p : fit.report.parameters) {
    if (p.name.find("_taper_db.") != std::string::npos) continue;
    text += fmt::format("  {:<31} {:>9.4g}  {:>8}  {:<5}{}\n", p.name, p.value,
                        p.sigma ? fmt::format("{:.2g}", *p.sigma) : "-", p.unit,
                        p.status == ParameterStatus::kFree ? "" : "  " + std::string(ToString(p.status)));
  }
  for (const std::string& sentence : fit.report.unidentifiable_directions) text += "  " + sentence + "\n";
  text += fmt::format("  KS {:.4f}, Wasserstein-1 {:.3f} grey, KS by cell {:.3f} median, {:.3f} at 95 %\n",
                      fit.judged.ks, fit.judged.wasserstein_grey, fit.judged.cell_ks_median,
                      fit.judged.cell_ks_p95);
  text += fmt::format("  whitened residual {:.3f} +- {:.3f}, 0 +- 1 for a true law\n",
                      fit.judged.whitened.mean, fit.judged.whitened.spread);
  if (ShareLeftOut(fit) > 0.0)
    text += fmt::format("  {:.1f} % of the cells left out\n", 100.0 * ShareLeftOut(fit));
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

HtmlReport MakeReport(const NoiseFit& fit, const RecordingInfo& info, const Json& provenance) {
  HtmlReport report("Noise law of a sonar", RecordingName(info));
  if (info.synthetic) {
    report.Callout(CalloutKind::kSynthetic, "The recording is synthetic",
                   RecordingName(info) + " is simulated, not recorded by a sonar.");
  }
  AddNoiseSections(report, fit, info.synthetic);
  EndReport(report, provenance);
  return report;
}

}  // namespace

ExitStatus RunFitNoise(const FitCommandOptions& options) {
  const auto recording = OpenRecording(options.real);
  RunOutput output(options.out, "fit", options.common.force);
  const NoiseFit fit = FitNoise(*recording, ToNoiseOptions(options));
  const Provenance provenance = ProvenanceOf(options, fit);
  const std::string fit_json = FitJson(fit);
  WriteFileWhole(output / "fit.json", fit_json);
  WriteProvenance(output.staging(), provenance);
  if (!fit.usable) {
    output.Commit();
    PrintError(fmt::format("the fit {}; no parameters were written, {} tells more", fit.report.termination,
                           (options.out / "fit.json").string()));
    return ExitStatus::kNoSolution;
  }
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.display = fit.law.display;
  parameters.receiver = fit.law.receiver;
  parameters.materials["default"] = {};
  WriteParameters(output / "params.json", parameters);
  WriteReport(MakeReport(fit, recording->info(), ProvenanceToJson(provenance)), output.staging());
  output.Commit();
  if (options.common.json) {
    PrintJson(Json::parse(fit_json));
  } else {
    PrintResult(SummaryText(fit, RecordingName(recording->info()), options.out));
  }
  return ExitStatus::kDone;
}

}  // namespace sonarcal
