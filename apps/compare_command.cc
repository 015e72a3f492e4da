#include "apps/compare_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/against_text.h"
#include "apps/commands.h"
#include "apps/compare_recordings.h"
#include "apps/drawn_floor.h"
#include "apps/frame_gatherer.h"
#include "apps/frame_range.h"
#include "apps/given_options.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/report/against_section.h"
#include "apps/report/agreement_section.h"
#include "apps/report/comparison_section.h"
#include "apps/report/html_text.h"
#include "apps/report/paper_files.h"
#include "apps/report/report_end.h"
#include "apps/report/residual_section.h"
#include "apps/run_output.h"
#include "apps/scene_geometry.h"
#include "apps/shown_frames.h"
#include "apps/threshold_check.h"
#include "core/types/printable.h"
#include "data_io/files/atomic_output.h"
#include "data_io/files/file_bytes.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "metrics/figures.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxEarlierBytes = std::size_t{1} << 30;

Json ConfigurationJson(const CompareCommandOptions& options, const std::vector<int>& frames) {
  Json json = {{"real", options.real.string()},        {"simulated", options.simulated.string()},
               {"out", options.out.string()},          {"frames", frames},
               {"as_displayed", options.as_displayed}, {"pictures", options.pictures},
               {"sweep_steps", options.sweep_steps},   {"sweep_range", options.sweep_range}};
  for (const auto& [name, file] : {std::pair{"against", options.against}, std::pair{"scene", options.scene},
                                   std::pair{"params", options.params}}) {
    json[name] = file.empty() ? Json(nullptr) : Json(file.string());
  }
  json.update(SceneFormatJson(options.scene_format));
  json.update(ComparisonOptionsJson(options.comparison));
  return json;
}

SweepOptions SweepOf(const CompareCommandOptions& options) {
  SweepOptions sweep{.steps = options.sweep_steps, .low = {}, .high = {}};
  if (!options.sweep_range.empty()) {
    const Interval1d range = ParseInterval("--sweep-range", options.sweep_range);
    sweep.low = range.low;
    sweep.high = range.high;
  }
  if (options.sweep_csv && sweep.steps == 0) throw UsageError("--sweep-csv needs --sweep-steps of 2 or more");
  return sweep;
}

// "0.812 [0.780, 0.840]", or "none".
std::string WithInterval(const Statistic& statistic) {
  if (!statistic.value) return "none";
  if (!statistic.ci) return fmt::format("{:.3f}", *statistic.value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", *statistic.value, statistic.ci->lo, statistic.ci->hi);
}

std::string SummaryText(const MetricsReport& metrics) {
  const Aggregate& all = metrics.aggregate;
  const Aggregate* floor = metrics.noise_floor.Beside();
  std::string text = fmt::format("{} against {}, {} frame{}\n", metrics.simulated, metrics.real,
                                 all.frame_count, all.frame_count == 1 ? "" : "s");
  text += fmt::format("  {:<24}  {:<22}  {:<22}{}\n", "", "mean of frames", "pixels pooled",
                      floor != nullptr ? "  floor (mean)" : "");
  const auto add = [&](const char* label, const std::string& path, ViewSummary Aggregate::Views::*view) {
    text += fmt::format("  {:<24}  {:<22}  {:<22}{}\n", label, WithInterval((all.macro.*view).At(path)),
                        WithInterval((all.micro.*view).At(path)),
                        floor != nullptr ? "  " + WithInterval((floor->macro.*view).At(path)) : "");
  };
  using Views = Aggregate::Views;
  add("Ns/Nr", "ns_over_nr", &Views::polar);
  add("Na/Ns", "na_over_ns", &Views::polar);
  add("Na/Nr", "na_over_nr", &Views::polar);
  add("IoU", "iou", &Views::polar);
  const std::string error_path = IntensityErrorPath(metrics.options.intensity_domain);
  add("intensity error, polar", error_path, &Views::polar);
  add("intensity error, fan", error_path, &Views::fan);
  if (all.no_interval_reason.empty()) {
    text += "  in brackets: 95 % interval over frames\n";
  } else {
    text += "  no intervals: " + all.no_interval_reason + "\n";
  }
  return text;
}

HtmlReport MakeReport(const MetricsReport& metrics, const ShownFrames& shown, int pictured,
                      const Json& provenance) {
  HtmlReport report(fmt::format("Simulated against {} images", RealWord(metrics.real_is_synthetic)),
                    fmt::format("{} against {}", metrics.simulated, metrics.real));
  AddSyntheticCallout(report, metrics.real_is_synthetic, metrics.real);
  report.List(SummaryInWords(metrics));
  AddKeyFigures(report, metrics);
  report.Section("Agreement");
  AddMetricTables(report, metrics);
  if (metrics.against) AddAgainst(report, *metrics.against);
  report.Section("Pictures");
  report.Paragraph(fmt::format(
      "The frames with the lowest, the middle and the highest intensity error are shown below; pictures of "
      "{} lie beside this page.",
      pictured == metrics.aggregate.frame_count
          ? "all frames"
          : fmt::format("{} of the {} frames, evenly spread,", pictured, metrics.aggregate.frame_count)));
  AddPictureLegend(report, RealWord(metrics.real_is_synthetic));
  if (!shown.viewer.frames.empty()) report.Add(shown.viewer);
  for (const FramePictures& frame : shown.telling) {
    AddFramePictures(report, frame, fmt::format("Frame {}", frame.index), metrics.real_is_synthetic);
  }
  report.Section("Where the simulation is wrong");
  AddResiduals(report, metrics);
  report.Section("Grey values");
  AddGreyLevels(report, metrics);
  if (metrics.sweep) report.Section("Other thresholds");
  AddThresholdSweep(report, metrics);
  report.Section("Every figure");
  AddEveryFigure(report, metrics);
  AddMetricDefinitions(report, metrics);
  EndReport(report, provenance);
  return report;
}

// Frames of the comma-separated ranges; all frames if empty.
std::vector<int> AskedFrames(const std::string& ranges, const RecordingSource& real,
                             const RecordingSource& simulated) {
  std::vector<int> frames;
  if (ranges.empty()) return frames;
  std::stringstream parts(ranges);
  for (std::string part; std::getline(parts, part, ',');) {
    const FrameRange asked = ParseFrameRange(part, std::min(real.frame_count(), simulated.frame_count()));
    for (int frame = asked.begin; frame < asked.end; ++frame) {
      if (std::find(frames.begin(), frames.end(), frame) != frames.end())
        throw UsageError("--frames '{}' names frame {} twice", Printable(ranges), frame);
      frames.push_back(frame);
    }
  }
  return frames;
}

// Scene of --scene. With --object, the scene that a recording names. Nullopt if there is neither.
std::optional<SceneGeometry> SceneOf(const CompareCommandOptions& options, const RecordingSource& real,
                                     const RecordingSource& simulated) {
  std::filesystem::path scene = options.scene;
  const bool with_object = !options.comparison.object.object.empty();
  for (const RecordingSource* recording : {&simulated, &real}) {
    if (scene.empty() && with_object) scene = recording->info().scene_path.value_or("");
  }
  if (scene.empty() && with_object) {
    throw UsageError("--object needs --scene, because neither recording names its scene");
  }
  if (scene.empty()) return std::nullopt;
  return std::optional<SceneGeometry>(
      std::in_place, ReadSceneFile(scene, options.scene_format, options.common), real.info().sonar);
}

// Poses of the simulation. If it states none, poses of the real recording.
std::vector<TimedPose> ObjectPoses(const RecordingSource& real, const RecordingSource& simulated) {
  const bool states_pose =
      simulated.frame_count() > 0 && simulated.frame_info(0).world_from_sonar.has_value();
  return PosesOfRecording(states_pose ? simulated : real);
}

}  // namespace

Comparison MeasureComparison(const CompareCommandOptions& options, const RecordingSource& real,
                             const RecordingSource& simulated, const std::filesystem::path& pictures,
                             const std::function<void(int, int)>& progress) {
  Comparison comparison{.options = {.compare = options.comparison.For(real.info().sonar.axes),
                                    .as_displayed = options.as_displayed},
                        .frames = {},
                        .metrics = {}};
  CompareRecordingsOptions& compare = comparison.options;
  compare.compare.sweep = SweepOf(options);
  compare.compare.Check();
  compare.frames = AskedFrames(options.frames, real, simulated);
  comparison.frames = FramesToCompare(real, simulated, compare.frames);
  const int frames_in_all = static_cast<int>(comparison.frames.size());
  // Read before the work begins, so that a wrong one costs no time.
  std::string earlier;
  if (!options.against.empty()) earlier = ReadFileBytes(options.against, kMaxEarlierBytes);
  std::optional<ParameterSet> parameters;
  if (!options.params.empty()) parameters = ReadParameters(options.params);

  if (progress) {
    progress(0, frames_in_all);
    compare.progress = [&](int frames_done) { progress(frames_done, frames_in_all); };
  }
  const std::optional<SceneGeometry> scene = SceneOf(options, real, simulated);
  if (compare.compare.object) {
    compare.boxes = scene->ObjectBoxes(ObjectPoses(real, simulated), *compare.compare.object);
  }
  FrameGatherer gatherer(options, real, simulated, comparison.frames, pictures,
                         scene && !options.scene.empty() ? &*scene : nullptr);
  MetricsReport& metrics = comparison.metrics;
  metrics = CompareRecordings(real, simulated, compare,
                              [&](const PolarImage& recorded, const PolarImage& rendered,
                                  const FrameMetrics& frame) { gatherer.Add(recorded, rendered, frame); });
  compare.progress = {};
  gatherer.MoveInto(metrics);
  if (parameters) {
    metrics.noise_floor.drawn =
        DrawFloor(simulated, comparison.frames, *parameters, metrics.options, compare.boxes);
  }
  if (!options.against.empty()) metrics.against = CompareAgainst(metrics, earlier, options.against.string());
  return comparison;
}

ExitStatus RunCompare(const CompareCommandOptions& options) {
  const std::vector<Threshold> thresholds = ParseThresholds(options.fail_above);
  const auto real = OpenRecording(options.real);
  const auto simulated = OpenRecording(options.simulated);
  RunOutput output(options.out, "compare", options.common.force);
  std::optional<Progress> progress;
  Comparison comparison = MeasureComparison(
      options, *real, *simulated, output.staging(), [&](int frames_done, int frames_in_all) {
        if (!progress) progress.emplace("Comparing", frames_in_all, options.common, "frames");
        progress->Update(frames_done);
      });
  progress.reset();
  MetricsReport& metrics = comparison.metrics;

  const ShownFrames shown = ShowFrames(*real, *simulated, comparison.options, metrics, TellingFrames(metrics),
                                       metrics.frames.size());

  std::vector<std::filesystem::path> inputs = {options.real, options.simulated};
  for (const std::filesystem::path& file :
       {options.against, options.scene, options.params, options.comparison.object.background_params}) {
    if (!file.empty()) inputs.push_back(file);
  }
  const Provenance provenance{.command = "compare",
                              .configuration = ConfigurationJson(options, comparison.frames),
                              .inputs = std::move(inputs)};
  WriteFileWhole(output / "metrics.json", MetricsJson(metrics));
  WriteFileWhole(output / "residuals.csv", ResidualsCsv(AllResiduals(metrics)));
  if (options.sweep_csv) WriteFileWhole(output / "threshold_sweep.csv", metrics.sweep.value().Csv());
  WriteFileWhole(output / "per_frame.csv", PerFrameCsv(metrics.frames, metrics.options.intensity_domain));
  const int pictured = std::min(options.pictures, metrics.aggregate.frame_count);
  const HtmlReport report = MakeReport(metrics, shown, pictured, ProvenanceToJson(provenance));
  WriteReport(report, output.staging());
  WriteProvenance(output.staging(), provenance);
  const std::vector<std::string> passed =
      thresholds.empty() ? std::vector<std::string>()
                         : PassedThresholds(thresholds, Json::parse(MetricsSummaryJson(metrics)));
  output.Commit();

  for (const std::string& note : metrics.notes) PrintNote(options.common, "note: " + note);
  if (options.common.json) {
    PrintResult(MetricsJson(metrics));
  } else {
    PrintResult(SummaryText(metrics));
    if (metrics.against) PrintResult(AgainstText(*metrics.against));
    PrintResult(fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  for (const std::string& sentence : passed) PrintError("threshold passed: " + sentence);
  return passed.empty() ? ExitStatus::kDone : ExitStatus::kThreshold;
}

void AddCompareOptions(CLI::App* command, CompareCommandOptions* options) {
  command->add_option("--real", options->real, "Recording of the sonar")->type_name("REC")->required();
  command->add_option("--sim", options->simulated, "Recording of the simulation, frames in the same order")
      ->type_name("REC")
      ->required();
  AddOutFolder(*command, options->out, options->common, "Folder for metrics, pictures and report")
      ->required();
  command
      ->add_option("--frames", options->frames,
                   "Frames of both: from A, counted from 0, up to but without B, or several such ranges "
                   "(default: all)")
      ->type_name("A:B,...");
  AddComparisonOptions(*command, options->comparison);
  command
      ->add_option("--sweep-steps", options->sweep_steps,
                   "Settings of the segmentation's threshold to give each ratio at, as a curve; 0 for none")
      ->type_name("N");
  command
      ->add_option("--sweep-range", options->sweep_range,
                   "Lowest and highest of these, in the unit of the segmentation's own setting (default: by "
                   "method)")
      ->type_name("A:B");
  command->add_flag("--sweep-csv", options->sweep_csv, "Write the curves to threshold_sweep.csv too");
  command->add_flag("--as-displayed", options->as_displayed,
                    "Compare grey levels although the two state different dB scales");
  command
      ->add_option("--pictures", options->pictures,
                   "Frames that get pictures, evenly spread over those compared; 0 for none")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber.description(""));
  command
      ->add_option(
          "--against", options->against,
          "metrics.json of an earlier comparison: says what got better or worse, and whether by more "
          "than the noise")
      ->type_name("JSON");
  AddSceneOptions(*command, options->scene, options->scene_format,
                  "Scene of the recording, to tell the difference by incidence angle and material, and for "
                  "--object (default for --object: the one that a recording names)",
                  false);
  command
      ->add_option(
          "--params", options->params,
          "Fitted parameters, whose speckle, drawn about the simulated frames (which show the mean), "
          "gives a floor where no frames of a still scene do")
      ->type_name("JSON");
  command
      ->add_option("--fail-above", options->fail_above,
                   "End with status 4 where a figure of metrics.json is above a value, such as "
                   "intensity_error.polar=0.1 or against.worse=0")
      ->type_name("NAME=VALUE");
}

void SetupCompare(CLI::App& app) {
  auto options = std::make_shared<CompareCommandOptions>();
  CLI::App* command =
      AddCommand(app, "compare", "Measures how well a simulated recording agrees with a real one");
  AddCompareOptions(command, options.get());
  OnRun(command, options->common, [command, options] {
    if (options->sweep_steps == 0)
      RefuseGiven(*command, {"--sweep-range", "--sweep-csv"}, "without --sweep-steps");
    RefuseSceneFormatAlone(*command);
    RefuseUnusedSegmentation(*command, options->comparison.object);
    return RunCompare(*options);
  });
}

}  // namespace sonarcal
