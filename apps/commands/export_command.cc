// `sonarcal export --to WHAT --out FILE`: writes parameters and sonar as the configuration of another
// simulator, a recording as a file of other tools, or fitted curves as named materials.
#include <fmt/ranges.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/bag_options.h"
#include "apps/cli/choice_option.h"
#include "apps/cli/command.h"
#include "apps/cli/given_options.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/scene_option.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/export/simulator_configs.h"
#include "apps/workflow/materials/fitted_materials.h"
#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "core/types/words.h"
#include "data_io/bag_writers/mcap_recording_writer.h"
#include "data_io/bag_writers/ros1_bag_writer.h"
#include "data_io/files/hash.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/materials_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/fan_pictures.h"
#include "data_io/recordings/npz_writer.h"
#include "data_io/recordings/recalibrated_recording.h"
#include "data_io/recordings/selected_frames.h"
#include "data_io/scenes/cad_io.h"

namespace sonarcal::commands {
namespace {

enum class ExportTarget {
  kDave,
  kDaveRos2,
  kHoloOcean,
  kStonefish,
  kOceanSim,
  kGazebo,
  kRos1Bag,
  kMcap,
  kNpz,
  kPng,
  kMp4,
  kMaterials
};
constexpr auto WordsOf(std::type_identity<ExportTarget>) {
  return Words<ExportTarget, 12>{{{"dave", ExportTarget::kDave},
                                  {"dave-ros2", ExportTarget::kDaveRos2},
                                  {"holoocean", ExportTarget::kHoloOcean},
                                  {"stonefish", ExportTarget::kStonefish},
                                  {"oceansim", ExportTarget::kOceanSim},
                                  {"gazebo", ExportTarget::kGazebo},
                                  {"rosbag1", ExportTarget::kRos1Bag},
                                  {"mcap", ExportTarget::kMcap},
                                  {"npz", ExportTarget::kNpz},
                                  {"png", ExportTarget::kPng},
                                  {"mp4", ExportTarget::kMp4},
                                  {"materials", ExportTarget::kMaterials}}};
}

struct ExportOptions {
  cli::CommonOptions common;
  ExportTarget to = ExportTarget::kDave;
  std::filesystem::path out;  // a file; for kPng a folder
  // For the configuration of a simulator:
  std::filesystem::path params;
  std::string sonar;          // a preset's name, a recording or a JSON file
  workflow::RayOptions rays;  // absorption
  // For a recording:
  std::filesystem::path recording;
  cli::BagArguments bag;
  FrameList frames;             // empty: all
  std::filesystem::path scene;  // of an MCAP file or a world; empty: for MCAP files that of the recording
  cli::SceneFormat scene_format;
  int height_px = 0;          // height of pictures; 0: one pixel per range bin, at most 800
  double frames_per_s = 0.0;  // frame rate of a video; 0: as recorded
  std::filesystem::path fit;  // fit.json, for kMaterials
};

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct SimulatorExport {
  ExportTarget target;
  exporting::ExportedConfig (*write)(const exporting::ExportSource& source, const std::string& name);
};
constexpr std::array<SimulatorExport, 6> kSimulators = {
    {{ExportTarget::kDave, exporting::ExportToDave},
     {ExportTarget::kDaveRos2, exporting::ExportToDaveRos2},
     {ExportTarget::kHoloOcean, exporting::ExportToHoloOcean},
     {ExportTarget::kStonefish, exporting::ExportToStonefish},
     {ExportTarget::kOceanSim, exporting::ExportToOceanSim},
     {ExportTarget::kGazebo, exporting::ExportToGazebo}}};

const SimulatorExport* SimulatorOf(ExportTarget target) {
  for (const SimulatorExport& simulator : kSimulators) {
    if (simulator.target == target) return &simulator;
  }
  return nullptr;
}

// True for simulators whose export includes a world.
bool HasWorld(ExportTarget target) {
  return target == ExportTarget::kStonefish || target == ExportTarget::kGazebo ||
         target == ExportTarget::kDaveRos2;
}

std::string Word(ExportTarget target) {
  return std::string(ToString(target));
}

void CheckOptions(const ExportOptions& options) {
  const std::string to = Word(options.to);
  const auto refuse = [&](bool given, const char* option, const char* what) {
    if (given) throw UsageError("{} is given with --to {}, expected only for {}", option, to, what);
  };
  if (SimulatorOf(options.to) != nullptr) {
    if (options.params.empty()) throw UsageError("--to {} needs --params, the parameters to export", to);
    if (options.sonar.empty() == options.recording.empty())
      throw UsageError("--to {} needs either --sonar or --recording, for the sonar's geometry", to);
    refuse(!options.frames.empty(), "--frames", "recordings");
  } else {
    if (options.recording.empty()) throw UsageError("--to {} needs --recording, which is exported", to);
    if (options.to == ExportTarget::kMaterials) {
      if (options.fit.empty()) throw UsageError("--to {} needs --fit, the fit.json with the curves", to);
      refuse(!options.frames.empty(), "--frames", "recordings");
    }
    if (options.to != ExportTarget::kMcap) {
      refuse(!options.params.empty(), "--params", "simulators and mcap");
      refuse(!options.sonar.empty(), "--sonar", "simulators and mcap");
    }
  }
  const bool draws = options.to == ExportTarget::kPng || options.to == ExportTarget::kMp4 ||
                     options.to == ExportTarget::kMcap;
  if (!draws) refuse(options.height_px != 0, "--height", "mcap, png and mp4");
  if (options.to != ExportTarget::kMcap && !HasWorld(options.to))
    refuse(!options.scene.empty(), "--scene", "mcap, stonefish, gazebo and dave-ros2");
  if (options.to != ExportTarget::kMaterials) refuse(!options.fit.empty(), "--fit", "materials");
  if (options.to != ExportTarget::kMp4) refuse(options.frames_per_s != 0.0, "--fps", "mp4");
  if (options.to == ExportTarget::kMp4 && options.out.extension() != ".mp4") {
    throw UsageError(
        "--out is '{}', expected a name that ends in .mp4, which determines the container of the video",
        options.out.string());
  }
  if (options.to != ExportTarget::kPng && !options.out.has_filename()) {
    throw UsageError("--out is '{}', expected the name of a file", options.out.string());
  }
}

Json Configuration(const ExportOptions& options) {
  Json configuration = {{"to", Word(options.to)},
                        {"out", options.out.string()},
                        {"params", options.params.string()},
                        {"sonar", options.sonar},
                        {"absorption", ToString(options.rays.absorption)},
                        {"recording", options.recording.string()},
                        {"topic", options.bag.bag.topic},
                        {"frames", options.frames.Text()},
                        {"height_px", options.height_px},
                        {"frames_per_s", options.frames_per_s},
                        {"scene", options.scene.string()},
                        {"fit", options.fit.string()}};
  configuration.update(cli::SceneFormatJson(options.scene_format));
  return configuration;
}

// Folder of --out.
fs::path FolderOf(const fs::path& out) {
  return out.has_parent_path() ? out.parent_path() : fs::path(".");
}

// Makes a folder of pictures, or a file in a folder with other contents.
cli::RunOutput OutputOf(const ExportOptions& options) {
  return options.to == ExportTarget::kPng ? cli::RunOutput(options.out, "export", options.common.force)
                                          : cli::RunOutput::Beside(FolderOf(options.out));
}

struct ChosenSource {
  exporting::ExportSource source;
  std::vector<fs::path> inputs;
};

ChosenSource SourceOf(const ExportOptions& options) {
  ChosenSource chosen{.source = {}, .inputs = {options.params}};
  chosen.source.parameters = data_io::ReadParameters(options.params);
  std::optional<Water> water;
  if (!options.recording.empty()) {
    const auto recording = cli::OpenWithBagOptions(options.recording, options.bag);
    chosen.source.sonar = recording->info().sonar;
    water = recording->info().water;
    if (HasWorld(options.to) && recording->frame_count() > 0)
      chosen.source.world_from_sonar = recording->frame_info(0).world_from_sonar;
    chosen.inputs.push_back(options.recording);
  } else {
    workflow::SonarChoice sonar = workflow::ChooseSonar(options.sonar);
    chosen.source.sonar = std::move(sonar.sonar);
    water = sonar.water;
    if (sonar.input) chosen.inputs.push_back(*sonar.input);
  }
  if (!options.scene.empty()) {
    chosen.source.scene = cli::ReadSceneFile(options.scene, options.scene_format, options.common);
    chosen.inputs.push_back(options.scene);
  }
  const SonarModel& sonar = chosen.source.sonar;
  const std::string& name = options.recording.empty() ? options.sonar : options.recording.string();
  if (!(sonar.frequency_hz > 0.0)) throw DataError("{}: the sonar's frequency_hz is unknown", name);
  if (!(sonar.sound_speed_m_per_s > 0.0))
    throw DataError("{}: the sonar's sound_speed_m_per_s is unknown", name);
  const workflow::WaterChoice choice = workflow::ChooseWater(chosen.source.parameters, water);
  if (!choice.note.empty()) cli::PrintNote(options.common, choice.note);
  chosen.source.water = choice.water;
  chosen.source.absorption_db_per_m =
      sim::AbsorptionDbPerM(options.rays.absorption, sonar.frequency_hz, choice.water);
  return chosen;
}

cli::ExitStatus ExportConfiguration(const ExportOptions& options, const SimulatorExport& simulator) {
  const ChosenSource chosen = SourceOf(options);
  const std::string stem = options.out.stem().string();
  const exporting::ExportedConfig config = simulator.write(chosen.source, stem);
  const Json account = config.account.ToJson();
  Json side = {{"format", "sonarcal-export/1"}, {"to", Word(options.to)}, {"written_for", config.schema}};
  side.update(account);
  side["provenance"] = cli::ProvenanceToJson(
      {.command = "export", .configuration = Configuration(options), .inputs = chosen.inputs});

  cli::RunOutput output = cli::RunOutput::Beside(FolderOf(options.out));
  std::vector<std::string> files;
  const bool is_again = fs::exists(options.out.string() + ".account.json");
  for (const exporting::ExportedFile& file : config.files) {
    files.push_back(file.suffix.empty() ? options.out.filename().string() : stem + file.suffix);
    if (!is_again) cli::CheckOutFile(FolderOf(options.out) / files.back(), {}, options.common.force);
    data_io::WriteFileWhole(output / files.back(), file.text);
  }
  files.push_back(options.out.filename().string() + ".account.json");
  data_io::WriteJson(output / files.back(), side);
  output.Commit();

  for (const std::string& sentence : config.account.Sentences()) cli::PrintNote(options.common, sentence);
  if (options.common.json) {
    side.erase("provenance");
    side["files"] = files;
    cli::PrintJson(side);
  } else {
    cli::PrintResult(
        fmt::format("{}: of {} parameters {} exported, {} approximated, {} not expressed, {} without "
                    "effect; {} says which\n",
                    options.out.string(), account.at("parameters").size(), account.at("exported").get<int>(),
                    account.at("approximated").get<int>(), account.at("not_expressed").get<int>(),
                    account.at("unused").get<int>(), files.back()));
  }
  return cli::ExitStatus::kDone;
}

// Prints which properties of a recording pictures cannot hold.
void NoteWhatPicturesLose(const ExportOptions& options, const RecordingSource& recording) {
  bool with_times = false;
  bool with_poses = false;
  for (int i = 0; i < recording.frame_count(); ++i) {
    const FrameInfo frame = recording.frame_info(i);
    with_times = with_times || frame.time_s.has_value();
    with_poses = with_poses || frame.world_from_sonar.has_value();
  }
  std::vector<std::string> lost;
  // A video keeps the frame rate.
  if (with_times && options.to == ExportTarget::kPng) lost.emplace_back("the times of the frames");
  if (with_poses) lost.emplace_back("the poses");
  if (recording.info().water) lost.emplace_back("the water");
  if (recording.info().valid) lost.emplace_back("which samples hold no measurement");
  if (!lost.empty())
    cli::PrintNote(options.common, fmt::format("not in pictures: {}", fmt::join(lost, ", ")));
}

// Prints which properties of a recording a bag cannot hold.
void NoteWhatBagsLose(const ExportOptions& options, const RecordingInfo& info) {
  const bool is_mcap = options.to == ExportTarget::kMcap;
  std::vector<std::string> lost;
  if (info.water) lost.emplace_back("the water");
  // SonarInfo states the dB scale of an MCAP file, and its metadata state the origin.
  if (!is_mcap && (info.scale.db_min || info.scale.db_span)) lost.emplace_back("the dB scale");
  if (info.scale.quantity == Quantity::kGrey && info.scale.full_scale != 255.0 &&
      info.scale.full_scale != 65535.0) {
    lost.push_back(fmt::format("that {:g} is full scale", info.scale.full_scale));
  }
  if (info.valid) lost.emplace_back("which samples hold no measurement");
  if (!is_mcap && info.synthetic) lost.emplace_back("that the recording is synthetic");
  const char* where = is_mcap ? "not in the messages, only in the metadata" : "not in a bag";
  if (!lost.empty()) cli::PrintNote(options.common, fmt::format("{}: {}", where, fmt::join(lost, ", ")));
}

// Scene of an MCAP file: --scene, or that of the recording, which may be absent.
std::optional<Scene> SceneOf(const ExportOptions& options, const RecordingInfo& info) {
  if (!options.scene.empty()) return cli::ReadSceneFile(options.scene, options.scene_format, options.common);
  if (!info.scene_path) return std::nullopt;
  try {
    Scene scene = data_io::ReadScene(*info.scene_path);
    if (scene.triangles.size() <= data_io::kMaxMcapSceneTriangles) return scene;
    throw DataError("{}: {} triangles, expected at most {}", *info.scene_path, scene.triangles.size(),
                    data_io::kMaxMcapSceneTriangles);
  } catch (const DataError& error) {
    cli::PrintNote(options.common, fmt::format("the file has no scene: {}", error.what()));
    return std::nullopt;
  }
}

// Calibration of an MCAP file: --params, identified by its name and hash.
std::optional<data_io::SonarCalibration> CalibrationOf(const ExportOptions& options,
                                                       const RecordingInfo& info) {
  if (options.params.empty()) return std::nullopt;
  data_io::SonarCalibration calibration{.parameters = data_io::ReadParameters(options.params),
                                        .reference = {}};
  const workflow::WaterChoice water = workflow::ChooseWater(calibration.parameters, info.water);
  if (!water.note.empty()) cli::PrintNote(options.common, water.note);
  calibration.absorption_db_per_m =
      info.sonar.frequency_hz > 0.0
          ? sim::AbsorptionDbPerM(options.rays.absorption, info.sonar.frequency_hz, water.water)
          : std::numeric_limits<double>::quiet_NaN();
  constexpr std::size_t kShownDigits = 16;
  calibration.reference = fmt::format("{} sha256:{}", options.params.filename().string(),
                                      data_io::Sha256OfFile(options.params).substr(0, kShownDigits));
  const auto written = std::chrono::file_clock::to_sys(fs::last_write_time(options.params));
  calibration.time_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(written.time_since_epoch()).count();
  return calibration;
}

void WriteMcap(const ExportOptions& options, const RecordingSource& recording, const fs::path& file,
               const std::function<void(int)>& advance) {
  const std::optional<Scene> scene = SceneOf(options, recording.info());
  if (recording.info().scale.quantity != Quantity::kGrey)
    cli::PrintNote(options.common, "no fan pictures: only grey values are drawn as a fan");
  data_io::WriteMcapRecording(recording,
                              {.scene = scene ? &*scene : nullptr,
                               .fan_height_px = options.height_px,
                               .calibration = CalibrationOf(options, recording.info())},
                              fmt::format("sonarcal {}", SONARCAL_VERSION), file, advance);
}

cli::ExitStatus ExportRecording(const ExportOptions& options) {
  std::unique_ptr<RecordingSource> recording = cli::OpenWithBagOptions(options.recording, options.bag);
  recording = data_io::SelectFrames(std::move(recording), options.frames);
  if (!options.sonar.empty()) {
    recording = std::make_unique<data_io::RecalibratedRecording>(std::move(recording),
                                                                 workflow::ChooseSonar(options.sonar).sonar);
  }
  if (options.to == ExportTarget::kRos1Bag || options.to == ExportTarget::kMcap)
    NoteWhatBagsLose(options, recording->info());
  if (options.to == ExportTarget::kPng || options.to == ExportTarget::kMp4)
    NoteWhatPicturesLose(options, *recording);
  const cli::Provenance provenance{.command = "export",
                                   .configuration = Configuration(options),
                                   .inputs = {options.recording, cli::SonarFile(options.sonar),
                                              options.bag.picture_geometry, options.scene, options.params}};

  const bool is_folder = options.to == ExportTarget::kPng;
  cli::RunOutput output = OutputOf(options);
  const fs::path file = output / options.out.filename();
  cli::Progress progress("Exporting", recording->frame_count(), options.common, "frames");
  const auto advance = [&](int frames_done) { progress.Update(frames_done); };
  if (options.to == ExportTarget::kRos1Bag) {
    data_io::WriteRos1Bag(*recording, file, advance);
  } else if (options.to == ExportTarget::kMcap) {
    WriteMcap(options, *recording, file, advance);
  } else if (options.to == ExportTarget::kNpz) {
    data_io::WriteNpz(*recording, file, advance);
  } else {
    const data_io::FanPainter painter(recording->info(), {.height_px = options.height_px});
    if (is_folder) {
      data_io::WriteFanPngs(*recording, painter, output.staging(), advance);
    } else {
      constexpr double kWithoutTimes = 10.0;
      double frames_per_s =
          options.frames_per_s > 0.0 ? options.frames_per_s : data_io::RecordedFramesPerS(*recording);
      if (frames_per_s == 0.0) frames_per_s = kWithoutTimes;
      data_io::WriteFanVideo(*recording, painter, frames_per_s, file, advance);
      data_io::WriteFileWhole(output / (options.out.filename().string() + ".geometry.json"),
                              painter.GeometryJson());
    }
  }
  if (is_folder) {
    cli::WriteProvenance(output.staging(), provenance);
  } else {
    data_io::WriteJson(output / (options.out.filename().string() + ".provenance.json"),
                       cli::ProvenanceToJson(provenance));
  }
  output.Commit();

  const int count = recording->frame_count();
  if (options.common.json) {
    cli::PrintJson({{"file", options.out.string()},
                    {"to", Word(options.to)},
                    {"frames", count},
                    {"synthetic", recording->info().synthetic}});
  } else {
    cli::PrintResult(fmt::format("{}: {} {}{}\n", options.out.string(), count,
                                 count == 1 ? "frame" : "frames",
                                 recording->info().synthetic ? " (synthetic)" : ""));
  }
  return cli::ExitStatus::kDone;
}

// Writes the fitted curves as named materials.
cli::ExitStatus ExportMaterials(const ExportOptions& options) {
  const auto recording = cli::OpenWithBagOptions(options.recording, options.bag);
  const std::vector<NamedMaterial> materials = workflow::FittedMaterials(options.fit, recording->info());
  const Json json = data_io::MaterialsJson(materials);
  cli::RunOutput output = OutputOf(options);
  const std::string file = options.out.filename().string();
  data_io::WriteJson(output / file, json);
  data_io::WriteJson(output / (file + ".provenance.json"),
                     cli::ProvenanceToJson({.command = "export",
                                            .configuration = Configuration(options),
                                            .inputs = {options.recording, options.fit}}));
  output.Commit();
  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    std::vector<std::string> names;
    for (const NamedMaterial& material : materials) names.push_back(material.name);
    cli::PrintResult(fmt::format("{}: {}{}; --materials {} makes them known to fit and calibrate\n",
                                 options.out.string(), fmt::join(names, ", "),
                                 recording->info().synthetic ? " (synthetic)" : "", options.out.string()));
  }
  return cli::ExitStatus::kDone;
}

}  // namespace

cli::ExitStatus RunExport(const ExportOptions& options) {
  CheckOptions(options);
  if (options.to != ExportTarget::kPng) {
    cli::CheckOutFile(options.out,
                      {options.recording, options.params, options.scene, options.fit, options.sonar},
                      options.common.force);
  }
  if (options.to == ExportTarget::kMaterials) return ExportMaterials(options);
  const SimulatorExport* simulator = SimulatorOf(options.to);
  return simulator == nullptr ? ExportRecording(options) : ExportConfiguration(options, *simulator);
}

void SetupExport(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = cli::AddCommand(app, "export", "Writes parameters or a recording for other tools");
  cli::internal::AddChoice<ExportTarget>(
      *command, "--to", "Simulator whose configuration is written, format of a recording, or materials",
      [options](ExportTarget to) { options->to = to; })
      ->required();
  cli::AddOutFolder(*command, options->out, options->common,
                    "File to write (a folder for png); an account of the export is written beside it as JSON")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--params", options->params,
                   "Parameters to export to a simulator, or into an MCAP file as SonarInfo")
      ->type_name("JSON");
  cli::AddSonar(*command, options->sonar,
                " (for the configuration of a simulator, or in place of the recording's in an MCAP file)");
  cli::AddOptionNamed(*command, options->rays, "absorption");
  command
      ->add_option("--recording", options->recording,
                   "Recording to export, of any format; for simulators, a recording of the sonar; for "
                   "materials, the one that was fitted")
      ->type_name("REC");
  command
      ->add_option("--fit", options->fit,
                   "For materials: fit.json of a fit to --recording, whose curves become named materials")
      ->type_name("JSON");
  cli::AddBagOptions(*command, options->bag);
  cli::AddFrames(*command, options->frames, "Frames to export");
  cli::AddSceneOptions(
      *command, options->scene, options->scene_format,
      "Scene to write into an MCAP file (default: that of the recording) or into the world of a "
      "simulator",
      false);
  command
      ->add_option("--height", options->height_px,
                   "Height of pictures, pixels (default: one per range bin, at most 800)")
      ->type_name("PX")
      ->default_str("")
      ->check(CLI::Range(2, 10000).description(""));
  command
      ->add_option("--fps", options->frames_per_s,
                   "Frames per second of a video (default: as recorded, 10 if frames have no times)")
      ->type_name("HZ")
      ->default_str("")
      ->check(cli::Within(0.01, 1000.0));
  cli::OnRun(command, options->common, [command, options] {
    if (SimulatorOf(options->to) == nullptr &&
        (options->to != ExportTarget::kMcap || options->params.empty()))
      cli::RefuseGiven(*command, {"--absorption"}, "on the export of a recording without --params");
    if (options->recording.empty())
      cli::RefuseGiven(*command, {"--topic", "--sample-order", "--mirror", "--picture-geometry"},
                       "without --recording");
    return RunExport(*options);
  });
}

}  // namespace sonarcal::commands
