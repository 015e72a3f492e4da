#include "apps/export_command.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "apps/commands.h"
#include "apps/export/simulator_configs.h"
#include "apps/frame_range.h"
#include "apps/given_options.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/ray_options.h"
#include "apps/run_output.h"
#include "apps/simulate_recording.h"
#include "apps/sonar_option.h"
#include "core/types/error.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/fan_pictures.h"
#include "data_io/recordings/npz_writer.h"
#include "data_io/ros/ros1_bag_writer.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr JsonWords<ExportTarget, 9> kTargets = {{{"dave", ExportTarget::kDave},
                                                  {"holoocean", ExportTarget::kHoloOcean},
                                                  {"stonefish", ExportTarget::kStonefish},
                                                  {"oceansim", ExportTarget::kOceanSim},
                                                  {"gazebo", ExportTarget::kGazebo},
                                                  {"rosbag1", ExportTarget::kRos1Bag},
                                                  {"npz", ExportTarget::kNpz},
                                                  {"png", ExportTarget::kPng},
                                                  {"mp4", ExportTarget::kMp4}}};

struct SimulatorExport {
  ExportTarget target;
  ExportedConfig (*write)(const ExportSource& source, const std::string& name);
};
constexpr std::array<SimulatorExport, 5> kSimulators = {{{ExportTarget::kDave, ExportToDave},
                                                         {ExportTarget::kHoloOcean, ExportToHoloOcean},
                                                         {ExportTarget::kStonefish, ExportToStonefish},
                                                         {ExportTarget::kOceanSim, ExportToOceanSim},
                                                         {ExportTarget::kGazebo, ExportToGazebo}}};

const SimulatorExport* SimulatorOf(ExportTarget target) {
  for (const SimulatorExport& simulator : kSimulators) {
    if (simulator.target == target) return &simulator;
  }
  return nullptr;
}

std::string Word(ExportTarget target) {
  return std::string(JsonWord(kTargets, target));
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
    refuse(!options.params.empty(), "--params", "simulators");
    refuse(!options.sonar.empty(), "--sonar", "simulators");
  }
  const bool draws = options.to == ExportTarget::kPng || options.to == ExportTarget::kMp4;
  if (!draws) refuse(options.height_px != 0, "--height", "png and mp4");
  if (options.to != ExportTarget::kPng) refuse(options.common.force, "--force", "png");
  if (options.to != ExportTarget::kMp4) refuse(options.frames_per_s != 0.0, "--fps", "mp4");
  if (options.to == ExportTarget::kMp4 && options.out.extension() != ".mp4") {
    throw UsageError(
        "--out is '{}', expected a name that ends in .mp4, as the video's container is told by it",
        options.out.string());
  }
  if (!options.out.has_filename()) {
    throw UsageError("--out is '{}', expected the name of a file", options.out.string());
  }
}

Json Configuration(const ExportOptions& options) {
  return {{"to", Word(options.to)},
          {"out", options.out.string()},
          {"params", options.params.string()},
          {"sonar", options.sonar},
          {"absorption", ToString(options.absorption)},
          {"recording", options.recording.string()},
          {"topic", options.bag.bag.topic},
          {"frames", options.frames},
          {"height_px", options.height_px},
          {"frames_per_s", options.frames_per_s}};
}

// The folder that --out lies in, and the name of its file with another extension or none.
fs::path FolderOf(const fs::path& out) {
  return out.has_parent_path() ? out.parent_path() : fs::path(".");
}

// A folder of pictures, or the file beside whatever else lies in its folder.
RunOutput OutputOf(const ExportOptions& options) {
  return options.to == ExportTarget::kPng ? RunOutput(options.out, "export", options.common.force)
                                          : RunOutput::Beside(FolderOf(options.out));
}

struct ChosenSource {
  ExportSource source;
  std::vector<fs::path> inputs;
};

ChosenSource SourceOf(const ExportOptions& options) {
  ChosenSource chosen{.source = {}, .inputs = {options.params}};
  chosen.source.parameters = ReadParameters(options.params);
  std::optional<Water> water;
  if (!options.recording.empty()) {
    const auto recording = OpenWithBagOptions(options.recording, options.bag);
    chosen.source.sonar = recording->info().sonar;
    water = recording->info().water;
    chosen.inputs.push_back(options.recording);
  } else {
    SonarChoice sonar = ChooseSonar(options.sonar);
    chosen.source.sonar = std::move(sonar.sonar);
    water = sonar.water;
    if (sonar.input) chosen.inputs.push_back(*sonar.input);
  }
  const SonarModel& sonar = chosen.source.sonar;
  const std::string& name = options.recording.empty() ? options.sonar : options.recording.string();
  if (!(sonar.frequency_hz > 0.0)) throw DataError("{}: the sonar's frequency_hz is unknown", name);
  if (!(sonar.sound_speed_m_per_s > 0.0))
    throw DataError("{}: the sonar's sound_speed_m_per_s is unknown", name);
  const WaterChoice choice = ChooseWater(chosen.source.parameters, water);
  if (!choice.note.empty()) PrintNote(options.common, choice.note);
  chosen.source.water = choice.water;
  chosen.source.absorption_db_per_m = AbsorptionDbPerM(options.absorption, sonar.frequency_hz, choice.water);
  return chosen;
}

ExitStatus ExportConfiguration(const ExportOptions& options, const SimulatorExport& simulator) {
  const ChosenSource chosen = SourceOf(options);
  const std::string stem = options.out.stem().string();
  const ExportedConfig config = simulator.write(chosen.source, stem);
  const Json account = config.account.ToJson();
  Json side = {{"format", "sonarcal-export/1"}, {"to", Word(options.to)}, {"written_for", config.schema}};
  side.update(account);
  side["provenance"] = ProvenanceToJson(
      {.command = "export", .configuration = Configuration(options), .inputs = chosen.inputs});

  RunOutput output = RunOutput::Beside(FolderOf(options.out));
  std::vector<std::string> files;
  for (const ExportedFile& file : config.files) {
    files.push_back(file.suffix.empty() ? options.out.filename().string() : stem + file.suffix);
    WriteFileWhole(output / files.back(), file.text);
  }
  files.push_back(options.out.filename().string() + ".account.json");
  WriteJson(output / files.back(), side);
  output.Commit();

  for (const std::string& sentence : config.account.Sentences()) PrintNote(options.common, sentence);
  if (options.common.json) {
    side.erase("provenance");
    side["files"] = files;
    PrintJson(side);
  } else {
    PrintResult(
        fmt::format("{}: of {} parameters {} exported, {} approximated, {} not expressed, {} without "
                    "effect; {} says which\n",
                    options.out.string(), account.at("parameters").size(), account.at("exported").get<int>(),
                    account.at("approximated").get<int>(), account.at("not_expressed").get<int>(),
                    account.at("unused").get<int>(), files.back()));
  }
  return ExitStatus::kDone;
}

// What a bag does not say of a recording.
void NoteWhatIsLost(const ExportOptions& options, const RecordingInfo& info) {
  if (options.to != ExportTarget::kRos1Bag) return;
  std::vector<std::string> lost;
  if (info.water) lost.emplace_back("the water");
  if (info.scale.db_min || info.scale.db_span) lost.emplace_back("the dB scale");
  if (info.scale.quantity == Quantity::kGrey && info.scale.full_scale != 255.0 &&
      info.scale.full_scale != 65535.0) {
    lost.push_back(fmt::format("that {:g} is full scale", info.scale.full_scale));
  }
  if (info.valid) lost.emplace_back("which samples hold no measurement");
  if (info.synthetic) lost.emplace_back("that the recording is synthetic");
  if (!lost.empty()) PrintNote(options.common, fmt::format("not in a bag: {}", fmt::join(lost, ", ")));
}

ExitStatus ExportRecording(const ExportOptions& options) {
  std::unique_ptr<RecordingSource> recording = OpenWithBagOptions(options.recording, options.bag);
  const FrameRange range = ParseFrameRange(options.frames, recording->frame_count());
  recording = std::make_unique<FrameRangeView>(std::move(recording), range);
  NoteWhatIsLost(options, recording->info());
  std::vector<fs::path> inputs = {options.recording};
  if (!options.bag.picture_geometry.empty()) inputs.push_back(options.bag.picture_geometry);
  const Provenance provenance{.command = "export", .configuration = Configuration(options), .inputs = inputs};

  const bool is_folder = options.to == ExportTarget::kPng;
  RunOutput output = OutputOf(options);
  const fs::path file = output / options.out.filename();
  Progress progress("Exporting", recording->frame_count(), options.common, "frames");
  const auto advance = [&](int frames_done) { progress.Update(frames_done); };
  if (options.to == ExportTarget::kRos1Bag) {
    WriteRos1Bag(*recording, file, advance);
  } else if (options.to == ExportTarget::kNpz) {
    WriteNpz(*recording, file, advance);
  } else {
    const FanPainter painter(recording->info(), {.height_px = options.height_px});
    if (is_folder) {
      WriteFanPngs(*recording, painter, output.staging(), advance);
    } else {
      constexpr double kWithoutTimes = 10.0;
      double frames_per_s =
          options.frames_per_s > 0.0 ? options.frames_per_s : RecordedFramesPerS(*recording);
      if (frames_per_s == 0.0) frames_per_s = kWithoutTimes;
      WriteFanVideo(*recording, painter, frames_per_s, file, advance);
      WriteFileWhole(output / (options.out.filename().string() + ".geometry.json"), painter.GeometryJson());
    }
  }
  if (is_folder) {
    WriteProvenance(output.staging(), provenance);
  } else {
    WriteJson(output / (options.out.filename().string() + ".provenance.json"), ProvenanceToJson(provenance));
  }
  output.Commit();

  const int count = recording->frame_count();
  if (options.common.json) {
    PrintJson({{"file", options.out.string()},
               {"to", Word(options.to)},
               {"frames", count},
               {"synthetic", recording->info().synthetic}});
  } else {
    PrintResult(fmt::format("{}: {} {}{}\n", options.out.string(), count, count == 1 ? "frame" : "frames",
                            recording->info().synthetic ? " (synthetic)" : ""));
  }
  return ExitStatus::kDone;
}

}  // namespace

ExitStatus RunExport(const ExportOptions& options) {
  CheckOptions(options);
  const SimulatorExport* simulator = SimulatorOf(options.to);
  return simulator == nullptr ? ExportRecording(options) : ExportConfiguration(options, *simulator);
}

void SetupExport(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      AddCommand(app, "export", "Writes parameters for another simulator, or a recording for other tools");
  internal::AddChoice(*command, "--to", kTargets,
                      "Simulator whose configuration is written, or format of a recording",
                      [options](ExportTarget to) { options->to = to; })
      ->required();
  AddOutFolder(*command, options->out, options->common,
               "File to write (a folder for png); beside it, what was exported and how, as JSON")
      ->type_name("FILE")
      ->required();
  command->add_option("--params", options->params, "Parameters to export to a simulator")->type_name("JSON");
  AddSonar(*command, options->sonar, " (for the configuration of a simulator)");
  AddAbsorption(*command, options->absorption);
  command
      ->add_option("--recording", options->recording,
                   "Recording to export, of any format; for simulators the one whose sonar it is")
      ->type_name("REC");
  AddBagOptions(*command, options->bag);
  command
      ->add_option("--frames", options->frames,
                   "Frames of the recording: from A, counted from 0, up to but without B; all if not given")
      ->type_name("A:B");
  command
      ->add_option("--height", options->height_px,
                   "Height of pictures, pixels (default: one a range bin, 800 at most)")
      ->type_name("PX")
      ->default_str("")
      ->check(CLI::Range(2, 10000).description(""));
  command
      ->add_option("--fps", options->frames_per_s,
                   "Frames a second of a video (default: as recorded, 10 where frames have no times)")
      ->type_name("HZ")
      ->default_str("")
      ->check(CLI::Range(0.01, 1000.0).description(""));
  OnRun(command, options->common, [command, options] {
    if (SimulatorOf(options->to) == nullptr)
      RefuseGiven(*command, {"--absorption"}, "on the export of a recording");
    if (options->recording.empty())
      RefuseGiven(*command, {"--topic", "--sample-order", "--mirror", "--picture-geometry"},
                  "without --recording");
    return RunExport(*options);
  });
}

}  // namespace sonarcal
