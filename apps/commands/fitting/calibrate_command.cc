// `sonarcal calibrate`: from a recording and a scene to a calibrated simulator, with every decision and its
// reason.
//
//   params.json    fitted parameters, as of every fit
//   fit.json       the last fit, to all frames used
//   sonar.json     the calibrated sonar: --sonar of the other commands takes it
//   scene.gltf     the scene with objects where they were found; only if one moved
//   poses.json     poses of the frames
//   plan.json      the decisions: --plan repeats the run, or overrides any of them
//   report.html
//
// A calibration whose last fits have no usable solution writes only fit.json and plan.json.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/scene_option.h"
#include "apps/commands/commands.h"
#include "apps/commands/fitting/fit_command.h"
#include "apps/commands/fitting/fit_ending.h"
#include "apps/report/html/report_end.h"
#include "apps/report/sections/calibration_section.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/workflow/calibration/calibrate.h"
#include "apps/workflow/kept_memory.h"
#include "data_io/files/atomic_output.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

struct CalibrateCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path real;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::filesystem::path poses;  // empty: those of the recording
  std::filesystem::path background;
  std::filesystem::path plan;
  std::filesystem::path out;
  bool resume = false;
  workflow::CalibrateOptions calibrate;
};

constexpr const char* kStarted = "started.json";  // what a run that is under way was asked for
constexpr const char* kPlan = "plan.json";

Json ConfigurationJson(const CalibrateCommandOptions& options) {
  Json json = {{"real", options.real.string()},   {"scene", options.scene.string()},
               {"poses", options.poses.string()}, {"background", options.background.string()},
               {"plan", options.plan.string()},   {"out", options.out.string()}};
  json.update(cli::SceneFormatJson(options.scene_format));
  json.update(cli::OptionsJson(options.calibrate));
  return json;
}

// Configuration that a run has in common with the one that it resumes: all but the number of threads.
std::string StartedText(Json configuration) {
  configuration.erase("threads");
  return data_io::JsonText(configuration);
}

// Plan to start from: of --plan, or of the run that is resumed.
workflow::CalibrationPlan PlanOf(const CalibrateCommandOptions& options, const cli::RunOutput& output,
                                 const Json& configuration) {
  if (options.resume) {
    if (!output.found() || !std::filesystem::exists(output / kStarted)) {
      cli::PrintNote(options.common, "nothing to resume: the calibration begins anew");
    } else if (data_io::ReadFileBytes(output / kStarted, 1 << 24) != StartedText(configuration)) {
      throw DataError("{}: cannot be resumed: it was started with other inputs or options",
                      options.out.string());
    } else if (std::filesystem::exists(output / kPlan)) {
      return workflow::ReadCalibrationPlan(output / kPlan);
    }
  }
  return options.plan.empty() ? workflow::CalibrationPlan() : workflow::ReadCalibrationPlan(options.plan);
}

report::HtmlReport MakeReport(const workflow::Calibration& calibration, const RecordingInfo& info,
                              const Json& provenance) {
  const std::string name = workflow::RecordingName(info);
  report::HtmlReport report("Calibration of a sonar", name);
  report::AddCalibration(report, calibration, info.synthetic, name);
  report::EndReport(report, provenance);
  return report;
}

cli::ExitStatus RunCalibrate(const CalibrateCommandOptions& options) {
  workflow::ReturnLargeBlocks();
  std::unique_ptr<RecordingSource> recording = data_io::OpenRecording(options.real);
  if (!options.poses.empty()) {
    recording =
        data_io::WithPoses(std::move(recording), data_io::ReadPosesOrRecording(options.poses), options.poses);
  }
  std::unique_ptr<RecordingSource> background;
  if (!options.background.empty()) background = data_io::OpenRecording(options.background);
  const Scene scene = cli::ReadSceneFile(options.scene, options.scene_format, options.common);
  const Json configuration = ConfigurationJson(options);
  cli::RunOutput output(options.out, "calibrate", options.common.force,
                        options.resume ? data_io::Aside::kFound : data_io::Aside::kAnew);
  workflow::CalibrationInput input{.background = background.get(),
                                   .plan = PlanOf(options, output, configuration)};
  data_io::WriteFileWhole(output / kStarted, StartedText(configuration));
  std::optional<cli::Progress> progress;  // of one fit after the other
  const workflow::Calibration calibration = workflow::Calibrate(
      *recording, scene, options.calibrate, input,
      {.progress =
           [&](const std::string& step, int done, int total) {
             if (done == 1) progress.emplace(step, total, options.common);
             if (progress) progress->Update(done);
           },
       .message = [&](const std::string& sentence) { cli::PrintNote(options.common, sentence); },
       .stop = {}},
      [&](const workflow::CalibrationPlan& plan) {
        data_io::WriteFileWhole(output / kPlan, data_io::JsonText(workflow::CalibrationPlanJson(plan)));
        output.Keep();
      });
  std::filesystem::remove(output / kStarted);

  std::vector<std::filesystem::path> inputs = cli::OptionFiles(options.calibrate);
  inputs.insert(inputs.begin(),
                {options.real, options.scene, options.poses, options.background, options.plan});
  const cli::Provenance provenance{
      .command = "calibrate", .configuration = configuration, .inputs = std::move(inputs)};
  // The figures are those of the evaluation, so that both last fits need a solution.
  const workflow::RecordingFit& fit =
      calibration.evaluation.fit.usable ? calibration.fit : calibration.evaluation;
  const std::string fit_json = FitJson(fit);
  data_io::WriteFileWhole(output / "fit.json", fit_json);
  data_io::WriteFileWhole(output / kPlan, data_io::JsonText(workflow::CalibrationPlanJson(calibration.plan)));
  cli::WriteProvenance(output.staging(), provenance);
  if (!fit.fit.usable) return EndFitWithoutSolution(NoSolutionText(fit.fit.report), options.out, output);
  data_io::WriteParameters(output / "params.json", fit.fit.parameters);
  data_io::WritePoses(output / "poses.json",
                      fit.poses.empty() ? data_io::PosesOfRecording(*recording) : fit.poses);
  if (fit.scene) data_io::WriteGltf(*fit.scene, output / "scene.gltf");
  RecordingInfo sonar = recording->info();
  sonar.sonar.axes = Corrected(sonar.sonar.axes, fit.geometry);
  data_io::WriteSonarFile(output / "sonar.json", sonar);
  return EndFit(MakeReport(calibration, recording->info(), cli::ProvenanceToJson(provenance)), fit_json,
                report::CalibrationText(calibration) +
                    fmt::format("report: {}\n", (options.out / "report.html").string()),
                options.common, output);
}

}  // namespace

void SetupCalibrate(CLI::App& app) {
  auto options = std::make_shared<CalibrateCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "calibrate", "Calibrates a simulator to a recording and a scene, in stages");
  command
      ->add_option("--real", options->real,
                   "Recording to calibrate to; each frame needs a rough pose, except with --poses")
      ->type_name("REC")
      ->required();
  cli::AddSceneOptions(*command, options->scene, options->scene_format, "Scene with named materials",
                       /*required=*/true);
  command
      ->add_option(
          "--poses", options->poses,
          "Rough poses, one per frame, in place of those of --real: a recording with poses, or a JSON file "
          "(default: none)")
      ->type_name("REC|FILE");
  command
      ->add_option("--background", options->background,
                   "Recording of pings without targets, for the noise law")
      ->type_name("REC");
  command
      ->add_option("--plan", options->plan,
                   "Decisions to take as they are: plan.json of an earlier run, whole or in part")
      ->type_name("JSON");
  command->add_flag("--resume", options->resume,
                    "Go on where an interrupted run of the same command stopped");
  cli::AddOutFolder(*command, options->out, options->common, "Folder for parameters, sonar, poses and report")
      ->required();
  cli::AddOptions(*command, options->calibrate);
  cli::OnRun(command, options->common, [options] { return RunCalibrate(*options); });
}

}  // namespace sonarcal::commands
