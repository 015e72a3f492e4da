#include "apps/explain_command.h"

#include <fmt/format.h>

#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/explain_recording.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/report/cause_pictures.h"
#include "apps/report/comparison_section.h"
#include "apps/report/explain_section.h"
#include "apps/report/paper_files.h"
#include "apps/report/report_end.h"
#include "apps/run_output.h"
#include "data_io/atomic_output.h"
#include "data_io/image_io.h"
#include "data_io/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

Json ConfigurationJson(const ExplainCommandOptions& options, const ExplainedRecording& explained) {
  Json json = {{"real", options.real.string()},           {"scene", options.scene.string()},
               {"params", options.params.string()},       {"out", options.out.string()},
               {"held_out", explained.split.held_out},    {"poses", options.poses},
               {"max_iterations", options.max_iterations}};
  json.update(SceneFormatJson(options.scene_format));
  json.update(RayOptionsJson(options.rays, explained.rays));
  json.update(ComparisonOptionsJson(options.comparison));
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
                      const Json& provenance) {
  HtmlReport report("What each part of the model explains", RecordingName(info));
  AddSyntheticCallout(report, info.synthetic, RecordingName(info));
  AddWaterfall(report, explained);
  AddCauses(report, explained);
  EndReport(report, provenance);
  return report;
}

}  // namespace

ExitStatus RunExplain(const ExplainCommandOptions& options) {
  const ThreadLimit threads(options.rays.threads);
  const ParameterSet given = ReadParameters(options.params);
  const auto recording = OpenRecording(options.real);
  const Scene scene = ReadSceneFile(options.scene, options.scene_format, options.common);
  RunOutput output(options.out);
  ExplainRecordingOptions explain{.poses = options.poses};
  explain.rays = options.rays;
  explain.comparison = options.comparison.For(recording->info().sonar.axes);
  if (!options.held_out.empty()) explain.held_out = options.held_out;
  explain.fit.max_iterations = options.max_iterations;
  explain.fit.threads = options.rays.threads;
  explain.on_note = [&](const std::string& sentence) { PrintNote(options.common, sentence); };
  explain.on_step = [&](ExplainedPart part) {
    PrintNote(options.common, fmt::format("fitting: {}", TitleOf(part)));
  };
  const ExplainedRecording explained = ExplainRecording(*recording, scene, given, explain);

  const Provenance provenance{.command = "explain",
                              .configuration = ConfigurationJson(options, explained),
                              .inputs = {options.real, options.scene, options.params}};
  const Json json = ExplanationJson(explained);
  WriteFileWhole(output / "explain.json", json.dump(2) + "\n");
  WriteMaps(explained, output);
  WriteParameters(output / "params.json", explained.explanation.steps.back().parameters);
  WriteProvenance(output.staging(), provenance);
  WriteReport(MakeReport(explained, recording->info(), ProvenanceToJson(provenance)), output.staging());
  output.Commit();

  if (options.common.json) {
    PrintJson(json);
  } else {
    PrintResult(fmt::format("{}: {}report: {}\n", RecordingName(recording->info()),
                            ExplanationText(explained), (options.out / "report.html").string()));
  }
  return ExitStatus::kDone;
}

void SetupExplain(CLI::App& app) {
  auto options = std::make_shared<ExplainCommandOptions>();
  CLI::App* command = AddCommand(
      app, "explain",
      "Adds the acoustic model's parts one by one, says what each is worth on frames that were not "
      "fitted, and what every bright cell comes from");
  command->add_option("--real", options->real, "Recording to explain, at least two frames, a pose with each")
      ->type_name("REC")
      ->required();
  AddSceneOptions(*command, options->scene, options->scene_format, "Scene, its materials by name",
                  /*required=*/true);
  command
      ->add_option(
          "--params", options->params,
          "Parameters of the acoustic model: the form of beam, pulse, display and mirrors, and where "
          "curves begin")
      ->type_name("JSON")
      ->required();
  command->add_option("--out", options->out, "Folder for figures, maps and report")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--held-out", options->held_out,
                   "Frames that no fit sees, counted from 0 (default: the last third)")
      ->delimiter(',')
      ->type_name("N,N")
      ->allow_extra_args(false);
  command->add_flag("--poses", options->poses, "Refine the pose of every frame as the last part; slow");
  AddRayOptions(*command, options->rays);
  command->add_option("--max-iterations", options->max_iterations, "Iterations of each solve at most")
      ->type_name("N")
      ->check(CLI::Range(1, 100000).description(""));
  AddComparisonOptions(*command, options->comparison);
  OnRun(command, options->common, [options] { return RunExplain(*options); });
}

}  // namespace sonarcal
