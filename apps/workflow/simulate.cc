#include "apps/workflow/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "apps/workflow/rays/ray_options.h"
#include "core/math/pose_groups.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recalibrated_recording.h"
#include "data_io/recordings/recording_io.h"
#include "sim/gathered/empty_frames.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::workflow {

std::string WaterText(const Water& water) {
  return fmt::format("{:g} C, {:g} ppt, pH {:g}, {:g} m deep", water.temperature_c, water.salinity_ppt,
                     water.ph, water.depth_m);
}

namespace {

// Meaning of the random numbers of a model.
std::string NoiseText(const sim::Simulator& simulator, const ParameterSet& parameters, bool expected) {
  if (expected)
    return fmt::format("none: expected image, the mean over {}", parameters.model == EchoModel::kPaper
                                                                     ? "range and azimuth errors"
                                                                     : "speckle and noise");
  if (!simulator.options().noise && parameters.model != EchoModel::kCoherent) return "none";
  const std::uint64_t seed = simulator.options().seed;
  if (parameters.model == EchoModel::kPaper) {
    return fmt::format("range and azimuth errors, seed {} + frame", seed);
  }
  if (simulator.options().frozen_speckle) {
    return fmt::format("frozen speckle, seed {} + first frame of the pose; receiver noise, seed {} + frame",
                       seed, seed);
  }
  return fmt::format("speckle and receiver noise, seed {} + frame", seed);
}

}  // namespace

SonarChoice ChooseSonar(const std::string& name_or_file) {
  const auto& presets = sim::SonarPresets();
  const auto preset = std::find_if(presets.begin(), presets.end(),
                                   [&](const sim::SonarPreset& p) { return p.name == name_or_file; });
  if (preset != presets.end()) return {preset->sonar, preset->water, {}};
  const std::filesystem::path path = name_or_file;
  if (!std::filesystem::exists(path)) sim::FindSonarPreset(name_or_file);  // throws and lists the presets
  const bool sonar_only = path.extension() == ".json" && !data_io::IsRecordingFolder(path);
  const RecordingInfo info = sonar_only ? data_io::ReadSonarFile(path) : data_io::OpenRecording(path)->info();
  return {info.sonar, info.water, path};
}

std::unique_ptr<RecordingSource> OpenRecordingWith(const std::filesystem::path& path,
                                                   const std::string& sonar) {
  std::unique_ptr<RecordingSource> recording = data_io::OpenRecording(path);
  if (sonar.empty()) return recording;
  return std::make_unique<data_io::RecalibratedRecording>(std::move(recording), ChooseSonar(sonar).sonar);
}

WaterChoice ChooseWater(const ParameterSet& parameters, const std::optional<Water>& of_sonar) {
  if (parameters.water) {
    if (!of_sonar || *of_sonar == *parameters.water) return {*parameters.water, {}};
    return {*parameters.water, fmt::format("water of the parameters ({}) is used, not that of the sonar ({})",
                                           WaterText(*parameters.water), WaterText(*of_sonar))};
  }
  if (of_sonar) return {*of_sonar, {}};
  const Water fresh;
  return {fresh,
          fmt::format("neither the parameters nor the sonar give a water: {} is used", WaterText(fresh))};
}

std::vector<std::string> MirrorCaveats(const ParameterSet& parameters,
                                       const std::vector<std::string>& material_names) {
  if (parameters.model == EchoModel::kPaper && !parameters.mirrors.empty())
    return {"warning: the paper's model shows no ghosts of the parameters' mirrors"};
  std::vector<std::string> sentences;
  for (const auto& [name, mirror] : parameters.mirrors) {
    if (std::find(material_names.begin(), material_names.end(), name) == material_names.end())
      sentences.push_back(fmt::format("warning: the mirror '{}' is no material of the scene", name));
  }
  return sentences;
}

namespace {

// Parameters of a model that correspond to settings of a recorder.
SonarSettings SettingsOf(const ParameterSet& parameters) {
  SonarSettings settings;
  settings.compression =
      parameters.display.law == DisplayLaw::kPower ? Compression::kPower : Compression::kLogarithm;
  // The paper's model has no time-varied gain.
  if (parameters.model != EchoModel::kPaper)
    settings.time_varied_gain = parameters.receiver.time_varied_gain != TimeVariedGain::kNone;
  return settings;
}

}  // namespace

RecordingInfo SimulatedRecordingInfo(const sim::Simulator& simulator, const ParameterSet& parameters,
                                     const std::string& scene_path, bool expected) {
  const sim::SimulationOptions& options = simulator.options();
  RecordingInfo info;
  info.source = "simulation";
  info.sonar = simulator.sonar();
  info.scale = {.quantity = Quantity::kGrey,
                .full_scale = options.full_scale(),
                .db_min = parameters.display.db_min,
                .db_max = parameters.display.db_max,
                .db_span = {}};
  info.settings = SettingsOf(parameters);
  info.water = options.water;
  info.source_level_db = parameters.source_level_db;
  if (!scene_path.empty()) info.scene_path = scene_path;
  info.synthetic = true;
  info.details = {
      {"generator", "sonarcal " SONARCAL_VERSION},
      {"model", std::string(ToString(parameters.model))},
      {"rays", fmt::format("{}x{}, {}{}", simulator.fan().cols(), simulator.fan().rows(),
                           ToString(options.fan.sampling), options.fan.stagger ? ", staggered" : "")},
      {"normals", std::string(ToString(options.trace.normals))},
      {"absorption", fmt::format("{:.4f} dB/m, {}", simulator.absorption_db_per_m(),
                                 ToString(sim::ResolvedAbsorption(options.absorption, info.sonar.frequency_hz,
                                                                  options.water)))},
      {"noise", NoiseText(simulator, parameters, expected)}};
  if (parameters.model == EchoModel::kPaper)
    info.details.emplace_back("ray weight", std::string(ToString(options.fan.weight)));
  return info;
}

PolarImage ExpectedFrame(const sim::Simulator& simulator, const sim::EchoList& echoes,
                         const ParameterSet& parameters, const sim::GhostList& ghosts) {
  PolarImage image = simulator.RenderExpected(echoes, parameters, ghosts);
  sim::QuantiseImage(image);
  return image;
}

std::vector<int> SpeckleFrames(const std::vector<data_io::TimedPose>& poses) {
  std::vector<Pose> of;
  for (const data_io::TimedPose& pose : poses) of.push_back(pose.world_from_sonar);
  return FirstOfPose(of);
}

SimulatedRecording::SimulatedRecording(const sim::Simulator& simulator, std::vector<data_io::TimedPose> poses,
                                       ParameterSet parameters, const std::string& scene_path,
                                       OnFrame on_frame, bool expected, int first_frame,
                                       std::vector<int> speckle_frames)
    : simulator_(simulator),
      poses_(std::move(poses)),
      parameters_(std::move(parameters)),
      info_(SimulatedRecordingInfo(simulator, parameters_, scene_path, expected)),
      on_frame_(std::move(on_frame)),
      expected_(expected),
      first_frame_(first_frame),
      speckle_frames_(std::move(speckle_frames)) {
  if (simulator.options().frozen_speckle && speckle_frames_.empty()) speckle_frames_ = SpeckleFrames(poses_);
}

FrameInfo SimulatedRecording::frame_info(int index) const {
  const data_io::TimedPose& pose = poses_.at(index);
  return {fmt::format("frame {}", first_frame_ + index), pose.time_s, pose.world_from_sonar, info_.settings,
          pose.motion};
}

Frame SimulatedRecording::ReadFrame(int index) const {
  Frame frame{frame_info(index), {}};
  const Pose& pose = *frame.info.world_from_sonar;
  const std::vector<PingPose> pings = PosesOfPings(info_.sonar.pings, frame.info.motion);
  // Without noise, the images of the acoustic model are the expected ones, in one pass over the rays.
  if (expected_ && parameters_.model != EchoModel::kAcoustic) {
    const bool coherent = parameters_.model == EchoModel::kCoherent;
    frame.image = RenderByPing(pose, pings, [&](const Pose& at) {
      return ExpectedFrame(simulator_, simulator_.TraceEchoes(at), parameters_,
                           coherent ? simulator_.TraceGhosts(at, parameters_) : sim::GhostList{});
    });
  } else {
    const int speckle_frame = speckle_frames_.empty() ? 0 : speckle_frames_[index];
    frame.image = simulator_.RenderPings(pose, pings, parameters_,
                                         simulator_.SeedsOf(first_frame_ + index, speckle_frame));
  }
  if (on_frame_) on_frame_(index, pose, frame.image);
  return frame;
}

std::unique_ptr<MemoryRecording> SimulateRecording(const sim::Simulator& simulator,
                                                   const std::vector<data_io::TimedPose>& poses,
                                                   const ParameterSet& parameters,
                                                   const std::string& scene_path,
                                                   const std::function<void(int)>& progress, bool expected) {
  const SimulatedRecording recording(simulator, poses, parameters, scene_path, {}, expected);
  std::vector<Frame> frames;
  for (int index = 0; index < recording.frame_count(); ++index) {
    frames.push_back(recording.ReadFrame(index));
    if (progress) progress(index + 1);
  }
  return std::make_unique<MemoryRecording>(recording.info(), std::move(frames));
}

Grid<float> RangeAlongRays(const sim::EchoList& echoes, const sim::RayFan& fan) {
  Grid<float> range_m(fan.rows(), fan.cols());
  for (std::size_t i = 0; i < echoes.size(); ++i) range_m.values()[echoes.ray[i]] = echoes.range_m[i];
  return range_m;
}

namespace {

void CheckFrozenSpeckle(const SimulateOptions& options, EchoModel model) {
  if (!options.frozen_speckle) return;
  if (model == EchoModel::kPaper) {
    throw UsageError("--frozen-speckle is for the models acoustic and coherent: the paper's has no speckle");
  }
  if (options.expected)
    throw UsageError("--frozen-speckle has no effect with --expected, which has no speckle");
  if (!IsRandom(options, model))
    throw UsageError("--frozen-speckle needs --noise: without it there is no speckle");
}

// Throws UsageError if the text is not "X:Y:Z:TS".
sim::PointTarget PointTargetOf(const std::string& text) {
  std::vector<double> values;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    double value = 0.0;
    const char* last = text.data() + end;
    const auto [stop, error] = std::from_chars(text.data() + begin, last, value);
    if (error != std::errc() || stop != last || !std::isfinite(value) || std::abs(value) > 1e4) {
      values.clear();
      break;
    }
    values.push_back(value);
    begin = end + 1;
  }
  if (values.size() != 4)
    throw UsageError("--point-target is '{}', expected X:Y:Z:TS with a place in m and a level in dB", text);
  return {.position_m = {values[0], values[1], values[2]}, .cross_section_m2 = PowerFromDb(values[3])};
}

// Throws UsageError for options that change nothing with these parameters.
void RefuseWithoutEffect(const SimulateOptions& options, const ParameterSet& parameters) {
  const EchoModel model = parameters.model;
  if (options.seed && !IsRandom(options, model))
    throw UsageError("--seed has no effect without --noise: nothing is random");
  if (options.noise && model == EchoModel::kPaper && parameters.jitter.sigma_range_m == 0.0 &&
      parameters.jitter.sigma_azimuth_deg == 0.0) {
    throw UsageError(
        "--noise has no effect: jitter.sigma_range_m and jitter.sigma_azimuth_deg, the range and azimuth "
        "errors of the paper's model, are both 0");
  }
  if (options.ghost_order > 1 && (model == EchoModel::kPaper || parameters.mirrors.empty())) {
    throw UsageError(
        "--ghost-order {} has no effect: {}", options.ghost_order,
        model == EchoModel::kPaper ? "the paper's model has no ghosts" : "the parameters name no mirror");
  }
  if (!options.point_target.empty() && (model != EchoModel::kCoherent || options.expected))
    throw UsageError("--point-target has no effect: only samples of the coherent model have point targets");
  if (options.rays.normals == sim::NormalSource::kDepth && model == EchoModel::kCoherent)
    throw UsageError("--normals depth has no effect: the coherent model takes those of the mesh");
}

}  // namespace

bool IsRandom(const SimulateOptions& options, EchoModel model) {
  return options.noise || (model == EchoModel::kCoherent && !options.expected);
}

PreparedSimulation PrepareSimulation(const SimulateOptions& options, const SonarChoice& sonar,
                                     ParameterSet parameters) {
  if (options.model) parameters.model = *options.model;
  if (options.bits != 8 && options.bits != 12 && options.bits != 16)
    throw UsageError("--bits {}, expected 8, 12 or 16", options.bits);
  if (options.expected && options.noise)
    throw UsageError("--expected contradicts --noise: an expected image is the mean over noise and speckle");
  CheckFrozenSpeckle(options, parameters.model);
  CheckRayWeight(options.rays.ray_weight, parameters.model);
  RefuseWithoutEffect(options, parameters);
  const WaterChoice water = ChooseWater(parameters, sonar.water);
  sim::SimulationOptions simulation = options.rays.For(sonar.sonar, water.water, parameters);
  simulation.bits = options.bits;
  simulation.noise = IsRandom(options, parameters.model);
  simulation.frozen_speckle = options.frozen_speckle;
  simulation.ghost_order = options.ghost_order;
  if (options.margin_deg) simulation.fan.azimuth_margin_deg = *options.margin_deg;
  if (options.seed) simulation.seed = *options.seed;
  for (const std::string& target : options.point_target)
    simulation.point_targets.push_back(PointTargetOf(target));
  return {.parameters = std::move(parameters), .simulation = simulation, .water_note = water.note};
}

namespace {

// Parameters for which a frame takes many times as long as usual.
std::vector<std::string> CostCaveats(const SimulateOptions& options, const sim::Simulator& simulator,
                                     const ParameterSet& parameters) {
  constexpr double kManyTimes = 16.0;
  std::vector<std::string> sentences;
  if (parameters.model == EchoModel::kPaper || !IsRandom(options, parameters.model)) return sentences;
  if (const double looks = parameters.receiver.looks; looks > kManyTimes) {
    sentences.push_back(fmt::format(
        "warning: receiver.looks is {:g}: a sample draws as many fields, so that a frame takes up to {:g} "
        "times as long as with one look",
        looks, looks));
  }
  const PolarAxes& axes = simulator.sonar().axes;
  const double pulse_m = sim::PulseLengthM(simulator.sonar(), parameters);
  if (parameters.model == EchoModel::kCoherent && pulse_m > kManyTimes * axes.range_bin_m()) {
    sentences.push_back(fmt::format(
        "warning: the pulse is {:g} m long, {:.0f} range bins: the coherent model adds each echo to all bins "
        "that its pulse reaches, so that a frame takes many times as long as usual",
        pulse_m, pulse_m / axes.range_bin_m()));
  }
  return sentences;
}

}  // namespace

std::vector<std::string> SimulationMessages(const SimulateOptions& options, const sim::Simulator& simulator,
                                            const PreparedSimulation& prepared) {
  std::vector<std::string> sentences;
  if (!prepared.water_note.empty()) sentences.push_back(prepared.water_note);
  const std::string caveat = sim::AbsorptionCaveat(simulator.options().absorption,
                                                   simulator.sonar().frequency_hz, simulator.options().water);
  if (!caveat.empty()) sentences.push_back(caveat);
  const ParameterSet& parameters = prepared.parameters;
  for (std::string& sentence : MirrorCaveats(parameters, simulator.caster().material_names()))
    sentences.push_back(std::move(sentence));
  for (std::string& sentence : CostCaveats(options, simulator, parameters))
    sentences.push_back(std::move(sentence));
  if (std::string note = RaysNote(options.rays, simulator); !note.empty())
    sentences.push_back(std::move(note));
  return sentences;
}

std::unique_ptr<MemoryRecording> Simulate(const Scene& scene, const SonarChoice& sonar,
                                          const ParameterSet& parameters,
                                          const std::vector<data_io::TimedPose>& poses,
                                          const SimulateOptions& options, const Listener& listener,
                                          const std::string& scene_path) {
  if (poses.empty()) throw DataError("poses: none, expected one or more");
  const std::vector<data_io::TimedPose> moving = data_io::WithMotion(poses, sonar.sonar.pings);
  const ThreadLimit threads(options.rays.threads);
  const PreparedSimulation prepared = PrepareSimulation(options, sonar, parameters);
  const sim::Simulator simulator(scene, sonar.sonar, prepared.simulation);
  for (const std::string& sentence : SimulationMessages(options, simulator, prepared))
    listener.Message(sentence);
  const std::vector<Pose> world_from_sonar = data_io::PosesAlone(poses);
  const int total = static_cast<int>(poses.size());
  const std::vector<int> empty = sim::PosesThatSeeNothing(
      simulator, world_from_sonar, [&](int done) { listener.Progress("Checking the poses", done, total); });
  if (!empty.empty()) listener.Message(sim::EmptyFramesWarning(simulator, world_from_sonar, empty));
  return SimulateRecording(
      simulator, moving, prepared.parameters, scene_path,
      [&](int done) { listener.Progress("Simulating", done, total); }, options.expected);
}

}  // namespace sonarcal::workflow
