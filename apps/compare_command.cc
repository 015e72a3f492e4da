#include "apps/compare_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/compare_recordings.h"
#include "apps/comparison_pictures.h"
#include "apps/frame_range.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/report/comparison_section.h"
#include "apps/report/report_end.h"
#include "apps/run_output.h"
#include "apps/threshold_check.h"
#include "data_io/atomic_output.h"
#include "data_io/open_recording.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

Json ConfigurationJson(const CompareCommandOptions& options, const std::vector<int>& frames) {
  Json json = {{"real", options.real.string()},        {"simulated", options.simulated.string()},
               {"out", options.out.string()},          {"frames", frames},
               {"as_displayed", options.as_displayed}, {"sweep_steps", options.sweep_steps},
               {"sweep_range", options.sweep_range}};
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
std::string FigureText(const Statistic& statistic) {
  if (!statistic.value) return "none";
  if (!statistic.ci) return fmt::format("{:.3f}", *statistic.value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", *statistic.value, statistic.ci->lo, statistic.ci->hi);
}

std::string SummaryText(const MetricsReport& metrics, const std::filesystem::path& out) {
  const Aggregate& all = metrics.aggregate;
  const IntensityDomain domain = metrics.options.intensity_domain;
  std::string text = fmt::format("{} against {}, {} frame{}\n", metrics.simulated, metrics.real,
                                 all.frame_count, all.frame_count == 1 ? "" : "s");
  text += fmt::format("  {:<24}  {:<22}  {}\n", "", "mean of frames", "pixels pooled");
  const auto add = [&](const char* label, const Statistic& macro, const Statistic& micro) {
    text += fmt::format("  {:<24}  {:<22}  {}\n", label, FigureText(macro), FigureText(micro));
  };
  const ViewSummary& macro = all.macro.polar;
  const ViewSummary& micro = all.micro.polar;
  add("Ns/Nr", macro.At("ns_over_nr"), micro.At("ns_over_nr"));
  add("Na/Ns", macro.At("na_over_ns"), micro.At("na_over_ns"));
  add("Na/Nr", macro.At("na_over_nr"), micro.At("na_over_nr"));
  add("IoU", macro.At("iou"), micro.At("iou"));
  add("intensity error, polar", macro.Over(domain).mean_absolute, micro.Over(domain).mean_absolute);
  add("intensity error, fan", all.macro.fan.Over(domain).mean_absolute,
      all.micro.fan.Over(domain).mean_absolute);
  if (all.no_interval_reason.empty()) {
    text += "  in brackets: 95 % interval over frames\n";
  } else {
    text += "  no intervals: " + all.no_interval_reason + "\n";
  }
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

HtmlReport MakeReport(const MetricsReport& metrics, const std::vector<FramePictures>& pictures,
                      bool real_is_synthetic, const Json& provenance) {
  HtmlReport report("Simulated against recorded",
                    fmt::format("{} against {}", metrics.simulated, metrics.real));
  AddSyntheticCallout(report, real_is_synthetic, metrics.real);
  AddKeyFigures(report, metrics);
  report.Section("Agreement");
  AddMetricTables(report, metrics);
  report.Section("Pictures");
  report.Paragraph(
      "Shown are the frames with the lowest, the middle and the highest intensity error; the "
      "pictures of all frames lie beside this page.");
  AddPictureLegend(report);
  for (const FramePictures& frame : pictures) {
    AddFramePictures(report, frame, fmt::format("Frame {}", frame.index));
  }
  AddMetricDefinitions(report, metrics);
  EndReport(report, provenance);
  return report;
}

}  // namespace

ExitStatus RunCompare(const CompareCommandOptions& options) {
  const std::vector<Threshold> thresholds = ParseThresholds(options.fail_above);
  const auto real = OpenRecording(options.real);
  const auto simulated = OpenRecording(options.simulated);
  CompareRecordingsOptions compare{.compare = options.comparison.For(real->info().sonar.axes),
                                   .as_displayed = options.as_displayed};
  compare.compare.sweep = SweepOf(options);
  compare.compare.Check();
  if (!options.frames.empty()) {
    const int common = std::min(real->frame_count(), simulated->frame_count());
    const FrameRange range = ParseFrameRange(options.frames, common);
    for (int frame = range.begin; frame < range.end; ++frame) compare.frames.push_back(frame);
  }

  RunOutput output(options.out);
  PictureMaker maker;
  MetricsReport metrics;
  {
    Progress progress("Comparing",
                      compare.frames.empty() ? real->frame_count() : static_cast<int>(compare.frames.size()),
                      options.common);
    compare.progress = [&](int frames_done) { progress.Update(frames_done); };
    metrics = CompareRecordings(
        *real, *simulated, compare,
        [&](const PolarImage& recorded, const PolarImage& rendered, const FrameMetrics& frame) {
          WritePictures(output.staging(), maker.Make(recorded, rendered, frame));
        });
  }

  // Kept pictures of every frame would grow with the recording: those of the report are made again.
  CompareRecordingsOptions again = compare;
  again.frames = TellingFrames(metrics);
  again.noise_floor = false;
  again.compare.sweep = {};
  again.progress = {};
  std::vector<FramePictures> telling;
  CompareRecordings(*real, *simulated, again,
                    [&](const PolarImage& recorded, const PolarImage& rendered, const FrameMetrics& frame) {
                      telling.push_back(maker.Make(recorded, rendered, frame));
                    });

  std::vector<int> frames;
  for (const FrameMetrics& frame : metrics.frames) frames.push_back(frame.index);
  Provenance provenance{.command = "compare",
                        .configuration = ConfigurationJson(options, frames),
                        .inputs = {options.real, options.simulated}};
  if (!options.comparison.object.background_params.empty()) {
    provenance.inputs.push_back(options.comparison.object.background_params);
  }
  const std::string metrics_text = MetricsJson(metrics);
  WriteFileWhole(output / "metrics.json", metrics_text);
  if (options.sweep_csv) WriteFileWhole(output / "threshold_sweep.csv", metrics.sweep.value().Csv());
  WriteFileWhole(output / "per_frame.csv", PerFrameCsv(metrics.frames, metrics.options.intensity_domain));
  MakeReport(metrics, telling, real->info().synthetic, ProvenanceToJson(provenance))
      .Write(output / "report.html");
  WriteProvenance(output.staging(), provenance);
  const Json metrics_json = Json::parse(metrics_text);
  const std::vector<std::string> passed = PassedThresholds(thresholds, metrics_json);
  output.Commit();

  for (const std::string& note : metrics.notes) PrintNote(options.common, "note: " + note);
  if (options.common.json) {
    PrintJson(metrics_json);
  } else {
    PrintResult(SummaryText(metrics, options.out));
  }
  for (const std::string& sentence : passed) PrintError("threshold passed: " + sentence);
  return passed.empty() ? ExitStatus::kDone : ExitStatus::kThreshold;
}

void SetupCompare(CLI::App& app) {
  auto options = std::make_shared<CompareCommandOptions>();
  CLI::App* command =
      AddCommand(app, "compare", "Measures how well a simulated recording agrees with a real one");
  command->add_option("--real", options->real, "Recording of the sonar")->type_name("REC")->required();
  command->add_option("--sim", options->simulated, "Recording of the simulation, frames in the same order")
      ->type_name("REC")
      ->required();
  command->add_option("--out", options->out, "Folder for metrics, pictures and report")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--frames", options->frames,
                   "Frames of both: from A, counted from 0, up to but without B; all if not given")
      ->type_name("A:B");
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
      ->add_option("--fail-above", options->fail_above,
                   "End with status 4 where a figure of metrics.json is above a value, such as "
                   "intensity_error.polar=0.1")
      ->type_name("NAME=VALUE");
  OnRun(command, options->common, [options] { return RunCompare(*options); });
}

}  // namespace sonarcal
