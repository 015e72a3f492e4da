#include "apps/commands/fitting/fit_standard_target.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/fitting/fit_ending.h"
#include "apps/commands/fitting/recorded_display.h"
#include "apps/report/html/report_end.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/standard_target_section.h"
#include "apps/workflow/simulate.h"
#include "calib/standard_target/standard_target_fit.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_reader.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "sim/physics/absorption.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

calib::StandardTargetOptions TargetOptions(const FitCommandOptions& options, int frame_count) {
  const StandardTargetChoice& target = options.standard_target;
  if (!target.diameter_mm) throw UsageError("--standard-target needs --diameter-mm");
  const std::vector<std::string>& material = options.fit.materials.material;
  if (material.size() != 1) throw UsageError("--standard-target needs one --material, such as wc");
  calib::StandardTargetOptions fit{
      .sphere = {.material = material.front(),
                 .diameter_m = 1e-3 * *target.diameter_mm,
                 .temperature_sigma_c = target.temperature_sigma_c},
      .search = {.range_min_m = options.range_min_m, .range_max_m = options.range_max_m}};
  if (target.bandwidth_khz) fit.sphere.bandwidth_hz = 1e3 * *target.bandwidth_khz;
  fit.frames = options.fit.frames.In(frame_count);
  return fit;
}

calib::TargetLevel LevelIn(const std::filesystem::path& fit_json) {
  const data_io::JsonReader json = data_io::JsonReader::FromFile(fit_json);
  const std::optional<data_io::JsonReader> target = json.Find("standard_target");
  if (!target) json.Fail("is no fit of a standard target");
  return {.level_db = target->At("level_db").Number(),
          .level_sigma_db = target->At("level_sigma_db").Number(),
          .received_db = target->At("received_db").Number()};
}

cli::Provenance ProvenanceOf(const FitCommandOptions& options, const calib::StandardTargetOptions& fit,
                             const Water& water) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  return {.command = "fit",
          .configuration = {{"standard_target", options.standard_target.shape},
                            {"material", fit.sphere.material},
                            {"diameter_mm", *options.standard_target.diameter_mm},
                            {"bandwidth_khz", number(options.standard_target.bandwidth_khz)},
                            {"temperature_sigma_c", fit.sphere.temperature_sigma_c},
                            {"second_target", options.standard_target.second.string()},
                            {"range_min_m", number(options.range_min_m)},
                            {"range_max_m", number(options.range_max_m)},
                            {"real", options.real.string()},
                            {"sonar", options.sonar},
                            {"params", options.params.string()},
                            {"poses", options.poses.string()},
                            {"out", options.out.string()},
                            {"frames", fit.frames},
                            {"water", workflow::WaterText(water)}},
          .inputs = {options.real, cli::SonarFile(options.sonar), options.params, options.poses,
                     options.standard_target.second}};
}

}  // namespace

cli::ExitStatus RunFitStandardTarget(const FitCommandOptions& options) {
  std::unique_ptr<RecordingSource> recording = workflow::OpenRecordingWith(options.real, options.sonar);
  if (!options.poses.empty()) {
    recording =
        data_io::WithPoses(std::move(recording), data_io::ReadPosesOrRecording(options.poses), options.poses);
  }
  const RecordingInfo& info = recording->info();
  calib::StandardTargetOptions fit_options = TargetOptions(options, recording->frame_count());
  ParameterSet initial = ParametersWithDisplay(options, info);
  std::optional<calib::TargetLevel> second;
  if (!options.standard_target.second.empty()) {
    second = LevelIn(options.standard_target.second);
    if (initial.display.law != DisplayLaw::kLog)
      throw DataError("display law {}: a second target fixes the slope of a display of law log only",
                      ToString(initial.display.law));
  }
  const workflow::WaterChoice water = workflow::ChooseWater(initial, info.water);
  if (!water.note.empty()) cli::PrintNote(options.common, water.note);
  const double absorption_db_per_m =
      sim::AbsorptionDbPerM(sim::AbsorptionFormula::kAuto, info.sonar.frequency_hz, water.water);
  cli::RunOutput output(options.out, "fit", options.common.force);
  std::optional<cli::Progress> progress;
  fit_options.progress = [&](const std::string& step, int done, int total) {
    if (done == 0 || !progress) progress.emplace(step, total, options.common);
    progress->Update(done);
  };
  const auto fit_target = [&] {
    return calib::FitStandardTarget(*recording, initial, water.water, absorption_db_per_m, fit_options);
  };
  calib::StandardTargetFit fit = fit_target();
  if (second && fit.usable) {
    const calib::DisplaySlope slope = calib::SlopeOfTwoTargets(
        {.level_db = fit.level_db, .level_sigma_db = fit.level_sigma_db, .received_db = fit.received_db},
        *second);
    if (!slope.AgreesWithDisplay()) {
      DisplayParameters<double>& display = initial.display;
      display.db_max = display.db_min + slope.db_per_shown_db * (display.db_max - display.db_min);
      fit_options.display_sigma_share = slope.sigma / slope.db_per_shown_db;
      fit = fit_target();
    }
    fit.display_slope = slope;
  }
  progress.reset();

  const cli::Provenance provenance = ProvenanceOf(options, fit_options, water.water);
  const std::string fit_json = calib::FitReportJson(fit.report, report::StandardTargetMember(fit));
  data_io::WriteFileWhole(output / "fit.json", fit_json);
  cli::WriteProvenance(output.staging(), provenance);
  if (!fit.usable) return EndFitWithoutSolution("the fit " + fit.report.termination, options.out, output);
  ParameterSet parameters = fit.parameters;
  parameters.materials.try_emplace("default");
  data_io::WriteParameters(output / "params.json", parameters);
  report::HtmlReport html("Standard target", workflow::RecordingName(info));
  report::AddSyntheticRecordingCallout(html, info.synthetic, workflow::RecordingName(info));
  report::AddStandardTarget(html, fit, info.sonar.axes, info.synthetic);
  report::EndReport(html, cli::ProvenanceToJson(provenance));
  return EndFit(html, fit_json,
                workflow::RecordingName(info) + "\n" + report::StandardTargetText(fit) +
                    fmt::format("report: {}\n", (options.out / "report.html").string()),
                options.common, output);
}

}  // namespace sonarcal::commands
