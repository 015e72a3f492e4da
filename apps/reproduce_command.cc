#include "apps/reproduce_command.h"

#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/ray_options.h"
#include "apps/report/paper_files.h"
#include "apps/reproduce/reproduce_report.h"
#include "apps/reproduce/summary_rows.h"
#include "apps/run_output.h"
#include "apps/seed_option.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/picture.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kBombFolder = "aris3000_uxo";
constexpr const char* kShown[][2] = {
    {"ARIS 1200 with telephoto lens, a river", "aris1200_telephoto/sample.aris"},
    {"DIDSON, a ship's hull", "didson_hull/test"},
    {"DIDSON, target-free background", "didson_hull/background"},
    {"Oculus, one ping", "oculus_m1200d/one_ping_8bit.raw"}};

std::filesystem::path RecordingsFolder(const ReproduceOptions& options) {
  if (!options.recordings.empty()) {
    if (!std::filesystem::is_directory(options.recordings)) {
      throw UsageError("--recordings {}: no such folder", options.recordings.string());
    }
    return options.recordings;
  }
  const char* variable = std::getenv("SONARCAL_RECORDINGS");
  return variable != nullptr && *variable != '\0' ? std::filesystem::path(variable) : "recordings";
}

ShownRecording Show(const std::string& name, const std::filesystem::path& path) {
  ShownRecording shown{.name = name, .failure = {}, .info = {}, .polar_png = {}, .fan_png = {}};
  try {
    const auto recording = OpenRecording(path);
    const PolarImage image = recording->ReadFrame(0).image;
    shown.info = recording->info();
    shown.frame_count = recording->frame_count();
    shown.polar_png = EncodePng(StretchPolar(Colorize(image)));
    shown.fan_png = EncodePng(Colorize(FanMap(image.axes).Apply(image)));
  } catch (const DataError& error) {
    shown.failure = error.what();
  }
  return shown;
}

std::string SummaryText(const Reproduction& reproduction, const std::filesystem::path& out) {
  const auto figure = [](const Statistic& s, int digits) {
    return s.value ? fmt::format("{:.{}f}", *s.value, digits) : std::string("none");
  };
  constexpr std::size_t kWidth = 48;
  std::string text =
      fmt::format("{:<{}}  {:>5}  {:>5}  {:>5}  {:>5}  {:>6}  {:>7}\n", "held-out frames, polar, means",
                  kWidth, "Ns/Nr", "Na/Ns", "Na/Nr", "IoU", "union", "overlap");
  const auto add = [&](const std::string& what, const std::vector<SummaryRow>& rows,
                       const std::vector<std::pair<const char*, const RecordingFit*>>& fits) {
    text += what + "\n";
    for (const auto& [model, fit] : fits) {
      for (const std::string& sentence : fit->fit.report.warnings)
        text += fmt::format("  warning: {}, {}\n", model, sentence);
    }
    for (const SummaryRow& row : rows) {
      const ViewSummary& view = row.metrics->aggregate.macro.polar;
      text += fmt::format("  {:<{}}  {:>5}  {:>5}  {:>5}  {:>5}  {:>6}  {:>7}\n", row.name, kWidth - 2,
                          figure(view.At("ns_over_nr"), 2), figure(view.At("na_over_ns"), 2),
                          figure(view.At("na_over_nr"), 2), figure(view.At("iou"), 2),
                          figure(view.Over(IntensityDomain::kUnion).mean_absolute, 3),
                          figure(view.Over(IntensityDomain::kOverlap).mean_absolute, 3));
    }
  };
  add("paper's tank (SYNTHETIC recording)", TankRows(reproduction.tank),
      {{"paper model", &reproduction.tank.fit}, {"acoustic model", &reproduction.tank.acoustic}});
  if (reproduction.bomb) {
    add("bomb, ARIS 3000 (recorded), outline and pose found beforehand", BombRows(*reproduction.bomb),
        {{"paper model", &reproduction.bomb->fitted.paper}});
    add("bomb, plain outline, pose found by the search", SearchedBombRows(*reproduction.bomb),
        {{"paper model", &reproduction.bomb->fit}});
  }
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

// With its scene, so that the folder can be fitted and compared by itself, and with its true parameters.
void WriteSyntheticRecording(const TankComparison& tank, const std::filesystem::path& folder) {
  RecordingInfo info = tank.recording->info();
  info.scene_path = (folder / "scene.gltf").string();
  std::vector<Frame> frames;
  for (int i = 0; i < tank.recording->frame_count(); ++i) frames.push_back(tank.recording->ReadFrame(i));
  WriteRecording(MemoryRecording(info, std::move(frames)), folder);
  WriteGltf(tank.scene, folder / "scene.gltf");
  WriteParameters(folder / "params.json", tank.truth);
}

void WriteAll(const std::filesystem::path& folder, const std::vector<FramePictures>& frames) {
  if (frames.empty()) return;
  std::filesystem::create_directories(folder);
  for (const FramePictures& pictures : frames) WritePictures(folder, pictures);
}

void WriteFit(const RunOutput& output, const std::string& prefix, const RecordingFit& fit,
              const MetricsReport* sample = nullptr) {
  std::string extra;
  if (fit.fit.usable) {
    extra = fmt::format(R"("metrics_before": {}, "metrics_after": {})", MetricsJson(fit.before),
                        MetricsJson(fit.after));
    if (sample != nullptr) extra += fmt::format(R"(, "sample_metrics_after": {})", MetricsJson(*sample));
    WriteParameters(output / (prefix + "_params.json"), fit.fit.parameters);
  }
  WriteFileWhole(output / (prefix + "_fit.json"), FitReportJson(fit.fit.report, extra));
  WriteAll(output / (prefix + "_pictures"), fit.pictures_after);
}

// Judged apart from its fit.
void WriteBombAcoustic(const RunOutput& output, const BombComparison::Fitted& bomb) {
  std::string extra;
  if (bomb.acoustic.fit.usable) {
    extra = fmt::format(R"("metrics_after": {}, "sample_metrics_after": {})", MetricsJson(bomb.expected),
                        MetricsJson(bomb.samples));
    WriteParameters(output / "bomb_acoustic_params.json", bomb.acoustic.fit.parameters);
  }
  WriteFileWhole(output / "bomb_acoustic_fit.json", FitReportJson(bomb.acoustic.fit.report, extra));
  WriteAll(output / "bomb_acoustic_pictures", bomb.expected_pictures);
  WriteAll(output / "bomb_acoustic_sample_pictures", bomb.sample_pictures);
}

}  // namespace

ExitStatus RunReproduce(const ReproduceOptions& options) {
  const ThreadLimit threads(options.threads);
  const std::filesystem::path recordings = RecordingsFolder(options);
  const auto note = [&](const std::string& line) { PrintNote(options.common, line); };
  RunOutput output(options.out, "reproduce", options.common.force);

  note("making the SYNTHETIC recording of the paper's tank, by the coherent model");
  Progress progress("Recording", 0, options.common);
  TankComparisonOptions tank{.size = options.text_sizes ? PaperSize::kText : PaperSize::kTable5,
                             .seed = options.seed,
                             .threads = options.threads,
                             .quick = options.quick,
                             .comparison = TankRules()};
  tank.on_frame = [&](int done, int) { progress.Update(done); };
  tank.on_note = [&](const std::string& line) { note("tank: " + line); };
  Reproduction reproduction{.tank = CompareTank(tank), .bomb = {}, .bomb_absent = {}, .shown = {}};
  WriteSyntheticRecording(reproduction.tank, output / "synthetic_recording");
  WriteParameters(output / "tank_initial_params.json", reproduction.tank.initial);
  WriteParameters(output / "tank_acoustic_initial_params.json", reproduction.tank.acoustic_initial);
  WriteFit(output, "tank", reproduction.tank.fit);
  WriteFit(output, "tank_acoustic", reproduction.tank.acoustic, &*reproduction.tank.acoustic.sample_after);

  const std::filesystem::path bomb_folder = recordings / kBombFolder;
  std::vector<std::filesystem::path> inputs;
  if (std::filesystem::is_directory(bomb_folder)) {
    BombComparisonOptions bomb{.threads = options.threads, .quick = options.quick, .comparison = {}};
    bomb.on_note = [&](const std::string& line) { note("bomb: " + line); };
    reproduction.bomb = CompareBomb(bomb_folder, bomb);
    WriteFit(output, "bomb", reproduction.bomb->fit);
    WriteFit(output, "bomb_outline", reproduction.bomb->fitted.paper);
    WriteBombAcoustic(output, reproduction.bomb->fitted);
    inputs.push_back(bomb_folder);
  } else {
    reproduction.bomb_absent = fmt::format(
        "The frames of a real sonar are judged too where they are present; there is no {} (set "
        "SONARCAL_RECORDINGS, or "
        "--recordings).",
        bomb_folder.string());
    note(reproduction.bomb_absent);
  }
  for (const auto& [name, path] : kShown) {
    if (!std::filesystem::exists(recordings / path)) continue;
    reproduction.shown.push_back(Show(name, recordings / path));
    inputs.push_back(recordings / path);
  }

  Json configuration = {{"recordings", recordings.string()},
                        {"sizes", options.text_sizes ? "text" : "table 5"},
                        {"threads", options.threads},
                        {"quick", options.quick},
                        {"out", options.out.string()}};
  const Provenance provenance{
      .command = "reproduce", .configuration = configuration, .seed = options.seed, .inputs = inputs};
  const std::string metrics = ReproductionMetricsJson(reproduction);
  WriteFileWhole(output / "metrics.json", metrics);
  WriteReport(MakeReproductionReport(reproduction, ProvenanceToJson(provenance)), output.staging());
  WriteProvenance(output.staging(), provenance);
  output.Commit();

  if (options.common.json) {
    PrintJson(Json::parse(metrics));
  } else {
    PrintResult(SummaryText(reproduction, options.out));
  }
  return ExitStatus::kDone;
}

void SetupReproduce(CLI::App& app) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = AddCommand(app, "reproduce", "The paper's tank comparison, start to end");
  AddOutFolder(*command, options->out, options->common, "Folder for report, metrics and pictures")
      ->required();
  command
      ->add_option("--recordings", options->recordings,
                   "Folder of real recordings [$SONARCAL_RECORDINGS, else ./recordings]")
      ->type_name("DIR");
  command->add_flag("--text-sizes", options->text_sizes,
                    "Tank and mock-ups of the sizes in the paper's text, not of its Table 5");
  AddSeed(*command, options->seed, "Of the synthetic recording's speckle and noise");
  command->add_option("--threads", options->threads, "0 for all cores")->type_name("N");
  command->add_flag("--quick", options->quick, "Few rays and starts: to try the way, not for figures");
  OnRun(command, options->common, [options] { return RunReproduce(*options); });
}

}  // namespace sonarcal
