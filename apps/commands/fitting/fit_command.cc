#include "apps/commands/fitting/fit_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/given_options.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/commands/fitting/fit_ending.h"
#include "apps/commands/fitting/fit_noise.h"
#include "apps/commands/fitting/fit_standard_target.h"
#include "apps/report/html/report_end.h"
#include "apps/report/pictures/saturation_pictures.h"
#include "apps/report/sections/choice_section.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/fit_section.h"
#include "apps/report/sections/still_section.h"
#include "apps/workflow/fit.h"
#include "apps/workflow/kept_memory.h"
#include "apps/workflow/simulate.h"
#include "apps/workflow/still_poses.h"
#include "calib/acoustic_fit.h"
#include "calib/selection/ping_worth.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

Json ConfigurationJson(const FitCommandOptions& options, const calib::FitConfig& config,
                       const workflow::RecordingFit& fit) {
  Json bounds = Json::object();
  for (const auto& [name, limits] : config.bounds) bounds[name] = {limits.first, limits.second};
  Json priors = Json::object();
  for (const auto& [name, prior] : config.priors) {
    priors[name] = prior ? Json::array({prior->first, prior->second}) : Json("none");
  }
  Json json = {{"real", options.real.string()},
               {"scene", options.scene.string()},
               {"params", options.params.string()},
               {"out", options.out.string()},
               {"sonar", options.sonar},
               {"poses", options.poses.string()},
               {"model", ToString(fit.initial.model)}};
  json.update(cli::SceneFormatJson(options.scene_format));
  workflow::FitOptions resolved = options.fit;
  resolved.rays = fit.ray_options;
  resolved.rays.rays = fit.rays;
  resolved.free = *config.free;
  resolved.fixed = config.fixed;
  resolved.held_out = fit.fit.report.frames_held_out;
  json.update(cli::OptionsJson(resolved));
  json["used"] = fit.fit.report.frames_used;
  json.update({{"bounds", bounds},
               {"priors", priors},
               {"pose_prior",
                {{"position_m", config.pose_prior.position_m}, {"angle_deg", config.pose_prior.angle_deg}}}});
  return json;
}

std::string FigureText(const metrics::Statistic& statistic) {
  return statistic.value ? fmt::format("{:.3f}", *statistic.value) : "none";
}

std::size_t NameWidth(const calib::FitReport& report) {
  std::size_t width = 0;
  for (const calib::FittedParameter& p : report.parameters) width = std::max(width, p.name.size());
  return width;
}

// Curves at a few of the visible angles, each with its 95 % band. They come before the parameters because a
// curve is determined better than its parameters.
std::string CurvesText(const calib::FitReport& report,
                       const std::map<std::string, workflow::IncidenceRange>& seen) {
  constexpr std::array kAnglesDeg = {0, 5, 10, 20, 30, 45, 60, 75};
  std::string text;
  for (const calib::FittedCurve& curve : report.curves) {
    const auto range = seen.find(curve.material);
    if (range == seen.end()) continue;
    text += fmt::format("  {}, backscatter at incidence angles in the frames, dB\n", curve.material);
    for (const int deg : kAnglesDeg) {
      const auto i = static_cast<std::size_t>(deg);  // one value per degree
      if (deg < range->second.low_deg || deg > range->second.high_deg || i >= curve.backscatter_db.size())
        continue;
      text += fmt::format("    {:>2} deg  {:>7.2f} +- {:.2f}{}{}\n", deg, curve.backscatter_db[i],
                          calib::kSigmasOf95 * curve.sigma_db[i],
                          curve.truth_db.empty() ? "" : fmt::format("  truth {:>7.2f}", curve.truth_db[i]),
                          curve.determined[i] ? "" : "  pulled by its prior");
    }
  }
  if (text.empty()) return text;
  const std::string level = calib::CurvesLevelText(report);
  return text + "    (+-: 95 % band)\n" + (level.empty() ? "" : "  " + level + "\n");
}

std::string ParametersText(const calib::FitReport& report) {
  const std::size_t width = NameWidth(report);
  const bool truth = calib::HasTruth(report);
  const auto true_text = [&](const std::string& value) { return truth ? fmt::format("  {:>9}", value) : ""; };
  std::string text = fmt::format("  {:<{}}  {:>9}  {:>9}  {:>8}{}  {}\n", "parameter", width, "initial",
                                 "fitted", "sigma", true_text("truth"), "unit");
  int fixed = 0;
  for (const calib::FittedParameter& p : report.parameters) {
    if (p.status == calib::ParameterStatus::kFixed) {
      ++fixed;
      continue;
    }
    const std::string remark = p.status == calib::ParameterStatus::kFree      ? std::string()
                               : p.status == calib::ParameterStatus::kAtBound ? "  at a bound"
                                                                              : "  unidentifiable";
    text += fmt::format("  {:<{}}  {:>9.4g}  {:>9.4g}  {:>8}{}  {}{}\n", p.name, width, p.initial, p.value,
                        p.sigma ? fmt::format("{:.2g}", *p.sigma) : "-",
                        true_text(p.truth ? fmt::format("{:.4g}", *p.truth) : "-"), p.unit, remark);
  }
  if (fixed > 0) text += fmt::format("  and {} fixed\n", fixed);
  return text;
}

// Summary for the terminal: curves, parameters with standard errors, metrics before and after.
std::string SummaryText(const workflow::RecordingFit& fit, const std::string& recording,
                        const std::filesystem::path& out) {
  const calib::FitReport& report = fit.fit.report;
  std::string text = fit.choice ? report::ModelChoiceText(*fit.choice) : std::string();
  for (const std::string& sentence : report.warnings) text += fmt::format("warning: {}\n", sentence);
  text +=
      fmt::format("{}: fitted to {}, evaluated on {}\n", recording, report::NamedFrames(report.frames_used),
                  fit.judged_on_held_out ? report::NamedFrames(report.frames_held_out)
                                         : "the same frames, because none is held out");
  const std::size_t width = NameWidth(report);
  text += CurvesText(report, fit.seen) + ParametersText(report);
  const auto add_list = [&](const char* title, const std::vector<std::string>& sentences) {
    if (!sentences.empty()) text += fmt::format("  {}:\n    {}\n", title, fmt::join(sentences, "\n    "));
  };
  add_list("not identifiable", report.unidentifiable_directions);
  add_list("other poses that fit equally well", report.other_poses);
  add_list("other explanations of the geometry", report.ambiguities);

  const metrics::IntensityDomain domain = fit.after.options.intensity_domain;
  text += fmt::format("  {:<{}}  {:>9}  {:>9}\n", fit.judged_on_held_out ? "held-out frames" : "frames used",
                      width, "before", "after");
  const auto add = [&](const char* label, const metrics::Statistic& old, const metrics::Statistic& now) {
    text += fmt::format("  {:<{}}  {:>9}  {:>9}\n", label, width, FigureText(old), FigureText(now));
  };
  const auto add_image = [&](const char* image, const metrics::MetricsReport& before,
                             const metrics::MetricsReport& after) {
    text += fmt::format("  {}\n", image);
    const metrics::Aggregate::Views& old = before.aggregate.macro;
    const metrics::Aggregate::Views& now = after.aggregate.macro;
    add("  IoU", old.polar.At("iou"), now.polar.At("iou"));
    add("  intensity error, polar", old.polar.Over(domain).mean_absolute,
        now.polar.Over(domain).mean_absolute);
    add("  intensity error, whole image", old.polar.Over(metrics::IntensityDomain::kWhole).mean_absolute,
        now.polar.Over(metrics::IntensityDomain::kWhole).mean_absolute);
    add("  intensity error, fan", old.fan.Over(domain).mean_absolute, now.fan.Over(domain).mean_absolute);
  };
  add_image("expected image", fit.before, fit.after);
  if (fit.sample_before && fit.sample_after)
    add_image("speckled sample", *fit.sample_before, *fit.sample_after);
  if (report.pings) text += calib::PingWorthText(*report.pings) + "\n";
  if (report.down_weighted_share) {
    text +=
        fmt::format("{:.1f} % of the pixels used have a weight below one half: they do not match the scene\n",
                    100.0 * *report.down_weighted_share);
  }
  text += report::StillText(fit.still);
  text += fmt::format("{:.1f} s to trace every frame once, {:.1f} s to fit; {} rays in all\n", report.trace_s,
                      report.solve_s, report.rays_cast);
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

// Throws UsageError for options that have no effect in the chosen kind of fit.
void RefuseWithoutEffect(const CLI::App& command, const FitCommandOptions& options) {
  const cli::OptionNames noise_options = {"--find-background", "--hold-out-bands", "--reject-beyond"};
  const cli::OptionNames range_options = {"--range-min", "--range-max"};
  const cli::OptionNames target_options = {"--diameter-mm", "--bandwidth-khz", "--temperature-sigma",
                                           "--second-target"};
  const auto with = [](cli::OptionNames names, std::initializer_list<cli::OptionNames> others) {
    for (const cli::OptionNames& other : others) names.insert(names.end(), other.begin(), other.end());
    return names;
  };
  if (!options.standard_target.shape.empty()) {
    cli::RefuseGivenExcept(command,
                           with({"--standard-target", "--real", "--sonar", "--poses", "--params", "--out",
                                 "--frames", "--material", "--threads"},
                                {range_options, target_options}),
                           "with --standard-target");
    return;
  }
  cli::RefuseGiven(command, target_options, "without --standard-target");
  if (options.noise_only) {
    cli::RefuseGivenExcept(
        command,
        with({"--noise-only", "--real", "--params", "--out", "--held-out", "--threads", "--choose"},
             {range_options, noise_options}),
        "with --noise-only");
  } else if (options.still) {
    cli::RefuseGivenExcept(command, {"--still", "--real", "--params", "--out", "--threads"}, "with --still");
  } else {
    cli::RefuseGiven(command, noise_options, "without --noise-only");
    cli::RefuseGiven(command, range_options, "without --noise-only or --standard-target");
    cli::RefuseSceneFormatAlone(command);
    cli::RefuseUnusedSegmentation(command, options.fit.comparison);
  }
}

report::HtmlReport MakeReport(const workflow::RecordingFit& fit, const RecordingInfo& info,
                              const Json& provenance) {
  report::HtmlReport report("Fit of a sonar's parameters", workflow::RecordingName(info));
  report::AddFitOpening(report, fit, report::FitInWords(fit));
  report::AddSyntheticCallout(report, info.synthetic, workflow::RecordingName(info));
  report::AddFitWarnings(report, fit.fit.report);
  report::AddFitKeyFigures(report, fit);
  report.Section("Before and after");
  report::AddFitComparison(report, fit);
  if (fit.choice) report::AddModelChoice(report, *fit.choice);
  report::AddUnexplained(report, fit);
  report::AddSaturation(report, fit.fit.report, info.sonar.axes, fit.streaked_frames, info.synthetic);
  report.Section("Fitted values");
  report::AddFittedValues(report, fit);
  report::AddStillPoses(report, fit.still);
  report::AddMetricDefinitions(report, fit.after);
  report::EndReport(report, provenance);
  return report;
}

// Sonar and scene, if the fit changed them, for the other commands.
void WriteCalibratedSonar(const cli::RunOutput& output, RecordingInfo info,
                          const workflow::RecordingFit& fit) {
  if (fit.scene) data_io::WriteGltf(*fit.scene, output / "scene.gltf");
  if (fit.geometry == SonarGeometry()) return;
  info.sonar.axes = Corrected(info.sonar.axes, fit.geometry);
  data_io::WriteSonarFile(output / "sonar.json", info);
}

}  // namespace

std::string FitJson(const workflow::RecordingFit& fit) {
  std::string extra;
  if (fit.fit.usable) {
    extra = fmt::format(R"("metrics_before": {}, "metrics_after": {})", metrics::MetricsJson(fit.before),
                        metrics::MetricsJson(fit.after));
    if (fit.sample_before && fit.sample_after) {
      extra += fmt::format(R"(, "sample_metrics_before": {}, "sample_metrics_after": {})",
                           metrics::MetricsJson(*fit.sample_before), metrics::MetricsJson(*fit.sample_after));
    }
    if (!fit.still.empty()) extra += ", " + report::StillMembers(fit.still);
  }
  if (fit.choice) {
    extra += fmt::format(R"({}"model_choice": {})", extra.empty() ? "" : ", ",
                         report::ModelChoiceJson(*fit.choice));
  }
  return calib::FitReportJson(fit.fit.report, extra);
}

cli::ExitStatus RunFit(const FitCommandOptions& options) {
  const workflow::ThreadLimit threads(options.fit.rays.threads);
  workflow::ReturnLargeBlocks();
  if (options.noise_only && !options.fit.choose.empty())
    throw UsageError("--choose is not for --noise-only, which chooses by itself");
  if (options.noise_only) return RunFitNoise(options);
  if (options.still) return RunFitStill(options);
  if (!options.standard_target.shape.empty()) return RunFitStandardTarget(options);
  constexpr const char* kExcept = "except with --noise-only, --still or --standard-target";
  if (options.scene.empty()) throw UsageError("--scene is required, {}", kExcept);
  if (options.params.empty()) throw UsageError("--params is required, {}", kExcept);
  const ParameterSet initial = data_io::ReadStartParameters(options.params, options.fit.materials.Known());
  std::unique_ptr<RecordingSource> recording = workflow::OpenRecordingWith(options.real, options.sonar);
  if (!options.poses.empty()) {
    recording =
        data_io::WithPoses(std::move(recording), data_io::ReadPosesOrRecording(options.poses), options.poses);
  }
  const Scene scene = cli::ReadSceneFile(options.scene, options.scene_format, options.common);
  const calib::FitConfig config =
      workflow::ResolveFitConfig(options.fit, initial, scene, recording->frame_count());
  cli::RunOutput output(options.out, "fit", options.common.force);
  std::optional<cli::Progress> progress;
  const workflow::RecordingFit fit = workflow::Fit(
      *recording, scene, initial, options.fit,
      {.progress =
           [&](const std::string& step, int done, int total) {
             if (!progress) progress.emplace(step, total, options.common);
             progress->Update(done);
           },
       .message = [&](const std::string& sentence) { cli::PrintNote(options.common, sentence); },
       .stop = {}});

  std::vector<std::filesystem::path> inputs = cli::OptionFiles(options.fit);
  inputs.insert(inputs.begin(),
                {options.real, cli::SonarFile(options.sonar), options.scene, options.params, options.poses});
  const cli::Provenance provenance{.command = "fit",
                                   .configuration = ConfigurationJson(options, config, fit),
                                   .inputs = std::move(inputs)};
  const std::string fit_json = FitJson(fit);
  data_io::WriteFileWhole(output / "fit.json", fit_json);
  cli::WriteProvenance(output.staging(), provenance);
  if (!fit.fit.usable) return EndFitWithoutSolution(NoSolutionText(fit.fit.report), options.out, output);
  data_io::WriteParameters(output / "params.json", fit.fit.parameters);
  if (!fit.poses.empty()) data_io::WritePoses(output / "poses.json", fit.poses);
  WriteCalibratedSonar(output, recording->info(), fit);
  return EndFit(MakeReport(fit, recording->info(), cli::ProvenanceToJson(provenance)), fit_json,
                SummaryText(fit, workflow::RecordingName(recording->info()), options.out), options.common,
                output);
}

namespace {

// Returns the option that chooses this kind of fit.
CLI::Option* AddStandardTargetOptions(CLI::App* command, StandardTargetChoice* target) {
  CLI::Option* shape =
      command
          ->add_option(
              "--standard-target", target->shape,
              "Only calibrate level and responses with a target of known strength that the frames show: "
              "sphere; --material is then that of the sphere, wc or steel-440c")
          ->type_name("SHAPE")
          ->check(CLI::IsMember({"sphere"}).description(""));
  const auto add = [&](const char* name, auto& member, const char* help, const char* unit, double most) {
    command->add_option(name, member, help)->type_name(unit)->check(cli::Within(0.0, most));
  };
  add("--diameter-mm", target->diameter_mm, "Standard target: diameter of the sphere", "MM", 1000.0);
  add("--bandwidth-khz", target->bandwidth_khz,
      "Standard target: band over which its strength is averaged (default: that of the fitted pulse)", "KHZ",
      10000.0);
  add("--temperature-sigma", target->temperature_sigma_c,
      "Standard target: standard error of the temperature of the water", "C", 50.0);
  command
      ->add_option(
          "--second-target", target->second,
          "Standard target: fit.json of another target, recorded with the same settings; both fix the "
          "slope of the display")
      ->type_name("JSON");
  return shape;
}

void AddFitOptions(CLI::App* command, FitCommandOptions* options) {
  command
      ->add_option(
          "--real", options->real,
          "Recording to fit to; each frame needs a pose, except with --poses, --noise-only, --still or "
          "--standard-target")
      ->type_name("REC")
      ->required();
  cli::AddSonarOfRecording(*command, options->sonar);
  cli::AddSceneOptions(*command, options->scene, options->scene_format, "Scene with named materials",
                       /*required=*/false);
  command
      ->add_option("--params", options->params,
                   "Start parameters; --noise-only and --standard-target keep their display, --still also "
                   "their looks and "
                   "noise floor")
      ->type_name("JSON");
  command
      ->add_option(
          "--poses", options->poses,
          "Poses, one per frame, in place of those of --real: a recording with poses, or a JSON file "
          "(default: none)")
      ->type_name("REC|FILE");
  cli::AddOutFolder(*command, options->out, options->common, "Folder for parameters, fit and report")
      ->required();
  cli::AddOptions(*command, options->fit);
  CLI::Option* noise_only =
      command->add_flag("--noise-only", options->noise_only,
                        "Fit only noise floor, speckle and display law, to pings without targets");
  CLI::Option* still =
      command
          ->add_flag("--still", options->still,
                     "Only separate speckle from receiver noise, on frames from one pose of a static scene")
          ->excludes(noise_only);
  AddStandardTargetOptions(command, &options->standard_target)->excludes(noise_only)->excludes(still);
  command
      ->add_option("--range-min", options->range_min_m,
                   "Noise only, standard target: nearest range used (default: all)")
      ->type_name("M");
  command
      ->add_option("--range-max", options->range_max_m,
                   "Noise only, standard target: farthest range used (default: all)")
      ->type_name("M");
  command->add_flag("--find-background", options->find_background,
                    "Noise only: find the window of range without targets by rule");
  command->add_flag("--hold-out-bands", options->hold_out_bands,
                    "Noise only: evaluate on every second band of 8 range bins, which is not fitted "
                    "(default: only for a single frame)");
  command
      ->add_option("--reject-beyond", options->reject_beyond,
                   "Noise only: leave out cells that are off by more than this many robust standard "
                   "deviations, 0 for none")
      ->type_name("N")
      ->check(cli::Within(0.0, 100.0));
}

}  // namespace

void SetupFit(CLI::App& app) {
  auto options = std::make_shared<FitCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "fit", "Fits the parameters of an image model to a recording with poses");
  AddFitOptions(command, options.get());
  cli::OnRun(command, options->common, [command, options] {
    RefuseWithoutEffect(*command, *options);
    return RunFit(*options);
  });
}

}  // namespace sonarcal::commands
