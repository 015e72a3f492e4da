#include "apps/simulate_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/ray_options.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal {
namespace {

std::string WaterText(const Water& water) {
  return fmt::format("{:g} C, {:g} ppt, pH {:g}, {:g} m deep", water.temperature_c, water.salinity_ppt,
                     water.ph, water.depth_m);
}

// What the random numbers of a model stand for.
std::string NoiseText(const Simulator& simulator, const ParameterSet& parameters, bool expected) {
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
    return fmt::format("frozen speckle, seed {}; receiver noise, seed {} + frame", seed, seed);
  }
  return fmt::format("speckle and receiver noise, seed {} + frame", seed);
}

}  // namespace

SonarChoice ChooseSonar(const std::string& name_or_file) {
  const auto& presets = SonarPresets();
  const auto preset = std::find_if(presets.begin(), presets.end(),
                                   [&](const SonarPreset& p) { return p.name == name_or_file; });
  if (preset != presets.end()) return {preset->sonar, preset->water, {}};
  const std::filesystem::path path = name_or_file;
  if (!std::filesystem::exists(path)) FindSonarPreset(name_or_file);  // throws, naming the presets
  const bool sonar_only = path.extension() == ".json" && !IsRecordingFolder(path);
  const RecordingInfo info = sonar_only ? ReadSonarFile(path) : OpenRecording(path)->info();
  return {info.sonar, info.water, path};
}

WaterChoice ChooseWater(const ParameterSet& parameters, const std::optional<Water>& of_sonar) {
  if (parameters.water) {
    if (!of_sonar || *of_sonar == *parameters.water) return {*parameters.water, {}};
    return {*parameters.water, fmt::format("water of the parameters ({}) is used, not that of the sonar ({})",
                                           WaterText(*parameters.water), WaterText(*of_sonar))};
  }
  if (of_sonar) return {*of_sonar, {}};
  const Water fresh;
  return {fresh, fmt::format("no water is given, neither by the parameters nor by the sonar: taking {}",
                             WaterText(fresh))};
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

// What of a model's parameters a recorder would have to have set alike.
SonarSettings SettingsOf(const ParameterSet& parameters) {
  SonarSettings settings;
  settings.compression =
      parameters.display.law == DisplayLaw::kPower ? Compression::kPower : Compression::kLogarithm;
  // The paper's model knows no gain over range, on or off.
  if (parameters.model != EchoModel::kPaper)
    settings.time_varied_gain = parameters.receiver.time_varied_gain != TimeVariedGain::kNone;
  return settings;
}

}  // namespace

RecordingInfo SimulatedRecordingInfo(const Simulator& simulator, const ParameterSet& parameters,
                                     const std::string& scene_path, bool expected) {
  const SimulationOptions& options = simulator.options();
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
      {"absorption",
       fmt::format("{:.4f} dB/m, {}", simulator.absorption_db_per_m(),
                   ToString(ResolvedAbsorption(options.absorption, info.sonar.frequency_hz, options.water)))},
      {"noise", NoiseText(simulator, parameters, expected)}};
  if (parameters.model == EchoModel::kPaper)
    info.details.emplace_back("ray weight", std::string(ToString(options.fan.weight)));
  return info;
}

PolarImage ExpectedFrame(const Simulator& simulator, const EchoList& echoes, const ParameterSet& parameters,
                         const GhostList& ghosts) {
  PolarImage image = simulator.RenderExpected(echoes, parameters, ghosts);
  QuantiseImage(image);
  return image;
}

SimulatedRecording::SimulatedRecording(const Simulator& simulator, std::vector<TimedPose> poses,
                                       ParameterSet parameters, const std::string& scene_path,
                                       OnFrame on_frame, bool expected)
    : simulator_(simulator),
      poses_(std::move(poses)),
      parameters_(std::move(parameters)),
      info_(SimulatedRecordingInfo(simulator, parameters_, scene_path, expected)),
      on_frame_(std::move(on_frame)),
      expected_(expected) {}

FrameInfo SimulatedRecording::frame_info(int index) const {
  const TimedPose& pose = poses_.at(index);
  return {fmt::format("frame {}", index), pose.time_s, pose.world_from_sonar, info_.settings};
}

Frame SimulatedRecording::ReadFrame(int index) const {
  Frame frame{frame_info(index), {}};
  const Pose& pose = *frame.info.world_from_sonar;
  // Without noise the acoustic model's images are the expected ones, in one pass over the rays.
  if (expected_ && parameters_.model != EchoModel::kAcoustic) {
    const bool coherent = parameters_.model == EchoModel::kCoherent;
    frame.image = ExpectedFrame(simulator_, simulator_.TraceEchoes(pose), parameters_,
                                coherent ? simulator_.TraceGhosts(pose, parameters_) : GhostList{});
  } else {
    frame.image = simulator_.Render(pose, parameters_, index);
  }
  if (on_frame_) on_frame_(index, pose, frame.image);
  return frame;
}

std::unique_ptr<MemoryRecording> SimulateRecording(const Simulator& simulator,
                                                   const std::vector<TimedPose>& poses,
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

Grid<float> RangeAlongRays(const EchoList& echoes, const RayFan& fan) {
  Grid<float> range_m(fan.rows(), fan.cols());
  for (std::size_t i = 0; i < echoes.size(); ++i) range_m.values()[echoes.ray[i]] = echoes.range_m[i];
  return range_m;
}

}  // namespace sonarcal
