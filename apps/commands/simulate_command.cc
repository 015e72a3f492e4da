#include "apps/commands/simulate_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/interruption.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/commands/simulate_resume.h"
#include "apps/report/pictures/depth_picture.h"
#include "apps/workflow/simulate.h"
#include "core/imaging/fan_image.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "sim/gathered/empty_frames.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

// Writes a grey image in the format of a frame: 8 bits if enough, else 16.
void WriteGrey(const std::filesystem::path& file, const Grid<float>& value, double full_scale) {
  if (full_scale > 255.0) {
    Grid<std::uint16_t> grey(value.rows(), value.cols());
    for (std::size_t i = 0; i < value.size(); ++i) {
      grey.values()[i] = static_cast<std::uint16_t>(std::lround(value.values()[i]));
    }
    return data_io::WritePng(file, grey);
  }
  Grid<std::uint8_t> grey(value.rows(), value.cols());
  for (std::size_t i = 0; i < value.size(); ++i) {
    grey.values()[i] = static_cast<std::uint8_t>(std::lround(value.values()[i]));
  }
  data_io::WritePng(file, grey);
}

Json ConfigurationJson(const SimulateCommandOptions& options, const sim::Simulator& simulator,
                       EchoModel model) {
  const sim::RayFanOptions& fan = simulator.options().fan;
  Json json = {{"scene", options.scene.string()},
               {"sonar", options.sonar},
               {"params", options.params.string()},
               {"poses", options.poses.string()},
               {"out", options.out.string()}};
  json.update(cli::SceneFormatJson(options.scene_format));
  workflow::SimulateOptions cast = options.simulate;
  cast.model = model;
  cast.rays.sampling = fan.sampling;
  cast.rays.ray_weight = fan.weight;
  cast.rays.rays = RayGridSize{simulator.fan().cols(), simulator.fan().rows()};
  cast.margin_deg = fan.azimuth_margin_deg;
  cast.noise = workflow::IsRandom(options.simulate, model);
  json.update(cli::OptionsJson(cast));
  json.update({{"fan", options.fan}, {"depth", options.depth}});
  if (!options.frames.empty()) json["frames"] = options.frames.Text();
  return json;
}

// Writes optional pictures beside the image of a frame.
class FilesBeside {
 public:
  FilesBeside(const SimulateCommandOptions& options, const sim::Simulator& simulator)
      : with_fan_(options.fan), with_depth_(options.depth), simulator_(simulator) {
    if (with_fan_) fan_map_.emplace(simulator.sonar().axes);
  }

  std::vector<std::string> Names(int index) const {
    std::vector<std::string> names;
    if (with_fan_) names.push_back(fmt::format(kFan, index));
    if (with_depth_) {
      names.insert(names.end(),
                   {fmt::format(kRange, index), fmt::format(kDepth, index), fmt::format(kDepthView, index)});
    }
    return names;
  }

  void Write(const cli::RunOutput& output, int index, const Pose& pose, const PolarImage& image) const {
    if (with_fan_) {
      WriteGrey(output / fmt::format(kFan, index), fan_map_->Apply(image.value), image.scale.full_scale);
    }
    if (!with_depth_) return;
    const Grid<float> range_m = workflow::RangeAlongRays(simulator_.TraceEchoes(pose), simulator_.fan());
    data_io::WriteTiff(output / fmt::format(kRange, index), range_m);
    data_io::WritePng(output / fmt::format(kDepth, index), report::DepthInMillimetres(range_m));
    data_io::WritePng(output / fmt::format(kDepthView, index),
                      report::DepthPicture(range_m, simulator_.sonar().axes.range_max_m));
  }

 private:
  static constexpr std::string_view kFan = "fan_{:04}.png";
  static constexpr std::string_view kRange = "range_{:04}.tiff";
  static constexpr std::string_view kDepth = "depth_{:04}.png";
  static constexpr std::string_view kDepthView = "depth_view_{:04}.png";

  bool with_fan_;
  bool with_depth_;
  const sim::Simulator& simulator_;
  std::optional<FanMap> fan_map_;
};

// Keeps the poses of consecutive frames. Returns the number of the first one.
int TakePoses(const FrameList& asked, std::vector<data_io::TimedPose>& poses) {
  if (asked.empty()) return 0;
  const std::vector<int> frames = asked.In(static_cast<int>(poses.size()));
  if (frames.back() - frames.front() + 1 != static_cast<int>(frames.size()))
    throw UsageError("--frames '{}', expected consecutive frames A:B", asked.Text());
  poses = {poses.begin() + frames.front(), poses.begin() + frames.back() + 1};
  return frames.front();
}

// Writes the missing frames until all exist or the user interrupts. Returns the number of existing frames.
int WriteMissingFrames(const workflow::SimulatedRecording& recording, const FilesBeside& beside,
                       const FinishedFrames& finished, const cli::CommonOptions& common,
                       const cli::Interruption& interruption, cli::RunOutput& output) {
  cli::Progress progress("Simulating", recording.frame_count(), common, "frames");
  return data_io::WriteRecording(recording, output.directory(),
                                 {.progress =
                                      [&](int frames_done, int) {
                                        output.Keep();
                                        progress.Update(frames_done);
                                      },
                                  .is_written =
                                      [&](int index, const std::string& image) {
                                        if (!finished.Has(image, beside.Names(index))) return false;
                                        progress.Skip();
                                        return true;
                                      },
                                  .stop = [&] { return interruption.asked(); }});
}

}  // namespace

cli::ExitStatus RunSimulate(const SimulateCommandOptions& options) {
  const workflow::ThreadLimit threads(options.simulate.rays.threads);
  const workflow::SonarChoice choice = workflow::ChooseSonar(options.sonar);
  const workflow::PreparedSimulation resolved =
      workflow::PrepareSimulation(options.simulate, choice, data_io::ReadParameters(options.params));
  const ParameterSet& parameters = resolved.parameters;
  std::vector<data_io::TimedPose> poses =
      data_io::WithMotion(data_io::ReadPosesOrRecording(options.poses), choice.sonar.pings);
  std::vector<int> speckle_frames;
  if (options.simulate.frozen_speckle) speckle_frames = workflow::SpeckleFrames(poses);
  const int first_frame = TakePoses(options.frames, poses);
  if (!speckle_frames.empty()) {
    const auto first = speckle_frames.begin() + first_frame;
    speckle_frames = {first, first + static_cast<std::ptrdiff_t>(poses.size())};
  }
  Scene scene = cli::ReadSceneFile(options.scene, options.scene_format, options.common);
  const std::string scene_digest = SceneDigest(scene);
  const sim::Simulator simulator(std::move(scene), choice.sonar, resolved.simulation);
  for (const std::string& sentence : workflow::SimulationMessages(options.simulate, simulator, resolved))
    cli::PrintNote(options.common, sentence);

  const std::vector<Pose> world_from_sonar = data_io::PosesAlone(poses);
  std::vector<int> empty;
  {
    cli::Progress progress("Checking the poses", static_cast<int>(poses.size()), options.common);
    empty = sim::PosesThatSeeNothing(simulator, world_from_sonar, [&](int done) { progress.Update(done); });
  }
  if (!empty.empty())
    cli::PrintNote(options.common, sim::EmptyFramesWarning(simulator, world_from_sonar, empty));
  const std::int64_t rays_to_look = simulator.caster().rays_cast();

  // before the output exists, so that an interruption always keeps it for --resume
  const cli::Interruption interruption;
  const FilesBeside beside(options, simulator);
  cli::RefuseInputAsOutput(options.out, {options.poses, cli::SonarFile(options.sonar)});
  cli::RunOutput output(options.out, "simulate", options.common.force,
                        options.resume ? data_io::Aside::kFound : data_io::Aside::kAnew);
  const workflow::SimulatedRecording recording(
      simulator, std::move(poses), parameters, options.scene.string(),
      [&](int index, const Pose& pose, const PolarImage& image) { beside.Write(output, index, pose, image); },
      options.simulate.expected, first_frame, std::move(speckle_frames));
  cli::Provenance provenance{.command = "simulate",
                             .configuration = ConfigurationJson(options, simulator, parameters.model),
                             .inputs = {options.scene, options.params, options.poses}};
  if (workflow::IsRandom(options.simulate, parameters.model)) provenance.seed = resolved.simulation.seed;
  if (choice.input && *choice.input != options.poses) provenance.inputs.push_back(*choice.input);
  provenance.made_of = FramesMadeOf(recording, scene_digest, parameters, provenance);
  FinishedFrames finished;
  if (options.resume) finished = FinishedFrames(output, provenance.made_of);
  if (finished.in_folder()) output.GoOn();
  // Written before any frame, so that the remains of a killed run are identified.
  cli::WriteProvenance(output.staging(), provenance);
  const int frames_done =
      WriteMissingFrames(recording, beside, finished, options.common, interruption, output);
  if (frames_done == 0) {
    cli::PrintError("interrupted before the first frame was finished: nothing was written");
    return cli::ExitStatus::kInterrupted;
  }
  const bool is_whole = frames_done == recording.frame_count();
  if (!is_whole && !finished.in_folder() && data_io::IsRecordingFolder(options.out)) {
    cli::PrintError(fmt::format(
        "interrupted: {} of {} frames are finished and kept aside, and {} stays as it was; the same "
        "command with --resume makes the rest",
        frames_done, recording.frame_count(), options.out.string()));
    return cli::ExitStatus::kInterrupted;
  }
  data_io::WriteParameters(output / "params.json", parameters);
  output.Commit();
  if (!is_whole) {
    cli::PrintError(
        fmt::format("interrupted: {} of {} frames are finished, a recording in {}; the same command with "
                    "--resume makes the rest",
                    frames_done, recording.frame_count(), options.out.string()));
    return cli::ExitStatus::kInterrupted;
  }

  if (options.common.json) {
    cli::PrintJson({{"recording", output.final_path().string()},
                    {"frames", recording.frame_count()},
                    {"model", ToString(parameters.model)},
                    {"rays_cast", simulator.caster().rays_cast() - rays_to_look},
                    {"absorption_db_per_m", simulator.absorption_db_per_m()},
                    {"frames_without_echo", empty}});
  } else {
    cli::PrintResult(fmt::format("{}: {} {} by the {} model, {} x {} rays each\n", options.out.string(),
                                 recording.frame_count(), recording.frame_count() == 1 ? "frame" : "frames",
                                 ToString(parameters.model), simulator.fan().cols(), simulator.fan().rows()));
  }
  return cli::ExitStatus::kDone;
}

namespace {

void AddSimulateOptions(CLI::App* command, SimulateCommandOptions* options) {
  cli::AddSceneOptions(*command, options->scene, options->scene_format, "Scene with named materials",
                       /*required=*/true);
  cli::AddSonar(*command, options->sonar)->required();
  command->add_option("--params", options->params, "Parameters: materials, levels in dB, errors")
      ->type_name("JSON")
      ->required();
  command
      ->add_option("--poses", options->poses, "Poses, one per frame: a recording with poses, or a JSON file")
      ->type_name("REC|FILE")
      ->required();
  cli::AddOutFolder(*command, options->out, options->common, "Recording folder to write")->required();
  cli::AddFrames(*command, options->frames,
                 "Frames to simulate, one after the other, with the noise that they have among all");
  cli::AddOptions(*command, options->simulate);
  command->add_flag("--fan", options->fan, "Write each frame as a fan picture as well, fan_NNNN.png");
  command->add_flag("--depth", options->depth,
                    "Write the depth image as well: range along each ray, in metres (range_NNNN.tiff) and in "
                    "millimetres (depth_NNNN.png)");
  command->add_flag("--resume", options->resume,
                    "Continue an interrupted or killed run of the same command in --out");
}

}  // namespace

void SetupSimulate(CLI::App& app) {
  auto options = std::make_shared<SimulateCommandOptions>();
  CLI::App* command = cli::AddCommand(app, "simulate", "Simulates a recording of a sonar in a scene");
  AddSimulateOptions(command, options.get());
  cli::OnRun(command, options->common, [options] { return RunSimulate(*options); });
}

}  // namespace sonarcal::commands
