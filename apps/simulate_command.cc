#include "apps/simulate_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "apps/commands.h"
#include "apps/depth_picture.h"
#include "apps/empty_frames.h"
#include "apps/interruption.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/run_output.h"
#include "apps/seed_option.h"
#include "apps/simulate_recording.h"
#include "apps/simulate_resume.h"
#include "apps/sonar_option.h"
#include "core/imaging/fan_image.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr JsonWords<EchoModel, 3> kModels = {
    {{"paper", EchoModel::kPaper}, {"acoustic", EchoModel::kAcoustic}, {"coherent", EchoModel::kCoherent}}};

bool IsRandom(const SimulateOptions& options, EchoModel model) {
  return options.noise || (model == EchoModel::kCoherent && !options.expected);
}

void CheckFrozenSpeckle(const SimulateOptions& options, EchoModel model) {
  if (!options.frozen_speckle) return;
  if (model == EchoModel::kPaper) {
    throw UsageError("--frozen-speckle is for the models acoustic and coherent: the paper's has no speckle");
  }
  if (options.expected)
    throw UsageError("--frozen-speckle has no effect with --expected, which has no speckle");
  if (!IsRandom(options, model)) throw UsageError("--frozen-speckle needs --noise: without it is no speckle");
}

// Throws UsageError for options that change nothing with these parameters.
void RefuseWithoutEffect(const SimulateOptions& options, const ParameterSet& parameters) {
  const EchoModel model = parameters.model;
  if (options.seed && !IsRandom(options, model))
    throw UsageError("--seed has no effect without --noise: nothing is random");
  if (options.noise && model == EchoModel::kPaper && parameters.jitter.sigma_range_m == 0.0 &&
      parameters.jitter.sigma_azimuth_deg == 0.0) {
    throw UsageError(
        "--noise has no effect: the paper's model draws range and azimuth errors, and jitter.sigma_range_m "
        "and "
        "jitter.sigma_azimuth_deg are both 0");
  }
  if (options.ghost_order > 1 && (model == EchoModel::kPaper || parameters.mirrors.empty())) {
    throw UsageError(
        "--ghost-order {} has no effect: {}", options.ghost_order,
        model == EchoModel::kPaper ? "the paper's model has no ghosts" : "the parameters name no mirror");
  }
  if (options.rays.normals == NormalSource::kDepth && model == EchoModel::kCoherent)
    throw UsageError("--normals depth has no effect: the coherent model takes those of the mesh");
}

// A grey image as the file of a frame has it: 8 bits where they hold it, else 16.
void WriteGrey(const std::filesystem::path& file, const Grid<float>& value, double full_scale) {
  if (full_scale > 255.0) {
    Grid<std::uint16_t> grey(value.rows(), value.cols());
    for (std::size_t i = 0; i < value.size(); ++i) {
      grey.values()[i] = static_cast<std::uint16_t>(std::lround(value.values()[i]));
    }
    return WritePng(file, grey);
  }
  Grid<std::uint8_t> grey(value.rows(), value.cols());
  for (std::size_t i = 0; i < value.size(); ++i) {
    grey.values()[i] = static_cast<std::uint8_t>(std::lround(value.values()[i]));
  }
  WritePng(file, grey);
}

Json ConfigurationJson(const SimulateOptions& options, const Simulator& simulator, EchoModel model) {
  const RayFanOptions& fan = simulator.options().fan;
  RayOptions rays = options.rays;
  rays.sampling = fan.sampling;
  Json json = {{"scene", options.scene.string()},   {"sonar", options.sonar},
               {"params", options.params.string()}, {"poses", options.poses.string()},
               {"out", options.out.string()},       {"model", ToString(model)}};
  json.update(SceneFormatJson(options.scene_format));
  json.update(RayOptionsJson(rays, {simulator.fan().cols(), simulator.fan().rows()}));
  json.update({{"margin_deg", fan.azimuth_margin_deg},
               {"bits", options.bits},
               {"noise", IsRandom(options, model)},
               {"expected", options.expected},
               {"frozen_speckle", options.frozen_speckle},
               {"ghost_order", options.ghost_order},
               {"fan", options.fan},
               {"depth", options.depth}});
  return json;
}

// Pictures beside a frame's image, where they are asked for.
class FilesBeside {
 public:
  FilesBeside(const SimulateOptions& options, const Simulator& simulator)
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

  void Write(const RunOutput& output, int index, const Pose& pose, const PolarImage& image) const {
    if (with_fan_) {
      WriteGrey(output / fmt::format(kFan, index), fan_map_->Apply(image.value), image.scale.full_scale);
    }
    if (!with_depth_) return;
    const Grid<float> range_m = RangeAlongRays(simulator_.TraceEchoes(pose), simulator_.fan());
    WriteTiff(output / fmt::format(kRange, index), range_m);
    WritePng(output / fmt::format(kDepth, index), DepthInMillimetres(range_m));
    WritePng(output / fmt::format(kDepthView, index),
             DepthPicture(range_m, simulator_.sonar().axes.range_max_m));
  }

 private:
  static constexpr std::string_view kFan = "fan_{:04}.png";
  static constexpr std::string_view kRange = "range_{:04}.tiff";
  static constexpr std::string_view kDepth = "depth_{:04}.png";
  static constexpr std::string_view kDepthView = "depth_view_{:04}.png";

  bool with_fan_;
  bool with_depth_;
  const Simulator& simulator_;
  std::optional<FanMap> fan_map_;
};

// Writes the frames that are not there yet, until all are or the user interrupts. Returns how many are there.
int WriteMissingFrames(const SimulatedRecording& recording, const FilesBeside& beside,
                       const FinishedFrames& finished, const CommonOptions& common,
                       const Interruption& interruption, RunOutput& output) {
  Progress progress("Simulating", recording.frame_count(), common, "frames");
  return WriteRecording(recording, output.directory(),
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

ResolvedSimulation ResolveSimulation(const SimulateOptions& options, const SonarChoice& choice,
                                     ParameterSet parameters) {
  if (options.model) parameters.model = *options.model;
  if (options.expected && options.noise)
    throw UsageError(
        "--expected does not go with --noise: an expected image is the mean over noise and speckle");
  CheckFrozenSpeckle(options, parameters.model);
  CheckRayWeight(options.rays.weight, parameters.model);
  RefuseWithoutEffect(options, parameters);
  const WaterChoice water = ChooseWater(parameters, choice.water);
  SimulationOptions simulation = options.rays.For(choice.sonar, water.water, parameters);
  simulation.bits = options.bits;
  simulation.noise = IsRandom(options, parameters.model);
  simulation.frozen_speckle = options.frozen_speckle;
  simulation.ghost_order = options.ghost_order;
  if (options.margin_deg) simulation.fan.azimuth_margin_deg = *options.margin_deg;
  if (options.seed) simulation.seed = *options.seed;
  return {.parameters = std::move(parameters), .simulation = simulation, .water_note = water.note};
}

std::vector<std::string> SimulationCaveats(const SimulateOptions& options, const Simulator& simulator,
                                           const ResolvedSimulation& resolved) {
  std::vector<std::string> sentences;
  if (!resolved.water_note.empty()) sentences.push_back(resolved.water_note);
  const std::string caveat = AbsorptionCaveat(simulator.options().absorption, simulator.sonar().frequency_hz,
                                              simulator.options().water);
  if (!caveat.empty()) sentences.push_back(caveat);
  const ParameterSet& parameters = resolved.parameters;
  for (std::string& sentence : MirrorCaveats(parameters, simulator.caster().material_names()))
    sentences.push_back(std::move(sentence));
  if (std::string note = RaysNote(options.rays, simulator); !note.empty())
    sentences.push_back(std::move(note));
  return sentences;
}

ExitStatus RunSimulate(const SimulateOptions& options) {
  const ThreadLimit threads(options.rays.threads);
  const SonarChoice choice = ChooseSonar(options.sonar);
  const ResolvedSimulation resolved = ResolveSimulation(options, choice, ReadParameters(options.params));
  const ParameterSet& parameters = resolved.parameters;
  std::vector<TimedPose> poses = ReadPosesOrRecording(options.poses);
  Scene scene = ReadSceneFile(options.scene, options.scene_format, options.common);
  const std::string scene_digest = SceneDigest(scene);
  const Simulator simulator(std::move(scene), choice.sonar, resolved.simulation);
  for (const std::string& sentence : SimulationCaveats(options, simulator, resolved))
    PrintNote(options.common, sentence);

  std::vector<Pose> world_from_sonar;
  for (const TimedPose& pose : poses) world_from_sonar.push_back(pose.world_from_sonar);
  const std::vector<int> empty = PosesThatSeeNothing(simulator, world_from_sonar);
  if (!empty.empty()) PrintNote(options.common, EmptyFramesWarning(simulator, world_from_sonar, empty));
  const std::int64_t rays_to_look = simulator.caster().rays_cast();

  const Interruption interruption;  // before anything is aside that a run could go on with
  const FilesBeside beside(options, simulator);
  RunOutput output(options.out, "simulate", options.common.force,
                   options.resume ? Aside::kFound : Aside::kAnew);
  const SimulatedRecording recording(
      simulator, std::move(poses), parameters, options.scene.string(),
      [&](int index, const Pose& pose, const PolarImage& image) { beside.Write(output, index, pose, image); },
      options.expected);
  Provenance provenance{.command = "simulate",
                        .configuration = ConfigurationJson(options, simulator, parameters.model),
                        .inputs = {options.scene, options.params, options.poses}};
  if (IsRandom(options, parameters.model)) provenance.seed = resolved.simulation.seed;
  if (choice.input && *choice.input != options.poses) provenance.inputs.push_back(*choice.input);
  provenance.made_of = FramesMadeOf(recording, scene_digest, parameters, provenance);
  FinishedFrames finished;
  if (options.resume) finished = FinishedFrames(output, provenance.made_of);
  if (finished.in_folder()) output.GoOn();
  // Before any frame: what is found after a kill says what it is.
  WriteProvenance(output.staging(), provenance);
  const int frames_done =
      WriteMissingFrames(recording, beside, finished, options.common, interruption, output);
  if (frames_done == 0) {
    PrintError("interrupted before the first frame was finished: nothing was written");
    return ExitStatus::kInterrupted;
  }
  WriteParameters(output / "params.json", parameters);
  output.Commit();
  if (frames_done < recording.frame_count()) {
    PrintError(
        fmt::format("interrupted: {} of {} frames are finished, a recording in {}; the same command with "
                    "--resume makes the rest",
                    frames_done, recording.frame_count(), options.out.string()));
    return ExitStatus::kInterrupted;
  }

  if (options.common.json) {
    PrintJson({{"recording", output.final_path().string()},
               {"frames", recording.frame_count()},
               {"model", ToString(parameters.model)},
               {"rays_cast", simulator.caster().rays_cast() - rays_to_look},
               {"absorption_db_per_m", simulator.absorption_db_per_m()},
               {"frames_without_echo", empty}});
  } else {
    PrintResult(fmt::format("{}: {} {} by the {} model, {} x {} rays each\n", options.out.string(),
                            recording.frame_count(), recording.frame_count() == 1 ? "frame" : "frames",
                            ToString(parameters.model), simulator.fan().cols(), simulator.fan().rows()));
  }
  return ExitStatus::kDone;
}

void AddSimulateOptions(CLI::App* command, SimulateOptions* options) {
  AddSceneOptions(*command, options->scene, options->scene_format, "Scene, its materials by name",
                  /*required=*/true);
  AddSonar(*command, options->sonar)->required();
  command->add_option("--params", options->params, "Parameters: materials, levels in dB, errors")
      ->type_name("JSON")
      ->required();
  command
      ->add_option("--poses", options->poses, "Poses, one a frame: a recording that has them, or a JSON file")
      ->type_name("REC|FILE")
      ->required();
  AddOutFolder(*command, options->out, options->common, "Recording folder to write")->required();
  AddChoice(*command, "--model", options->model, kModels, "Echo model (default: that of the parameters)");
  AddRayOptions(*command, options->rays);
  command->add_option("--bits", options->bits, "Bits of a grey value: 8, 12 or 16")
      ->type_name("BITS")
      ->check(CLI::IsMember({8, 12, 16}).description(""));
  command->add_flag("--noise", options->noise,
                    "Add noise: range and azimuth errors (paper), speckle and receiver noise (acoustic; "
                    "coherent has them anyway)");
  command->add_flag(
      "--expected", options->expected,
      "Write the expected image, which fit and reproduce score: the mean over range and azimuth "
      "errors (paper) or over speckle and receiver noise (acoustic, coherent)");
  command->add_flag("--frozen-speckle", options->frozen_speckle,
                    "Speckle from the seed alone, the same in every frame as long as nothing moves; receiver "
                    "noise stays fresh (acoustic, coherent)");
  AddReachOptions(*command, options->ghost_order, options->margin_deg);
  AddSeed(*command, options->seed, "Seed of the noise; frame i uses seed + i")
      ->default_str(std::to_string(SimulationOptions().seed));
  command->add_flag("--fan", options->fan, "Write each frame as a fan picture as well, fan_NNNN.png");
  command->add_flag("--depth", options->depth,
                    "Write the depth image as well: range along each ray, in metres (range_NNNN.tiff) and in "
                    "millimetres (depth_NNNN.png)");
  command->add_flag("--resume", options->resume,
                    "Go on with what an interrupted or killed run of the same command left in --out");
}

void SetupSimulate(CLI::App& app) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command =
      AddCommand(app, "simulate", "Renders what a sonar would see of a scene, as a recording");
  AddSimulateOptions(command, options.get());
  OnRun(command, options->common, [options] { return RunSimulate(*options); });
}

}  // namespace sonarcal
