#include "apps/explain_command.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "apps/commands.h"
#include "apps/explain_recording.h"
#include "apps/given_options.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/report/cause_pictures.h"
#include "apps/report/comparison_section.h"
#include "apps/report/explain_section.h"
#include "apps/report/paper_files.h"
#include "apps/report/report_end.h"
#include "apps/run_output.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_catalogue.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr JsonWords<KnownRecording, 2> kKnown = {
    {{"bomb", KnownRecording::kBomb}, {"hull-strip", KnownRecording::kHullStrip}}};

// What is explained, from files or one of the known ones.
struct Subject {
  std::unique_ptr<RecordingSource> recording;
  Scene scene;
  ParameterSet given;
  std::optional<std::vector<int>> held_out;
  bool hold_noise = false;
  ComparisonOptions comparison;  // as provenance has it
  CompareOptions compare;
  ExplanationTelling telling;
  std::vector<std::filesystem::path> inputs;
};

void CheckSubject(const ExplainCommandOptions& options) {
  const std::pair<const char*, bool> files[] = {{"--real", !options.real.empty()},
                                                {"--scene", !options.scene.empty()},
                                                {"--params", !options.params.empty()}};
  for (const auto& [name, is_given] : files) {
    if (is_given && options.known) throw UsageError("{} does not go with --known, which has its own", name);
    if (!is_given && !options.known) throw UsageError("{} is required, where --known is not given", name);
  }
}

Subject OpenFiles(const ExplainCommandOptions& options) {
  ParameterSet given = ReadParameters(options.params);
  auto recording = OpenRecording(options.real);
  const PolarAxes axes = recording->info().sonar.axes;
  return {.recording = std::move(recording),
          .scene = ReadSceneFile(options.scene, options.scene_format, options.common),
          .given = std::move(given),
          .held_out = {},
          .hold_noise = options.hold_noise,
          .comparison = options.comparison,
          .compare = options.comparison.For(axes),
          .telling = {.apart = options.apart},
          .inputs = {options.real, options.scene, options.params}};
}

// Prepared as `recording` of the output.
Subject OpenKnown(const ExplainCommandOptions& options, const RunOutput& output) {
  const PrepareOptions prepare{.threads = options.rays.threads,
                               .on_note = [&](const std::string& line) { PrintNote(options.common, line); }};
  PreparedRecording prepared = PrepareKnown(
      *options.known, options.recordings.empty() ? DefaultRecordingsFolder() : options.recordings, prepare);
  WritePrepared(prepared, output / "recording");
  ComparisonOptions comparison = options.comparison;
  CompareOptions compare = comparison.For(prepared.recording->info().sonar.axes);
  // A method given by name or by --object overrides the recording's own.
  const SegmentationOptions& own = prepared.comparison.segmentation;
  if (!comparison.object.method && !compare.object && own.method != compare.segmentation.method) {
    comparison.object.method = compare.segmentation.method = own.method;
    compare.segmentation.background_law = own.background_law;
    if (own.background_law) comparison.object.background_params = options.out / "recording/params.json";
  }
  return {.recording = std::move(prepared.recording),
          .scene = std::move(prepared.scene),
          .given = std::move(prepared.parameters),
          .held_out = std::move(prepared.held_out),
          .hold_noise = prepared.hold_noise || options.hold_noise,
          .comparison = std::move(comparison),
          .compare = std::move(compare),
          .telling = {.title = std::move(prepared.title),
                      .about = true,
                      .apart = prepared.apart || options.apart,
                      .warnings = std::move(prepared.warnings),
                      .caveats = std::move(prepared.caveats)},
          .inputs = std::move(prepared.inputs)};
}

Json ConfigurationJson(const ExplainCommandOptions& options, const Subject& subject,
                       const ExplainedRecording& explained) {
  Json json = {{"known", options.known ? Json(JsonWord(kKnown, *options.known)) : Json(nullptr)},
               {"real", options.real.string()},
               {"scene", options.scene.string()},
               {"params", options.params.string()},
               {"out", options.out.string()},
               {"held_out", explained.split.held_out},
               {"apart", subject.telling.apart},
               {"hold_noise", subject.hold_noise},
               {"poses", options.poses},
               {"max_iterations", options.max_iterations}};
  json.update(SceneFormatJson(options.scene_format));
  json.update(RayOptionsJson(options.rays, explained.rays));
  json.update(ComparisonOptionsJson(subject.comparison));
  return json;
}

void WriteMaps(const ExplainedRecording& explained, const RunOutput& output) {
  for (const CauseMap& map : explained.maps) {
    WritePng(output / fmt::format("causes_{:04}.png", map.index), map.cause);
    Grid<std::uint16_t> lobes(map.lobe_of.rows(), map.lobe_of.cols());
    for (std::size_t i = 0; i < lobes.size(); ++i)
      lobes.values()[i] = static_cast<std::uint16_t>(map.lobe_of.values()[i] + 1);
    WritePng(output / fmt::format("lobes_{:04}.png", map.index), lobes);
    WritePng(output / fmt::format("causes_{:04}_picture.png", map.index),
             WithLegend(CausePicture(map.cause), map.cause, explained.cause_names));
  }
}

HtmlReport MakeReport(const ExplainedRecording& explained, const RecordingInfo& info,
                      const ExplanationTelling& telling, const Json& provenance) {
  const std::string name = RecordingName(info);
  HtmlReport report("What each part of the model explains",
                    telling.title.empty() ? name : fmt::format("{}; {}", telling.title, name));
  AddSyntheticCallout(report, info.synthetic, RecordingName(info));
  AddWaterfall(report, explained, telling);
  AddCauses(report, explained, telling);
  EndReport(report, provenance);
  return report;
}

}  // namespace

ExitStatus RunExplain(const ExplainCommandOptions& options) {
  const ThreadLimit threads(options.rays.threads);
  CheckSubject(options);
  std::optional<Subject> opened;
  if (!options.known) opened = OpenFiles(options);  // a mistake in them leaves nothing behind
  RunOutput output(options.out, "explain", options.common.force);
  if (options.known) opened = OpenKnown(options, output);
  Subject& subject = *opened;
  subject.telling.synthetic = subject.recording->info().synthetic;
  ExplainRecordingOptions explain{.poses = options.poses};
  explain.rays = options.rays;
  explain.comparison = subject.compare;
  explain.held_out = subject.held_out;
  explain.hold_noise = subject.hold_noise;
  if (!options.held_out.empty()) explain.held_out = options.held_out;
  explain.fit.max_iterations = options.max_iterations;
  explain.fit.threads = options.rays.threads;
  explain.on_note = [&](const std::string& sentence) { PrintNote(options.common, sentence); };
  explain.on_step = [&](ExplainedPart part) {
    PrintNote(options.common, fmt::format("fitting: {}", TitleOf(part)));
  };
  const ExplainedRecording explained =
      ExplainRecording(*subject.recording, subject.scene, subject.given, explain);

  const Provenance provenance{.command = "explain",
                              .configuration = ConfigurationJson(options, subject, explained),
                              .inputs = subject.inputs};
  const Json json = ExplanationJson(explained, subject.telling);
  WriteFileWhole(output / "explain.json", json.dump(2) + "\n");
  WriteMaps(explained, output);
  WriteParameters(output / "params.json", explained.explanation.steps.back().parameters);
  WriteProvenance(output.staging(), provenance);
  const RecordingInfo& info = subject.recording->info();
  WriteReport(MakeReport(explained, info, subject.telling, ProvenanceToJson(provenance)), output.staging());
  output.Commit();

  if (options.common.json) {
    PrintJson(json);
  } else {
    const std::string name = RecordingName(info);
    std::string text = fmt::format("{}: {}", subject.telling.title.empty() ? name : subject.telling.title,
                                   ExplanationText(explained, subject.telling));
    if (options.known) {
      text += fmt::format("recording, scene and parameters: {}\n", (options.out / "recording").string());
    }
    PrintResult(text + fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return ExitStatus::kDone;
}

void SetupExplain(CLI::App& app) {
  auto options = std::make_shared<ExplainCommandOptions>();
  CLI::App* command = AddCommand(
      app, "explain",
      "Adds the acoustic model's parts one by one, says what each is worth on frames that were not "
      "fitted, and what every bright cell comes from");
  command
      ->add_option("--real", options->real,
                   "Recording to explain, at least two frames, a pose with each; required but for --known, "
                   "as --scene and --params are")
      ->type_name("REC");
  AddSceneOptions(*command, options->scene, options->scene_format, "Scene, its materials by name",
                  /*required=*/false);
  command
      ->add_option(
          "--params", options->params,
          "Parameters of the acoustic model: the form of beam, pulse, display and mirrors, and where "
          "curves begin")
      ->type_name("JSON");
  AddChoice(*command, "--known", options->known, kKnown,
            "In place of these a recording of which the project knows or assumes poses and scene: a bomb "
            "that an ARIS 3000 recorded, or a strip of hull by a person's marks in a DIDSON's pings");
  command
      ->add_option("--recordings", options->recordings,
                   "Where it is looked for [$SONARCAL_RECORDINGS, else ./recordings]")
      ->type_name("DIR");
  AddOutFolder(*command, options->out, options->common, "Folder for figures, maps and report")->required();
  command
      ->add_option("--held-out", options->held_out,
                   "Frames that no fit sees, counted from 0 (default: the last third)")
      ->delimiter(',')
      ->type_name("N,N")
      ->allow_extra_args(false);
  command->add_flag("--apart", options->apart, "Let each held-out frame judge by itself");
  command->add_flag("--hold-noise", options->hold_noise,
                    "Take the noise floor as the parameters have it, such as fit --noise-only found it; "
                    "else its level is fitted");
  command->add_flag("--poses", options->poses, "Refine the pose of every frame as the last part; slow");
  AddRayOptions(*command, options->rays);
  command->add_option("--max-iterations", options->max_iterations, "Iterations of each solve at most")
      ->type_name("N")
      ->check(CLI::Range(1, 100000).description(""));
  AddComparisonOptions(*command, options->comparison);
  OnRun(command, options->common, [command, options] {
    RefuseSceneFormatAlone(*command);
    if (!options->known) {
      RefuseGiven(*command, {"--recordings"}, "without --known");
      RefuseUnusedSegmentation(*command, options->comparison.object);
    }
    return RunExplain(*options);
  });
}

}  // namespace sonarcal
