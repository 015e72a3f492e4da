#include "apps/commands/fitting/fit_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/fitting/fit_ending.h"
#include "apps/commands/fitting/recorded_display.h"
#include "apps/report/html/report_end.h"
#include "apps/report/pictures/saturation_pictures.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/noise_section.h"
#include "apps/report/sections/still_section.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/fit.h"
#include "apps/workflow/still_poses.h"
#include "calib/noise/noise_fit.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::commands {

namespace {

calib::FitReport ReportOf(const workflow::StillPoses& still) {
  calib::FitReport report;
  // Combines the poses by a mean, weighted by their information.
  double weights = 0.0;
  double sum = 0.0;
  for (const workflow::StillPose& pose : still.poses) {
    const double weight = std::pow(pose.levels.noise_sigma_db, -2);
    weights += weight;
    sum += weight * pose.levels.noise_db;
    report.frames_used.insert(report.frames_used.end(), pose.levels.frames.begin(), pose.levels.frames.end());
  }
  std::sort(report.frames_used.begin(), report.frames_used.end());
  const double noise_db = sum / weights;
  report.parameters.push_back({.name = "receiver.noise_db",
                               .unit = "dB",
                               .value = noise_db,
                               .sigma = 1.0 / std::sqrt(weights),
                               .initial = noise_db,
                               .lower = -300.0,
                               .upper = 300.0,
                               .status = calib::ParameterStatus::kFree});
  report.termination = "converged";
  report.gauge.emplace_back("display and looks as given: noise levels are relative to them");
  return report;
}

}  // namespace

cli::ExitStatus RunFitStill(const FitCommandOptions& options) {
  const auto recording = data_io::OpenRecording(options.real);
  ParameterSet parameters = ParametersWithDisplay(options, recording->info());
  cli::RunOutput output(options.out, "fit", options.common.force);
  const workflow::StillPoses still = workflow::MeasureStillPoses(*recording, parameters, 0.0, {});
  if (still.poses.empty()) {
    throw DataError("{}: {}", options.real.string(),
                    still.refused.empty() ? "no pose has two frames" : still.refused.front());
  }
  cli::Provenance provenance{.command = "fit",
                             .configuration = {{"still", true},
                                               {"real", options.real.string()},
                                               {"params", options.params.string()},
                                               {"out", options.out.string()}},
                             .inputs = {options.real}};
  if (!options.params.empty()) provenance.inputs.push_back(options.params);
  const calib::FitReport report = ReportOf(still);
  const std::string fit_json = calib::FitReportJson(report, report::StillMembers(still));
  data_io::WriteFileWhole(output / "fit.json", fit_json);
  cli::WriteProvenance(output.staging(), provenance);
  parameters.receiver.noise_db = report.parameters.front().value;
  parameters.materials.try_emplace("default");
  data_io::WriteParameters(output / "params.json", parameters);
  const RecordingInfo& info = recording->info();
  report::HtmlReport html("Speckle and noise of static frames", workflow::RecordingName(info));
  report::AddSyntheticRecordingCallout(html, info.synthetic, workflow::RecordingName(info));
  html.Section("Levels");
  report::AddStillPoses(html, still);
  report::EndReport(html, cli::ProvenanceToJson(provenance));
  return EndFit(html, fit_json,
                workflow::RecordingName(info) + "\n" + report::StillText(still) +
                    fmt::format("report: {}\n", (options.out / "report.html").string()),
                options.common, output);
}

namespace {

using Json = nlohmann::ordered_json;

Json ChoicesJson(const calib::NoiseFit& fit) {
  Json choices = Json::array();
  for (const calib::NoiseModelChoice& choice : fit.choices) {
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

std::pair<double, double> WindowM(const calib::NoiseCells& cells) {
  const PolarAxes& axes = cells.axes;
  return {axes.range_edge_m(cells.first_bin), axes.range_edge_m(cells.last_bin)};
}

double ShareLeftOut(const calib::NoiseFit& fit) {
  double left_out = 0.0;
  for (const double weight : fit.weight) left_out += weight == 0.0;
  return left_out / static_cast<double>(fit.weight.size());
}

Json WindowJson(const calib::NoiseFit& fit, bool cells_rejected) {
  const auto [near_m, far_m] = WindowM(fit.cells);
  Json left_out = Json::array();
  for (int i = 0; cells_rejected && i < fit.cells.count(); ++i) {
    if (fit.weight[i] == 0.0) left_out.push_back({i / fit.cells.beams(), i % fit.cells.beams()});
  }
  return {{"found_by_rule", fit.window_found},
          {"range_m", {near_m, far_m}},
          {"band_bins", fit.cells.band_bins},
          {"cells_left_out", left_out}};
}

std::string FitJson(const calib::NoiseFit& fit, const FitCommandOptions& options) {
  const Json extra = {{"window", WindowJson(fit, options.reject_beyond > 0.0)},
                      {"model_choice", ChoicesJson(fit)},
                      {"speckle", ToString(fit.law.speckle)},
                      {"agreement",
                       {{"judged_on_held_out", fit.judged_on_held_out},
                        {"judged_apart_from_choice", fit.judged_apart_from_choice},
                        {"odd_bands_held_out", fit.bands_held_out},
                        {"frames_chosen_on", fit.frames_chosen_on},
                        {"frames_judged_on", fit.frames_judged_on},
                        {"frames_used", report::NoiseAgreementJson(fit.used)},
                        {"frames_judged", report::NoiseAgreementJson(fit.judged)},
                        {"fitted_again_to_all_frames", fit.refitted},
                        {"all_frames", report::NoiseAgreementJson(fit.all.agreement)},
                        {"share_of_cells_left_out", ShareLeftOut(fit)}}},
                      {"drift", report::NoiseDriftJson(fit.all)}};
  const std::string members = data_io::JsonLine(extra);
  return calib::FitReportJson(fit.report, members.substr(1, members.size() - 2));
}

calib::NoiseFitOptions ToNoiseOptions(const FitCommandOptions& options, int frame_count) {
  calib::NoiseFitOptions noise;
  noise.held_out = options.fit.held_out.In(frame_count, kHeldOutFrame);
  noise.range_min_m = options.range_min_m;
  noise.range_max_m = options.range_max_m;
  noise.reject_beyond = options.reject_beyond;
  noise.find_background = options.find_background;
  noise.hold_out_bands = options.hold_out_bands;
  if (!options.params.empty()) noise.display = data_io::ReadParameters(options.params).display;
  noise.progress = [&options](const std::string& line) { cli::PrintNote(options.common, line); };
  return noise;
}

cli::Provenance ProvenanceOf(const FitCommandOptions& options, const calib::NoiseFit& fit) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  cli::Provenance provenance{.command = "fit",
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

std::string SummaryText(const calib::NoiseFit& fit, const std::string& recording,
                        const std::filesystem::path& out) {
  const std::size_t pings = fit.report.frames_used.size();
  std::string text = fmt::format("{}: noise law of {} ping{}, {}\n", recording, pings, pings == 1 ? "" : "s",
                                 report::NoiseJudgedText(fit));
  if (fit.window_found) text += "  " + report::NoiseWindowText(fit) + "\n";
  text += fmt::format(
      "  display {}, {} speckle, gain {}, {}\n", ToString(fit.law.display.law), ToString(fit.law.speckle),
      ToString(fit.law.receiver.time_varied_gain),
      fit.law.receiver.noise_after_gain_db ? "floors before and behind the gain" : "floor before the gain");
  for (const calib::FittedParameter& p : fit.report.parameters) {
    if (p.name.find("_taper_db.") != std::string::npos) continue;
    text +=
        fmt::format("  {:<31} {:>9.4g}  {:>8}  {:<5}{}\n", p.name, p.value,
                    p.sigma ? fmt::format("{:.2g}", *p.sigma) : "-", p.unit,
                    p.status == calib::ParameterStatus::kFree ? "" : "  " + std::string(ToString(p.status)));
  }
  for (const std::string& sentence : fit.report.unidentifiable_directions) text += "  " + sentence + "\n";
  text += report::NoiseAgreementText(fit.judged);
  text += "  " + report::NoiseResultText(fit) + "\n";
  text += "  " + report::NoiseDriftText(fit.all) + "\n";
  if (fit.report.saturation && !fit.report.saturation->empty())
    text += "  " + calib::SaturationText(*fit.report.saturation) + "\n";
  if (ShareLeftOut(fit) > 0.0)
    text += fmt::format("  {:.1f} % of the cells left out\n", 100.0 * ShareLeftOut(fit));
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

ParameterSet ParametersOf(const calib::NoiseLaw& law) {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.display = law.display;
  parameters.receiver = law.receiver;
  parameters.materials["default"] = {};
  return parameters;
}

report::HtmlReport MakeReport(const calib::NoiseFit& fit, const RecordingInfo& info, const Json& provenance) {
  report::HtmlReport report("Noise law of a sonar", workflow::RecordingName(info));
  if (info.synthetic) {
    report.Callout(report::CalloutKind::kSynthetic, "The recording is synthetic",
                   workflow::RecordingName(info) + " is simulated, not recorded by a sonar.");
  }
  report::AddNoiseSections(report, fit, info.synthetic);
  report::AddSaturation(report, fit.report, info.sonar.axes);
  report::EndReport(report, provenance);
  return report;
}

}  // namespace

cli::ExitStatus RunFitNoise(const FitCommandOptions& options) {
  const auto recording = data_io::OpenRecording(options.real);
  cli::RunOutput output(options.out, "fit", options.common.force);
  const calib::NoiseFit fit = calib::FitNoise(*recording, ToNoiseOptions(options, recording->frame_count()));
  const cli::Provenance provenance = ProvenanceOf(options, fit);
  const std::string fit_json = FitJson(fit, options);
  data_io::WriteFileWhole(output / "fit.json", fit_json);
  cli::WriteProvenance(output.staging(), provenance);
  if (!fit.usable) {
    return EndFitWithoutSolution("the fit " + fit.report.termination, options.out, output);
  }
  data_io::WriteParameters(output / "params.json", ParametersOf(fit.law));
  if (fit.refitted)
    data_io::WriteParameters(output / "params_evaluated.json", ParametersOf(fit.evaluated_law));
  return EndFit(MakeReport(fit, recording->info(), cli::ProvenanceToJson(provenance)), fit_json,
                SummaryText(fit, workflow::RecordingName(recording->info()), options.out), options.common,
                output);
}

}  // namespace sonarcal::commands
