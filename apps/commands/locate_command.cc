// `sonarcal locate`: finds the pose of a target in frames of a recording, from its mesh alone
// (apps/workflow/locate.h; docs/guide/locate.md).
//
// Writes:
//
//   poses.json     pose of each frame, with all candidates, their likelihood, and what is open
//   recording/     the located frames with their poses; names the scene
//   scene.gltf     the target, and the floor, in the world: the frame of the mesh
//   params.json    the parameters of the search with the gain found, as a start of `fit`
//   report.html    candidates, recorded and expected images
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/interruption.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/scene_option.h"
#include "apps/commands/commands.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/report_end.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/locate_section.h"
#include "apps/reproduce/case_scene.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/locate.h"
#include "core/types/error.h"
#include "data_io/json/json_reader.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

struct LocateCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path real;
  FrameList frames;  // empty: the first frame
  std::filesystem::path target;
  cli::SceneFormat target_format;
  std::filesystem::path poses;  // empty: no start poses
  std::filesystem::path out;
  workflow::LocateOptions locate;
};

Json ConfigurationJson(const LocateCommandOptions& options, const std::vector<int>& frames) {
  Json json = {{"real", options.real.string()},
               {"frames", frames},
               {"target", options.target.string()},
               {"poses", options.poses.string()},
               {"out", options.out.string()}};
  json.update(cli::SceneFormatJson(options.target_format));
  json.update(cli::OptionsJson(options.locate));
  return json;
}

report::HtmlReport MakeReport(const workflow::Location& location, const RecordingInfo& info,
                              const Json& provenance) {
  report::HtmlReport report("Pose of a target", workflow::RecordingName(info));
  report::AddLocation(report, location, info.synthetic, workflow::RecordingName(info));
  report::EndReport(report, provenance);
  return report;
}

// A file of a shape (apps/reproduce/case_scene.h), or a mesh.
Scene ReadTarget(const LocateCommandOptions& options) {
  if (options.target.extension() != ".json")
    return cli::ReadSceneFile(options.target, options.target_format, options.common);
  const data_io::JsonReader json = data_io::JsonReader::FromFile(options.target);
  Scene mesh = reproduce::ReadCaseScene(json, options.target.parent_path());
  json.Finish();
  return mesh;
}

cli::ExitStatus RunLocate(const LocateCommandOptions& options) {
  const auto recording = data_io::OpenRecording(options.real);
  const FrameList asked = options.frames.empty() ? FrameList{0} : options.frames;
  const std::vector<int> frames = asked.In(recording->frame_count());
  const Scene mesh = ReadTarget(options);
  std::vector<data_io::TimedPose> start;
  if (!options.poses.empty()) start = data_io::ReadPosesOrRecording(options.poses);
  cli::RunOutput output(options.out, "locate", options.common.force);
  const cli::Interruption interruption(cli::Interruption::IfSlow::kWait);  // frames found are written
  workflow::Location location = workflow::Locate(
      *recording, mesh, frames, options.locate, start,
      {.progress = {},
       .message = [&](const std::string& sentence) { cli::PrintNote(options.common, sentence); },
       .stop = [&] { return interruption.asked(); }});
  if (location.frames.empty()) {
    cli::PrintError("interrupted before the first frame was located, nothing was written");
    return cli::ExitStatus::kInterrupted;
  }

  const std::filesystem::path scene = output / "scene.gltf";
  data_io::WriteGltf(location.scene, scene);
  data_io::WritePoses(output / "poses.json", location.Poses());
  data_io::WriteParameters(output / "params.json", location.parameters);
  RecordingInfo info = location.recording->info();
  info.scene_path = scene.string();
  std::vector<Frame> posed;
  for (int i = 0; i < location.recording->frame_count(); ++i)
    posed.push_back(location.recording->ReadFrame(i));
  data_io::WriteRecording(MemoryRecording(info, std::move(posed)), output / "recording");
  cli::Provenance provenance{.command = "locate",
                             .configuration = ConfigurationJson(options, frames),
                             .inputs = {options.real, options.target}};
  if (!options.poses.empty()) provenance.inputs.push_back(options.poses);
  if (options.locate.params) provenance.inputs.push_back(options.locate.params.file);
  report::WriteReport(MakeReport(location, recording->info(), cli::ProvenanceToJson(provenance)),
                      output.staging());
  cli::WriteProvenance(output.staging(), provenance);
  output.Commit();

  if (options.common.json) {
    cli::PrintJson(Json::parse(data_io::PosesText(location.Poses())));
  } else {
    std::string text;
    for (const workflow::LocatedFrame& frame : location.frames) text += report::LocatedText(frame);
    cli::PrintResult(text + fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  if (!location.interrupted) return cli::ExitStatus::kDone;
  cli::PrintError(
      fmt::format("interrupted: {} of {} frames were located", location.frames.size(), frames.size()));
  return cli::ExitStatus::kInterrupted;
}

}  // namespace

void SetupLocate(CLI::App& app) {
  auto options = std::make_shared<LocateCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "locate", "Finds the pose of a target in a recording, from its mesh");
  command->add_option("--real", options->real, "Recording that shows the target; needs no poses")
      ->type_name("REC")
      ->required();
  command
      ->add_option(
          "--frame",
          [options](const CLI::results_t& texts) {
            options->frames = FrameList::Read("--frame", fmt::format("{}", fmt::join(texts, ",")));
            return true;
          },
          "Frame to search, counted from 0, or frames A:B from A up to, but not including, B; also A: and "
          ":B; may be repeated (default: the first)")
      ->type_name("K|A:B")
      ->expected(1, CLI::detail::expected_max_vector_size);
  cli::AddSceneOptions(*command, options->target, options->target_format,
                       "Mesh of the target, with named materials, or a shape as in docs/reference/cases.md",
                       /*required=*/true, "--target");
  command
      ->add_option(
          "--poses", options->poses,
          "Start poses, one per frame or one for all, that are refined without a search: a recording "
          "with poses, or a JSON file, such as one saved by view (default: none)")
      ->type_name("REC|FILE");
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for poses, posed recording, scene, parameters and report")
      ->required();
  cli::AddOptions(*command, options->locate);
  cli::OnRun(command, options->common, [options] { return RunLocate(*options); });
}

}  // namespace sonarcal::commands
