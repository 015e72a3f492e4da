#include "apps/commands/compare_command.h"

#include <fmt/format.h>

#include <algorithm>
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
#include "apps/report/html/html_text.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/report_end.h"
#include "apps/report/pictures/comparison_pictures.h"
#include "apps/report/pictures/shown_frames.h"
#include "apps/report/sections/against_section.h"
#include "apps/report/sections/against_text.h"
#include "apps/report/sections/agreement_section.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/figure_words.h"
#include "apps/report/sections/residual_section.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/parts/compare_parts.h"
#include "apps/workflow/scene_geometry.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "metrics/figures.h"
#include "metrics/json/threshold_check.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

Json ConfigurationJson(const CompareCommandOptions& options, const std::vector<int>& frames) {
  Json json = {{"real", options.real.string()},
               {"sonar", options.sonar},
               {"simulated", options.simulated.string()},
               {"out", options.out.string()},
               {"frames", frames},
               {"pictures", options.pictures},
               {"scene", options.scene.empty() ? Json(nullptr) : Json(options.scene.string())}};
  json.update(cli::SceneFormatJson(options.scene_format));
  json.update(cli::OptionsJson(options.compare));
  return json;
}

// Text such as "0.812 [0.780, 0.840]"; "none" without a value.
std::string WithInterval(const metrics::Statistic& statistic) {
  if (!statistic.value) return "none";
  if (!statistic.ci) return fmt::format("{:.3f}", *statistic.value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", *statistic.value, statistic.ci->lo, statistic.ci->hi);
}

std::string SummaryText(const metrics::MetricsReport& metrics) {
  const metrics::Aggregate& all = metrics.aggregate;
  const metrics::Aggregate* floor = metrics.noise_floor.Beside();
  std::string text = fmt::format("{} against {}, {} frame{}\n", metrics.simulated, metrics.real,
                                 all.frame_count, all.frame_count == 1 ? "" : "s");
  constexpr auto kRow = "  {:<26}  {:<24}  {:<24}{}\n";
  text += fmt::format(kRow, "", "mean of frames", "pixels pooled", floor != nullptr ? "  floor (mean)" : "");
  const auto add = [&](const std::string& label, const std::string& path,
                       metrics::ViewSummary metrics::Aggregate::Views::*view) {
    text += fmt::format(kRow, label, WithInterval((all.macro.*view).At(path)),
                        WithInterval((all.micro.*view).At(path)),
                        floor != nullptr ? "  " + WithInterval((floor->macro.*view).At(path)) : "");
  };
  using Views = metrics::Aggregate::Views;
  add("Ns/Nr", "ns_over_nr", &Views::polar);
  add("Na/Ns", "na_over_ns", &Views::polar);
  add("Na/Nr", "na_over_nr", &Views::polar);
  add("IoU", "iou", &Views::polar);
  const std::string error_path = metrics::IntensityErrorPath(metrics.options.intensity_domain);
  add("intensity error, polar", error_path, &Views::polar);
  add("intensity error, fan", error_path, &Views::fan);
  text += "  figures that others quote, polar\n";
  for (const std::string& path : metrics::QuotedFigures()) {
    add(report::LabelWithUnit(metrics::Figures()[metrics::FigureIndex(path)]), path, &Views::polar);
  }
  if (all.no_interval_reason.empty()) {
    text += "  in brackets: 95 % interval over frames\n";
  } else {
    text += "  no intervals: " + all.no_interval_reason + "\n";
  }
  return text;
}

report::HtmlReport MakeReport(const metrics::MetricsReport& metrics, const report::ShownFrames& shown,
                              int pictured, const Json& provenance) {
  report::HtmlReport report(
      fmt::format("Simulated against {} images", report::RealWord(metrics.real_is_synthetic)),
      fmt::format("{} against {}", metrics.simulated, metrics.real));
  std::vector<std::string> sentences = report::SummaryInWords(metrics);
  if (!shown.examples.empty()) {
    const std::size_t first = std::min<std::size_t>(2, sentences.size());
    report::AddOpening(report, report::MiddleFrame(shown.examples, metrics.options.intensity_domain),
                       "with the middle intensity error", metrics.real_is_synthetic,
                       {sentences.begin(), sentences.begin() + static_cast<std::ptrdiff_t>(first)});
    sentences.erase(sentences.begin(), sentences.begin() + static_cast<std::ptrdiff_t>(first));
  }
  report::AddSyntheticCallout(report, metrics.real_is_synthetic, metrics.real);
  report.List(sentences);
  report::AddKeyFigures(report, metrics);
  report.Section("Agreement");
  report::AddMetricTables(report, metrics);
  if (metrics.against) report::AddAgainst(report, *metrics.against);
  report.Section("Pictures");
  report.Paragraph(fmt::format(
      "The frames with the lowest, the middle and the highest intensity error are shown below; pictures of "
      "{} lie beside this page.",
      pictured == metrics.aggregate.frame_count
          ? "all frames"
          : fmt::format("{} of the {} frames, evenly spread,", pictured, metrics.aggregate.frame_count)));
  report::AddPictureLegend(report, report::RealWord(metrics.real_is_synthetic));
  if (!shown.viewer.frames.empty()) report.Add(shown.viewer);
  for (const workflow::ComparedFrame& frame : shown.examples) {
    report::AddFramePictures(report, frame, fmt::format("Frame {}", frame.metrics.index),
                             metrics.real_is_synthetic);
  }
  report.Section("Where the simulation is wrong");
  report::AddResiduals(report, metrics);
  report.Section("Grey values");
  report::AddGreyLevels(report, metrics);
  if (metrics.sweep) report.Section("Other thresholds");
  report::AddThresholdSweep(report, metrics);
  report.Section("Every figure");
  report::AddEveryFigure(report, metrics);
  report::AddMetricDefinitions(report, metrics);
  report::EndReport(report, provenance);
  return report;
}

// Recording and options of a comparison, which are the same in all of its parts.
std::string ComparedText(const CompareCommandOptions& options) {
  Json json = ConfigurationJson(options, {});
  for (const char* of_part : {"simulated", "out", "pictures", "against", "params"}) json.erase(of_part);
  return data_io::JsonLine(json);
}

// The pair of recordings, and what parts measured of it.
struct Compared {
  std::unique_ptr<RecordingSource> real;
  std::unique_ptr<RecordingSource> simulated;
  std::vector<int> frames;
  std::optional<metrics::ComparisonPart> measured;  // with --merge
};

Compared OpenCompared(const CompareCommandOptions& options) {
  Compared compared;
  compared.real = workflow::OpenRecordingWith(options.real, options.sonar);
  const RecordingSource& real = *compared.real;
  if (options.merge.empty()) {
    compared.simulated = data_io::OpenRecording(options.simulated);
    // A part of a simulation is shorter than the recording.
    compared.frames = options.frames.In(
        options.part ? real.frame_count() : std::min(real.frame_count(), compared.simulated->frame_count()));
    if (options.part)
      compared.simulated = workflow::WithNumbersOf(real, std::move(compared.simulated), compared.frames);
    return compared;
  }
  std::vector<metrics::ComparisonPart> parts = workflow::ReadParts(options.merge);
  compared.simulated = workflow::SimulatedOfParts(real, parts);
  compared.measured = metrics::MergedParts(std::move(parts));
  workflow::CheckWhole(real, *compared.measured);
  if (compared.measured->compared != ComparedText(options))
    throw DataError("--merge: the parts compare {}, expected the options given here, {}",
                    compared.measured->compared, ComparedText(options));
  for (const metrics::FrameMetrics& frame : compared.measured->frames) compared.frames.push_back(frame.index);
  return compared;
}

// Scene of --scene. With --object, the scene that a recording names. Empty if there is neither.
std::filesystem::path SceneFileOf(const CompareCommandOptions& options, const RecordingSource& real,
                                  const RecordingSource& simulated) {
  std::filesystem::path scene = options.scene;
  const bool with_object = !options.compare.comparison.object.empty();
  for (const RecordingSource* recording : {&simulated, &real}) {
    if (scene.empty() && with_object) scene = recording->info().scene_path.value_or("");
  }
  return scene;
}

}  // namespace

cli::ExitStatus RunCompare(const CompareCommandOptions& options) {
  const std::vector<metrics::Threshold> thresholds = metrics::ParseThresholds(options.fail_above);
  const Compared compared = OpenCompared(options);
  const RecordingSource* real = compared.real.get();
  const RecordingSource* simulated = compared.simulated.get();
  if (options.sweep_csv && options.compare.sweep_steps == 0)
    throw UsageError("--sweep-csv needs --sweep-steps of 2 or more");
  workflow::CompareOptions compare = options.compare;
  compare.frames = compared.frames;
  compare.whole = !options.part;
  if (compared.measured) compare.measured = &*compared.measured;
  const std::filesystem::path scene_file = SceneFileOf(options, *real, *simulated);
  std::optional<Scene> scene;
  if (!scene_file.empty()) scene = cli::ReadSceneFile(scene_file, options.scene_format, options.common);
  cli::RunOutput output(options.out, "compare", options.common.force);
  std::optional<cli::Progress> progress;
  const workflow::Listener listener{.progress = [&](const std::string& step, int done, int total) {
    if (!progress) progress.emplace(step, total, options.common, "frames");
    progress->Update(done);
  }};
  const std::vector<int> pictured =
      workflow::EvenlySpread(workflow::FramesToCompare(*real, *simulated, compare.frames), options.pictures);
  metrics::ComparisonPart part;
  part.compared = ComparedText(options);
  part.simulated = options.simulated.string();
  workflow::Comparison comparison = workflow::Compare(
      *real, *simulated, compare, scene ? &*scene : nullptr, !options.scene.empty(), listener,
      [&](const PolarImage& recorded, const PolarImage& rendered, const metrics::FrameMetrics& frame) {
        if (std::ranges::find(pictured, frame.index) != pictured.end())
          report::WritePictures(output.staging(), recorded, rendered, frame);
        if (options.part) part.Add(frame);
      });
  progress.reset();
  if (compared.measured && !pictured.empty()) {
    workflow::CompareAgain(
        *real, *simulated, comparison.options, pictured,
        [&](const PolarImage& recorded, const PolarImage& rendered, const metrics::FrameMetrics& frame) {
          report::WritePictures(output.staging(), recorded, rendered, frame);
        });
  }
  metrics::MetricsReport& metrics = comparison.metrics;
  if (options.part) {
    part.residuals = metrics.residuals;
    part.residuals_by_scene = metrics.residuals_by_scene;
    part.notes = metrics.notes;
    data_io::WriteFileWhole(output / workflow::kPartFile, metrics::ComparisonPartBytes(part));
  }

  const report::ShownFrames shown = report::ShowFrames(*real, *simulated, comparison.options, metrics,
                                                       workflow::RepresentativeFrames(metrics));

  std::vector<std::filesystem::path> inputs = {options.real, cli::SonarFile(options.sonar), options.simulated,
                                               scene_file};
  inputs.insert(inputs.end(), options.merge.begin(), options.merge.end());
  const std::vector<std::filesystem::path> of_options = cli::OptionFiles(options.compare);
  inputs.insert(inputs.end(), of_options.begin(), of_options.end());
  const cli::Provenance provenance{.command = "compare",
                                   .configuration = ConfigurationJson(options, comparison.frames),
                                   .inputs = std::move(inputs)};
  data_io::WriteFileWhole(output / "metrics.json", metrics::MetricsJson(metrics));
  data_io::WriteFileWhole(output / "residuals.csv", metrics::ResidualsCsv(workflow::AllResiduals(metrics)));
  if (options.sweep_csv) data_io::WriteFileWhole(output / "threshold_sweep.csv", metrics.sweep.value().Csv());
  data_io::WriteFileWhole(output / "per_frame.csv",
                          metrics::PerFrameCsv(metrics.frames, metrics.options.intensity_domain));
  const report::HtmlReport report =
      MakeReport(metrics, shown, static_cast<int>(pictured.size()), cli::ProvenanceToJson(provenance));
  report::WriteReport(report, output.staging());
  cli::WriteProvenance(output.staging(), provenance);
  output.Commit();  // before a threshold whose figure is unknown ends the command
  const std::vector<std::string> passed =
      thresholds.empty()
          ? std::vector<std::string>()
          : metrics::PassedThresholds(thresholds, Json::parse(metrics::MetricsSummaryJson(metrics)));

  for (const std::string& note : metrics.notes) cli::PrintNote(options.common, "note: " + note);
  if (options.common.json) {
    cli::PrintResult(metrics::MetricsJson(metrics));
  } else {
    cli::PrintResult(SummaryText(metrics));
    if (metrics.against) cli::PrintResult(report::AgainstText(*metrics.against));
    cli::PrintResult(fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  for (const std::string& sentence : passed) cli::PrintError("threshold passed: " + sentence);
  return passed.empty() ? cli::ExitStatus::kDone : cli::ExitStatus::kThreshold;
}

namespace {

void AddCompareOptions(CLI::App* command, CompareCommandOptions* options) {
  command->add_option("--real", options->real, "Recording of the sonar")->type_name("REC")->required();
  cli::AddSonarOfRecording(*command, options->sonar);
  command
      ->add_option("--sim", options->simulated,
                   "Recording of the simulation, frames in the same order; required without --merge")
      ->type_name("REC");
  cli::AddOutFolder(*command, options->out, options->common, "Folder for metrics, pictures and report")
      ->required();
  cli::AddFrames(*command, options->frames, "Frames to compare, of both recordings");
  cli::AddOptions(*command, options->compare);
  command->add_flag("--sweep-csv", options->sweep_csv, "Write the curves to threshold_sweep.csv too");
  command
      ->add_option("--pictures", options->pictures,
                   "Max number of frames with pictures, evenly spread over those compared; 0 for none")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber.description(""));
  command->add_flag("--part", options->part,
                    "Measure a part of a long recording for --merge: writes part.bin, and no noise floor. "
                    "--sim may hold just the frames of --frames");
  command
      ->add_option("--merge", options->merge,
                   "Folders of --part runs with the same options, which together have all frames")
      ->type_name("DIR,DIR")
      ->delimiter(',');
  cli::AddSceneOptions(*command, options->scene, options->scene_format,
                       "Scene of the recording, for residuals by incidence angle and material, and for "
                       "--object (default for --object: the scene that a recording names)",
                       false);
  command
      ->add_option("--fail-above", options->fail_above,
                   "End with status 4 if a figure of metrics.json is above a value, such as "
                   "intensity_error.polar=0.1 or against.worse=0")
      ->type_name("NAME=VALUE");
}

}  // namespace

void SetupCompare(CLI::App& app) {
  auto options = std::make_shared<CompareCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "compare", "Measures how well a simulated recording agrees with a real one");
  AddCompareOptions(command, options.get());
  cli::OnRun(command, options->common, [command, options] {
    if (options->compare.sweep_steps == 0)
      cli::RefuseGiven(*command, {"--sweep-range", "--sweep-csv"}, "without --sweep-steps");
    if (options->merge.empty() == options->simulated.empty())
      throw UsageError("expected either --sim or --merge");
    if (!options->merge.empty()) cli::RefuseGiven(*command, {"--frames", "--part"}, "with --merge");
    cli::RefuseSceneFormatAlone(*command);
    cli::RefuseUnusedSegmentation(*command, options->compare.comparison);
    return RunCompare(*options);
  });
}

}  // namespace sonarcal::commands
