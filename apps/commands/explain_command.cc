// `sonarcal explain`: ablation study of the acoustic model on a recording, and the causes of its bright
// pixels (apps/workflow/explain.h).
//
// Writes:
//
//   explain.json             "format": "sonar-explanation/1"; "steps", each with its figures on the held-out
//                            frames ("by_frame" also per frame), "gain_nats_per_pixel", "aic_change",
//                            "bic_change" and "verdict"; "causes" with "names" and, per frame, shares of the
//                            bright pixels
//   causes_0006.png          index into the names for each pixel of frame 6, range bins x beams
//   lobes_0006.png           16 bits; if the cause is a side lobe in azimuth, the beam in whose direction the
//                            echo lies, counted from 1; else 0
//   causes_0006_picture.png  the map with its legend
//   params.json              of the last step
//   report.html
//   recording/               with --known: the recording with its poses, scene.gltf and params.json, as input
//                            for other commands
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/given_options.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/scene_option.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/report_end.h"
#include "apps/report/pictures/cause_pictures.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/explain_section.h"
#include "apps/reproduce/prepared_recording.h"
#include "apps/workflow/explain.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_catalogue.h"

namespace sonarcal::commands {
namespace {

struct ExplainCommandOptions {
  cli::CommonOptions common;
  std::string known;                 // name of a case, instead of real, scene and params
  std::filesystem::path recordings;  // folder of the recordings; empty: DefaultRecordingsFolder()
  std::filesystem::path real;
  std::string sonar;  // in place of that of `real`; empty: as recorded
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::filesystem::path params;
  std::filesystem::path out;
  bool apart = false;  // evaluates the held-out frames one by one
  workflow::ExplainOptions explain;
};

using Json = nlohmann::ordered_json;

// Input of the study, from files or one of the known recordings.
struct Subject {
  std::unique_ptr<RecordingSource> recording;
  Scene scene;
  ParameterSet given;
  workflow::ExplainOptions options;  // as stored in provenance
  workflow::ExplainRecordingOptions explain;
  report::ExplanationPresentation presentation;
  std::vector<std::filesystem::path> inputs;
};

void CheckSubject(const ExplainCommandOptions& options) {
  const std::pair<const char*, bool> files[] = {{"--real", !options.real.empty()},
                                                {"--scene", !options.scene.empty()},
                                                {"--params", !options.params.empty()}};
  if (!options.sonar.empty() && !options.known.empty())
    throw UsageError("--sonar does not go with --known, which has its own");
  for (const auto& [name, is_given] : files) {
    if (is_given && !options.known.empty())
      throw UsageError("{} does not go with --known, which has its own", name);
    if (!is_given && options.known.empty()) throw UsageError("{} is required without --known", name);
  }
}

Subject OpenFiles(const ExplainCommandOptions& options) {
  ParameterSet given = data_io::ReadParameters(options.params);
  auto recording = workflow::OpenRecordingWith(options.real, options.sonar);
  workflow::ExplainRecordingOptions explain = options.explain.For(*recording);
  return {.recording = std::move(recording),
          .scene = cli::ReadSceneFile(options.scene, options.scene_format, options.common),
          .given = std::move(given),
          .options = options.explain,
          .explain = std::move(explain),
          .presentation = {.apart = options.apart},
          .inputs = {options.real, cli::SonarFile(options.sonar), options.scene, options.params}};
}

// Prepares the recording in folder `recording` of the output.
Subject OpenKnown(const reproduce::CasePlan& plan, const ExplainCommandOptions& options,
                  const cli::RunOutput& output) {
  const reproduce::PrepareOptions prepare{
      .threads = options.explain.rays.threads,
      .on_note = [&](const std::string& line) { cli::PrintNote(options.common, line); }};
  reproduce::PreparedRecording prepared = reproduce::PrepareCase(
      plan, options.recordings.empty() ? data_io::DefaultRecordingsFolder() : options.recordings, prepare);
  reproduce::WritePrepared(prepared, output / "recording");
  workflow::ExplainOptions explain = options.explain;
  workflow::ExplainRecordingOptions resolved = explain.For(*prepared.recording);
  // A method from the command line or from --object overrides that of the recording.
  const metrics::SegmentationOptions& own = prepared.comparison.segmentation;
  metrics::SegmentationOptions& chosen = resolved.comparison.segmentation;
  if (!explain.comparison.segmentation && !resolved.comparison.object && own.method != chosen.method) {
    explain.comparison.segmentation = chosen.method = own.method;
    chosen.background_law = own.background_law;
    if (own.background_law) explain.comparison.background_params.file = options.out / "recording/params.json";
  }
  if (!resolved.held_out) resolved.held_out = prepared.held_out;
  resolved.hold_noise = explain.hold_noise = prepared.hold_noise || explain.hold_noise;
  return {.recording = std::move(prepared.recording),
          .scene = std::move(prepared.scene),
          .given = std::move(prepared.parameters),
          .options = std::move(explain),
          .explain = std::move(resolved),
          .presentation = {.title = std::move(prepared.title),
                           .about = true,
                           .apart = prepared.apart || options.apart,
                           .warnings = std::move(prepared.warnings),
                           .caveats = std::move(prepared.caveats)},
          .inputs = std::move(prepared.inputs)};
}

Json ConfigurationJson(const ExplainCommandOptions& options, const Subject& subject,
                       const workflow::ExplainedRecording& explained) {
  Json json = {{"known", options.known.empty() ? Json(nullptr) : Json(options.known)},
               {"real", options.real.string()},
               {"sonar", options.sonar},
               {"scene", options.scene.string()},
               {"params", options.params.string()},
               {"out", options.out.string()},
               {"apart", subject.presentation.apart}};
  json.update(cli::SceneFormatJson(options.scene_format));
  workflow::ExplainOptions resolved = subject.options;
  resolved.rays.rays = explained.rays;
  resolved.held_out = explained.split.held_out;
  json.update(cli::OptionsJson(resolved));
  return json;
}

void WriteMaps(const workflow::ExplainedRecording& explained, const cli::RunOutput& output) {
  for (const workflow::CauseMap& map : explained.maps) {
    data_io::WritePng(output / fmt::format("causes_{:04}.png", map.index), map.cause);
    Grid<std::uint16_t> lobes(map.lobe_of.rows(), map.lobe_of.cols());
    for (std::size_t i = 0; i < lobes.size(); ++i)
      lobes.values()[i] = static_cast<std::uint16_t>(map.lobe_of.values()[i] + 1);
    data_io::WritePng(output / fmt::format("lobes_{:04}.png", map.index), lobes);
    data_io::WritePng(output / fmt::format("causes_{:04}_picture.png", map.index),
                      report::WithLegend(report::CausePicture(map.cause), map.cause, explained.cause_names));
  }
}

report::HtmlReport MakeReport(const workflow::ExplainedRecording& explained, const RecordingInfo& info,
                              const report::ExplanationPresentation& presentation, const Json& provenance) {
  const std::string name = workflow::RecordingName(info);
  report::HtmlReport report(
      "Ablation study of the model",
      presentation.title.empty() ? name : fmt::format("{}; {}", presentation.title, name));
  report::AddSyntheticCallout(report, info.synthetic, workflow::RecordingName(info));
  report::AddWaterfall(report, explained, presentation);
  report::AddCauses(report, explained, presentation);
  report::EndReport(report, provenance);
  return report;
}

}  // namespace

cli::ExitStatus RunExplain(const ExplainCommandOptions& options) {
  const workflow::ThreadLimit threads(options.explain.rays.threads);
  CheckSubject(options);
  // A mistake in files or plan leaves nothing behind.
  std::optional<Subject> opened;
  std::optional<reproduce::CasePlan> plan;
  if (options.known.empty()) {
    opened = OpenFiles(options);
  } else {
    plan = reproduce::FindCase(options.known);
  }
  cli::RunOutput output(options.out, "explain", options.common.force);
  if (plan) opened = OpenKnown(*plan, options, output);
  Subject& subject = *opened;
  subject.presentation.synthetic = subject.recording->info().synthetic;
  workflow::ExplainRecordingOptions& explain = subject.explain;
  explain.on_note = [&](const std::string& sentence) { cli::PrintNote(options.common, sentence); };
  explain.on_step = [&](calib::ExplainedPart part) {
    cli::PrintNote(options.common, fmt::format("fitting: {}", report::TitleOf(part)));
  };
  const workflow::ExplainedRecording explained =
      workflow::ExplainRecording(*subject.recording, subject.scene, subject.given, explain);

  const std::vector<std::filesystem::path> of_options = cli::OptionFiles(options.explain);
  subject.inputs.insert(subject.inputs.end(), of_options.begin(), of_options.end());
  const cli::Provenance provenance{.command = "explain",
                                   .configuration = ConfigurationJson(options, subject, explained),
                                   .inputs = subject.inputs};
  const Json json = report::ExplanationJson(explained, subject.presentation);
  data_io::WriteJson(output / "explain.json", json);
  WriteMaps(explained, output);
  data_io::WriteParameters(output / "params.json", explained.explanation.steps.back().parameters);
  cli::WriteProvenance(output.staging(), provenance);
  const RecordingInfo& info = subject.recording->info();
  report::WriteReport(MakeReport(explained, info, subject.presentation, cli::ProvenanceToJson(provenance)),
                      output.staging());
  output.Commit();

  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    const std::string name = workflow::RecordingName(info);
    std::string text =
        fmt::format("{}: {}", subject.presentation.title.empty() ? name : subject.presentation.title,
                    report::ExplanationText(explained, subject.presentation));
    if (plan) {
      text += fmt::format("recording, scene and parameters: {}\n", (options.out / "recording").string());
    }
    cli::PrintResult(text + fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return cli::ExitStatus::kDone;
}

void SetupExplain(CLI::App& app) {
  auto options = std::make_shared<ExplainCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "explain", "Ablation study of the acoustic model, and causes of bright pixels");
  command
      ->add_option("--real", options->real,
                   "Recording with at least two frames, each with a pose; required without --known, like "
                   "--scene and --params")
      ->type_name("REC");
  cli::AddSonarOfRecording(*command, options->sonar);
  cli::AddSceneOptions(*command, options->scene, options->scene_format, "Scene with named materials",
                       /*required=*/false);
  command
      ->add_option("--params", options->params,
                   "Parameters of the acoustic model: the form of beam, pulse, display and mirrors, and "
                   "start values of the curves")
      ->type_name("JSON");
  command
      ->add_option("--known", options->known,
                   "In place of these the name of a case study (bomb, hull_strip, or a folder of "
                   "$SONARCAL_CASES), whose plan gives poses and scene")
      ->type_name("CASE");
  command
      ->add_option("--recordings", options->recordings,
                   "Where it is looked for [$SONARCAL_RECORDINGS, else ./recordings]")
      ->type_name("DIR");
  cli::AddOutFolder(*command, options->out, options->common, "Folder for figures, maps and report")
      ->required();
  command->add_flag("--apart", options->apart, "Evaluate each held-out frame by itself");
  cli::AddOptions(*command, options->explain);
  cli::OnRun(command, options->common, [command, options] {
    cli::RefuseSceneFormatAlone(*command);
    if (options->known.empty()) {
      cli::RefuseGiven(*command, {"--recordings"}, "without --known");
      cli::RefuseUnusedSegmentation(*command, options->explain.comparison);
    }
    return RunExplain(*options);
  });
}

}  // namespace sonarcal::commands
