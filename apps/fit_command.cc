#include "apps/fit_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/fit_noise.h"
#include "apps/fit_recording.h"
#include "apps/given_options.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/report/choice_section.h"
#include "apps/report/comparison_section.h"
#include "apps/report/fit_section.h"
#include "apps/report/paper_files.h"
#include "apps/report/report_end.h"
#include "apps/report/still_section.h"
#include "apps/run_output.h"
#include "apps/simulate_recording.h"
#include "apps/still_poses.h"
#include "calib/acoustic_fit.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

std::vector<ChoiceAxis> ResolveAxes(const std::vector<std::string>& names) {
  constexpr std::array kAxes = {ChoiceAxis::kPattern, ChoiceAxis::kElevation, ChoiceAxis::kMirrors,
                                ChoiceAxis::kLooks,   ChoiceAxis::kTrend,     ChoiceAxis::kDisplay};
  std::vector<ChoiceAxis> axes;
  for (const std::string& name : names) {
    const auto* const found =
        std::find_if(kAxes.begin(), kAxes.end(), [&](ChoiceAxis axis) { return ToString(axis) == name; });
    if (found == kAxes.end()) {
      throw UsageError("--choose: '{}', expected pattern, elevation, mirrors, looks, trend or display", name);
    }
    axes.push_back(*found);
  }
  return axes;
}

Json ConfigurationJson(const FitCommandOptions& options, const FitConfig& config, const RecordingFit& fit) {
  Json bounds = Json::object();
  for (const auto& [name, limits] : config.bounds) bounds[name] = {limits.first, limits.second};
  Json priors = Json::object();
  for (const auto& [name, prior] : config.priors) {
    priors[name] = prior ? Json::array({prior->first, prior->second}) : Json("none");
  }
  Json json = {{"real", options.real.string()},
               {"scene", options.scene.string()},
               {"params", options.params.string()},
               {"config", options.config.empty() ? Json(nullptr) : Json(options.config.string())},
               {"out", options.out.string()},
               {"model", ToString(fit.initial.model)},
               {"free", *config.free},
               {"fixed", config.fixed},
               {"bounds", bounds},
               {"priors", priors},
               {"pose_prior",
                {{"position_m", config.pose_prior.position_m}, {"angle_deg", config.pose_prior.angle_deg}}},
               {"choose", options.choose},
               {"trust_all", options.trust_all},
               {"held_out", fit.fit.report.frames_held_out},
               {"max_iterations", options.max_iterations},
               {"starts", options.starts}};
  json.update(SceneFormatJson(options.scene_format));
  json.update(RayOptionsJson(fit.ray_options, fit.rays));
  json.update(ComparisonOptionsJson(options.comparison));
  return json;
}

std::string FigureText(const Statistic& statistic) {
  return statistic.value ? fmt::format("{:.3f}", *statistic.value) : "none";
}

std::size_t NameWidth(const FitReport& report) {
  std::size_t width = 0;
  for (const FittedParameter& p : report.parameters) width = std::max(width, p.name.size());
  return width;
}

// Curves at a few of the angles that the frames show, each with its 95 % band. They come before the
// parameters: a curve is determined better than the values that make it.
std::string CurvesText(const FitReport& report, const std::map<std::string, IncidenceRange>& seen) {
  constexpr double kSigmasOf95 = 1.96;
  constexpr std::array kAnglesDeg = {0, 5, 10, 20, 30, 45, 60, 75};
  std::string text;
  for (const FittedCurve& curve : report.curves) {
    const auto range = seen.find(curve.material);
    if (range == seen.end()) continue;
    text += fmt::format("  {}, backscatter at incidence where the frames show it, dB\n", curve.material);
    for (const int deg : kAnglesDeg) {
      const auto i = static_cast<std::size_t>(deg);  // a value every degree
      if (deg < range->second.low_deg || deg > range->second.high_deg || i >= curve.backscatter_db.size())
        continue;
      text += fmt::format("    {:>2} deg  {:>7.2f} +- {:.2f}{}\n", deg, curve.backscatter_db[i],
                          kSigmasOf95 * curve.sigma_db[i],
                          curve.truth_db.empty() ? "" : fmt::format("  truth {:>7.2f}", curve.truth_db[i]));
    }
  }
  return text.empty() ? text : text + "    (+-: 95 % band)\n";
}

std::string ParametersText(const FitReport& report) {
  const std::size_t width = NameWidth(report);
  const bool truth = HasTruth(report);
  const auto true_text = [&](const std::string& value) { return truth ? fmt::format("  {:>9}", value) : ""; };
  std::string text = fmt::format("  {:<{}}  {:>9}  {:>9}  {:>8}{}  {}\n", "parameter", width, "initial",
                                 "fitted", "sigma", true_text("truth"), "unit");
  int fixed = 0;
  for (const FittedParameter& p : report.parameters) {
    if (p.status == ParameterStatus::kFixed) {
      ++fixed;
      continue;
    }
    const std::string remark = p.status == ParameterStatus::kFree      ? std::string()
                               : p.status == ParameterStatus::kAtBound ? "  at a bound"
                                                                       : "  unidentifiable";
    text += fmt::format("  {:<{}}  {:>9.4g}  {:>9.4g}  {:>8}{}  {}{}\n", p.name, width, p.initial, p.value,
                        p.sigma ? fmt::format("{:.2g}", *p.sigma) : "-",
                        true_text(p.truth ? fmt::format("{:.4g}", *p.truth) : "-"), p.unit, remark);
  }
  if (fixed > 0) text += fmt::format("  and {} fixed\n", fixed);
  return text;
}

// Summary for the terminal: curves, parameters with standard errors, metrics before and after.
std::string SummaryText(const RecordingFit& fit, const std::string& recording,
                        const std::filesystem::path& out) {
  const FitReport& report = fit.fit.report;
  std::string text = fit.choice ? ModelChoiceText(*fit.choice) : std::string();
  for (const std::string& sentence : report.warnings) text += fmt::format("warning: {}\n", sentence);
  text += fmt::format("{}: fitted to frames {}, judged on {}\n", recording, FrameList(report.frames_used),
                      fit.judged_on_held_out ? "frames " + FrameList(report.frames_held_out)
                                             : "the same frames, because none is held out");
  const std::size_t width = NameWidth(report);
  text += CurvesText(report, fit.seen) + ParametersText(report);
  const auto add_list = [&](const char* title, const std::vector<std::string>& sentences) {
    if (!sentences.empty()) text += fmt::format("  {}:\n    {}\n", title, fmt::join(sentences, "\n    "));
  };
  add_list("not identifiable", report.unidentifiable_directions);
  add_list("other poses that fit equally well", report.other_poses);

  const IntensityDomain domain = fit.after.options.intensity_domain;
  text += fmt::format("  {:<{}}  {:>9}  {:>9}\n", fit.judged_on_held_out ? "held-out frames" : "frames used",
                      width, "before", "after");
  const auto add = [&](const char* label, const Statistic& old, const Statistic& now) {
    text += fmt::format("  {:<{}}  {:>9}  {:>9}\n", label, width, FigureText(old), FigureText(now));
  };
  const auto add_image = [&](const char* image, const MetricsReport& before, const MetricsReport& after) {
    text += fmt::format("  {}\n", image);
    const Aggregate::Views& old = before.aggregate.macro;
    const Aggregate::Views& now = after.aggregate.macro;
    add("  IoU", old.polar.At("iou"), now.polar.At("iou"));
    add("  intensity error, polar", old.polar.Over(domain).mean_absolute,
        now.polar.Over(domain).mean_absolute);
    add("  intensity error, whole image", old.polar.Over(IntensityDomain::kWhole).mean_absolute,
        now.polar.Over(IntensityDomain::kWhole).mean_absolute);
    add("  intensity error, fan", old.fan.Over(domain).mean_absolute, now.fan.Over(domain).mean_absolute);
  };
  add_image("expected image", fit.before, fit.after);
  if (fit.sample_before && fit.sample_after)
    add_image("speckled sample", *fit.sample_before, *fit.sample_after);
  if (report.down_weighted_share) {
    text +=
        fmt::format("{:.1f} % of the pixels used count for less than half: the scene does not explain them\n",
                    100.0 * *report.down_weighted_share);
  }
  text += StillText(fit.still);
  text += fmt::format("{:.1f} s to trace every frame once, {:.1f} s to fit; {} rays in all\n", report.trace_s,
                      report.solve_s, report.rays_cast);
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

// Throws UsageError for options that have no effect in the chosen kind of fit.
void RefuseWithoutEffect(const CLI::App& command, const FitCommandOptions& options) {
  const OptionNames noise_options = {"--range-min", "--range-max", "--find-background", "--hold-out-bands",
                                     "--reject-beyond"};
  if (options.noise_only) {
    OptionNames taken = {"--noise-only", "--real",    "--params", "--out",
                         "--held-out",   "--threads", "--choose"};
    taken.insert(taken.end(), noise_options.begin(), noise_options.end());
    RefuseGivenExcept(command, taken, "with --noise-only");
  } else if (options.still) {
    RefuseGivenExcept(command, {"--still", "--real", "--params", "--out", "--threads"}, "with --still");
  } else {
    RefuseGiven(command, noise_options, "without --noise-only");
    RefuseSceneFormatAlone(command);
    RefuseUnusedSegmentation(command, options.comparison.object);
  }
}

HtmlReport MakeReport(const RecordingFit& fit, const RecordingInfo& info, const Json& provenance) {
  HtmlReport report("Fit of a sonar's parameters", RecordingName(info));
  AddSyntheticCallout(report, info.synthetic, RecordingName(info));
  AddFitWarnings(report, fit.fit.report);
  AddFitKeyFigures(report, fit);
  report.Section("Before and after");
  AddFitComparison(report, fit);
  if (fit.choice) AddModelChoice(report, *fit.choice);
  AddUnexplained(report, fit);
  report.Section("Fitted values");
  AddFittedValues(report, fit);
  AddStillPoses(report, fit.still);
  AddMetricDefinitions(report, fit.after);
  EndReport(report, provenance);
  return report;
}

}  // namespace

FitConfig ResolveFitConfig(const FitCommandOptions& options, const ParameterSet& initial,
                           const Scene& scene) {
  FitConfig config = options.config.empty() ? FitConfig() : ReadFitConfig(options.config);
  if (!options.free.empty()) config.free = options.free;
  if (!config.free) {
    config.free = initial.model == EchoModel::kPaper ? PaperFreeByDefault()
                                                     : AcousticFreeByDefault(initial, scene.material_names);
  }
  if (!options.fixed.empty()) config.fixed = options.fixed;
  if (!options.held_out.empty()) config.held_out = options.held_out;
  return config;
}

RecordingFit FitAsAsked(const FitCommandOptions& options, const RecordingSource& recording,
                        const Scene& scene, const FitConfig& config, const ParameterSet& initial,
                        const FitListener& listener) {
  if (options.trust_all && initial.model != EchoModel::kAcoustic)
    throw UsageError("--trust-all has no effect: the paper's model counts all pixels in full");
  FitRecordingOptions fit_options{.rays = options.rays, .config = config, .fit = {}, .comparison = {}};
  fit_options.comparison = options.comparison.For(recording.info().sonar.axes);
  fit_options.choose = ResolveAxes(options.choose);
  fit_options.fit.max_iterations = options.max_iterations;
  fit_options.fit.starts = options.starts;
  fit_options.fit.threads = options.rays.threads;
  fit_options.fit.down_weight = !options.trust_all && initial.model == EchoModel::kAcoustic;
  fit_options.fit.progress = listener.say;
  fit_options.fit.stop = listener.stop;
  fit_options.on_note = listener.say;
  fit_options.on_trace = listener.on_trace;
  return FitRecording(recording, scene, initial, fit_options);
}

std::string FitJson(const RecordingFit& fit) {
  std::string extra;
  if (fit.fit.usable) {
    extra = fmt::format(R"("metrics_before": {}, "metrics_after": {})", MetricsJson(fit.before),
                        MetricsJson(fit.after));
    if (fit.sample_before && fit.sample_after) {
      extra += fmt::format(R"(, "sample_metrics_before": {}, "sample_metrics_after": {})",
                           MetricsJson(*fit.sample_before), MetricsJson(*fit.sample_after));
    }
    if (!fit.still.empty()) extra += ", " + StillMembers(fit.still);
  }
  if (fit.choice) {
    extra += fmt::format(R"({}"model_choice": {})", extra.empty() ? "" : ", ", ModelChoiceJson(*fit.choice));
  }
  return FitReportJson(fit.fit.report, extra);
}

ExitStatus RunFit(const FitCommandOptions& options) {
  if (options.noise_only && !options.choose.empty())
    throw UsageError("--choose is not for --noise-only, which chooses by itself");
  if (options.noise_only) return RunFitNoise(options);
  if (options.still) return RunFitStill(options);
  if (options.scene.empty()) throw UsageError("--scene is required, except with --noise-only or --still");
  if (options.params.empty()) throw UsageError("--params is required, except with --noise-only or --still");
  const ThreadLimit threads(options.rays.threads);
  const ParameterSet initial = ReadParameters(options.params);
  const auto recording = OpenRecording(options.real);
  const Scene scene = ReadSceneFile(options.scene, options.scene_format, options.common);
  const FitConfig config = ResolveFitConfig(options, initial, scene);
  for (const std::string& sentence : MirrorCaveats(initial, scene.material_names))
    PrintNote(options.common, sentence);
  RunOutput output(options.out, "fit", options.common.force);
  Progress progress("Tracing", recording->frame_count(), options.common);
  const RecordingFit fit =
      FitAsAsked(options, *recording, scene, config, initial,
                 {.say = [&](const std::string& sentence) { PrintNote(options.common, sentence); },
                  .on_trace = [&](int frames_done, int) { progress.Update(frames_done); },
                  .stop = {}});

  Provenance provenance{.command = "fit",
                        .configuration = ConfigurationJson(options, config, fit),
                        .inputs = {options.real, options.scene, options.params}};
  if (!options.config.empty()) provenance.inputs.push_back(options.config);
  const std::string fit_json = FitJson(fit);
  WriteFileWhole(output / "fit.json", fit_json);
  WriteProvenance(output.staging(), provenance);
  if (!fit.fit.usable) {
    output.Commit();
    PrintError(
        fmt::format("the fit ended without a usable solution ({}); {} tells more, and no parameters were "
                    "written",
                    fit.fit.report.termination.empty() ? "nothing could be told from the frames"
                                                       : fit.fit.report.termination,
                    (options.out / "fit.json").string()));
    return ExitStatus::kNoSolution;
  }
  WriteParameters(output / "params.json", fit.fit.parameters);
  if (!fit.poses.empty()) WritePoses(output / "poses.json", fit.poses);
  WriteReport(MakeReport(fit, recording->info(), ProvenanceToJson(provenance)), output.staging());
  output.Commit();

  if (options.common.json) {
    PrintJson(Json::parse(fit_json));
  } else {
    PrintResult(SummaryText(fit, RecordingName(recording->info()), options.out));
  }
  return ExitStatus::kDone;
}

void AddFitOptions(CLI::App* command, FitCommandOptions* options) {
  command
      ->add_option("--real", options->real,
                   "Recording to fit to; each frame needs a pose, except with --noise-only or --still")
      ->type_name("REC")
      ->required();
  AddSceneOptions(*command, options->scene, options->scene_format, "Scene, its materials by name",
                  /*required=*/false);
  command
      ->add_option("--params", options->params,
                   "Parameters to start from; with --noise-only its display is kept, with --still also its "
                   "looks and floor")
      ->type_name("JSON");
  AddOutFolder(*command, options->out, options->common, "Folder for parameters, fit and report")->required();
  command->add_option("--config", options->config, "What is free, its bounds, and which frames are held out")
      ->type_name("JSON");
  const auto add_list = [&](const char* name, auto& list, const char* description, const char* type) {
    command->add_option(name, list, description)->delimiter(',')->type_name(type)->allow_extra_args(false);
  };
  add_list("--held-out", options->held_out,
           "Frames the fit does not see, counted from 0 (default: the last third)", "N,N");
  add_list(
      "--free", options->free,
      "What is fitted: materials, noise, psf, mirrors, pose, mount, display, jitter, source_level, or names "
      "with * (default: materials, with the paper model display.db_max and the range and azimuth errors, "
      "with "
      "the acoustic model receiver.noise_db, mirrors and, where they are not given, pulse.length_m and "
      "beside "
      "mirrors beam.transmit_end_deg)",
      "NAME,NAME");
  add_list("--fixed", options->fixed, "What is not, though it is among the free (default: nothing)",
           "NAME,NAME");
  add_list(
      "--choose", options->choose,
      "Acoustic model: what is chosen by the likelihood of the held-out frames before the fit, one after "
      "the other: pattern (of the beams in azimuth), elevation, mirrors (lobes through which they are seen), "
      "looks, trend (of noise with range), display (default: nothing)",
      "NAME,NAME");
  CLI::Option* noise_only =
      command->add_flag("--noise-only", options->noise_only,
                        "Fit the noise floor, speckle and display law alone, to pings without targets");
  command
      ->add_flag("--still", options->still,
                 "Tell speckle from receiver noise alone, by frames of one pose whose scene stands still")
      ->excludes(noise_only);
  command->add_option("--range-min", options->range_min_m, "Noise only: nearest range used (default: all)")
      ->type_name("M");
  command->add_option("--range-max", options->range_max_m, "Noise only: farthest range used (default: all)")
      ->type_name("M");
  command->add_flag("--find-background", options->find_background,
                    "Noise only: find the window of range that holds no targets, by rule");
  command->add_flag(
      "--hold-out-bands", options->hold_out_bands,
      "Noise only: judge on every second band of 8 range bins, which is not fitted (default: of a "
      "single frame alone)");
  command
      ->add_option("--reject-beyond", options->reject_beyond,
                   "Noise only: leave out cells this many robust standard deviations off, 0 for none")
      ->type_name("N")
      ->check(CLI::Range(0.0, 100.0).description(""));
  command->add_flag("--trust-all", options->trust_all,
                    "Acoustic model: count all pixels in full, also those that the scene does not explain");
  AddRayOptions(*command, options->rays);
  command->add_option("--max-iterations", options->max_iterations, "Iterations of each solve at most")
      ->type_name("N")
      ->check(CLI::Range(1, 100000).description(""));
  command->add_option("--starts", options->starts, "Backscatter curves to start from, the best is kept")
      ->type_name("N")
      ->check(CLI::Range(1, 100).description(""));
  AddComparisonOptions(*command, options->comparison);
}

void SetupFit(CLI::App& app) {
  auto options = std::make_shared<FitCommandOptions>();
  CLI::App* command = AddCommand(
      app, "fit",
      "Fits the parameters of the model that --params names, paper or acoustic, to a recording with poses");
  AddFitOptions(command, options.get());
  OnRun(command, options->common, [command, options] {
    RefuseWithoutEffect(*command, *options);
    return RunFit(*options);
  });
}

}  // namespace sonarcal
