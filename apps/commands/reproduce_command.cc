// `sonarcal reproduce`: the paper's tank comparison, start to end, and the same on a real sonar's frames
// where the recordings are present.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/pictures/shown_frames.h"
#include "apps/reproduce/reproduce_report.h"
#include "apps/reproduce/summary_rows.h"
#include "apps/workflow/ray_options.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/picture.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::commands {
namespace {

struct ReproduceOptions {
  cli::CommonOptions common;
  std::filesystem::path out;
  std::filesystem::path recordings;  // empty: $SONARCAL_RECORDINGS, else ./recordings
  bool text_sizes = false;           // the sizes of the paper's text instead of its Table 5
  std::uint64_t seed = 1;
  int threads = 0;
  bool quick = false;
};

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

reproduce::ShownRecording Show(const std::string& name, const std::filesystem::path& path) {
  reproduce::ShownRecording shown{.name = name, .failure = {}, .info = {}, .polar_png = {}, .fan_png = {}};
  try {
    const auto recording = data_io::OpenRecording(path);
    const PolarImage image = recording->ReadFrame(0).image;
    shown.info = recording->info();
    shown.frame_count = recording->frame_count();
    shown.polar_png = data_io::EncodePng(data_io::StretchPolar(data_io::Colorize(image)));
    shown.fan_png = data_io::EncodePng(data_io::Colorize(FanMap(image.axes).Apply(image)));
  } catch (const DataError& error) {
    shown.failure = error.what();
  }
  return shown;
}

std::string SummaryText(const reproduce::Reproduction& reproduction, const std::filesystem::path& out) {
  const auto figure = [](const metrics::Statistic& s, int digits) {
    return s.value ? fmt::format("{:.{}f}", *s.value, digits) : std::string("none");
  };
  constexpr std::size_t kWidth = 48;
  std::string text =
      fmt::format("{:<{}}  {:>5}  {:>5}  {:>5}  {:>5}  {:>6}  {:>7}\n", "held-out frames, polar, means",
                  kWidth, "Ns/Nr", "Na/Ns", "Na/Nr", "IoU", "union", "overlap");
  const auto add = [&](const std::string& what, const std::vector<reproduce::SummaryRow>& rows,
                       const std::vector<std::pair<const char*, const workflow::RecordingFit*>>& fits) {
    text += what + "\n";
    for (const auto& [model, fit] : fits) {
      for (const std::string& sentence : fit->fit.report.warnings)
        text += fmt::format("  warning: {}, {}\n", model, sentence);
    }
    for (const reproduce::SummaryRow& row : rows) {
      const metrics::ViewSummary& view = row.metrics->aggregate.macro.polar;
      text += fmt::format("  {:<{}}  {:>5}  {:>5}  {:>5}  {:>5}  {:>6}  {:>7}\n", row.name, kWidth - 2,
                          figure(view.At("ns_over_nr"), 2), figure(view.At("na_over_ns"), 2),
                          figure(view.At("na_over_nr"), 2), figure(view.At("iou"), 2),
                          figure(view.Over(metrics::IntensityDomain::kUnion).mean_absolute, 3),
                          figure(view.Over(metrics::IntensityDomain::kOverlap).mean_absolute, 3));
    }
  };
  add("paper's tank (SYNTHETIC recording)", reproduce::TankRows(reproduction.tank),
      {{"paper model", &reproduction.tank.fit}, {"acoustic model", &reproduction.tank.acoustic}});
  if (reproduction.bomb) {
    add("bomb, ARIS 3000 (recorded), outline and pose found beforehand",
        reproduce::BombRows(*reproduction.bomb), {{"paper model", &reproduction.bomb->fitted.paper}});
    add("bomb, plain outline, pose found by the search", reproduce::SearchedBombRows(*reproduction.bomb),
        {{"paper model", &reproduction.bomb->fit}});
  }
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

// With its scene, so that the folder can be fitted and compared by itself, and with its true parameters.
void WriteSyntheticRecording(const reproduce::TankComparison& tank, const std::filesystem::path& folder) {
  RecordingInfo info = tank.recording->info();
  info.scene_path = (folder / "scene.gltf").string();
  std::vector<Frame> frames;
  for (int i = 0; i < tank.recording->frame_count(); ++i) frames.push_back(tank.recording->ReadFrame(i));
  data_io::WriteRecording(MemoryRecording(info, std::move(frames)), folder);
  data_io::WriteGltf(tank.scene, folder / "scene.gltf");
  data_io::WriteParameters(folder / "params.json", tank.truth);
}

void WriteAll(const std::filesystem::path& folder, const std::vector<report::FramePictures>& frames) {
  if (frames.empty()) return;
  std::filesystem::create_directories(folder);
  for (const report::FramePictures& pictures : frames) report::WritePictures(folder, pictures);
}

void WriteFit(const cli::RunOutput& output, const std::string& prefix, const workflow::RecordingFit& fit,
              const metrics::MetricsReport* sample = nullptr) {
  std::string extra;
  if (fit.fit.usable) {
    extra = fmt::format(R"("metrics_before": {}, "metrics_after": {})", metrics::MetricsJson(fit.before),
                        metrics::MetricsJson(fit.after));
    if (sample != nullptr)
      extra += fmt::format(R"(, "sample_metrics_after": {})", metrics::MetricsJson(*sample));
    data_io::WriteParameters(output / (prefix + "_params.json"), fit.fit.parameters);
  }
  data_io::WriteFileWhole(output / (prefix + "_fit.json"), calib::FitReportJson(fit.fit.report, extra));
  WriteAll(output / (prefix + "_pictures"), report::ShowFit(fit).after);
}

// Judged apart from its fit.
void WriteBombAcoustic(const cli::RunOutput& output, const reproduce::BombComparison::Fitted& bomb) {
  std::string extra;
  if (bomb.acoustic.fit.usable) {
    extra = fmt::format(R"("metrics_after": {}, "sample_metrics_after": {})",
                        metrics::MetricsJson(bomb.expected), metrics::MetricsJson(bomb.samples));
    data_io::WriteParameters(output / "bomb_acoustic_params.json", bomb.acoustic.fit.parameters);
  }
  data_io::WriteFileWhole(output / "bomb_acoustic_fit.json",
                          calib::FitReportJson(bomb.acoustic.fit.report, extra));
  WriteAll(output / "bomb_acoustic_pictures", bomb.expected_pictures);
  WriteAll(output / "bomb_acoustic_sample_pictures", bomb.sample_pictures);
}

}  // namespace

cli::ExitStatus RunReproduce(const ReproduceOptions& options) {
  const workflow::ThreadLimit threads(options.threads);
  const std::filesystem::path recordings = RecordingsFolder(options);
  const auto note = [&](const std::string& line) { cli::PrintNote(options.common, line); };
  cli::RunOutput output(options.out, "reproduce", options.common.force);

  note("making the SYNTHETIC recording of the paper's tank, by the coherent model");
  cli::Progress progress("Recording", 0, options.common);
  reproduce::TankComparisonOptions tank{
      .size = options.text_sizes ? sim::PaperSize::kText : sim::PaperSize::kTable5,
      .seed = options.seed,
      .threads = options.threads,
      .quick = options.quick,
      .comparison = reproduce::TankRules()};
  tank.on_frame = [&](int done, int) { progress.Update(done); };
  tank.on_note = [&](const std::string& line) { note("tank: " + line); };
  reproduce::Reproduction reproduction{
      .tank = reproduce::CompareTank(tank), .bomb = {}, .bomb_absent = {}, .shown = {}};
  WriteSyntheticRecording(reproduction.tank, output / "synthetic_recording");
  data_io::WriteParameters(output / "tank_initial_params.json", reproduction.tank.initial);
  data_io::WriteParameters(output / "tank_acoustic_initial_params.json", reproduction.tank.acoustic_initial);
  WriteFit(output, "tank", reproduction.tank.fit);
  WriteFit(output, "tank_acoustic", reproduction.tank.acoustic, &*reproduction.tank.acoustic.sample_after);

  const std::filesystem::path bomb_folder = recordings / kBombFolder;
  std::vector<std::filesystem::path> inputs;
  if (std::filesystem::is_directory(bomb_folder)) {
    reproduce::BombComparisonOptions bomb{
        .threads = options.threads, .quick = options.quick, .comparison = {}};
    bomb.on_note = [&](const std::string& line) { note("bomb: " + line); };
    reproduction.bomb = reproduce::CompareBomb(bomb_folder, bomb);
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
  const cli::Provenance provenance{
      .command = "reproduce", .configuration = configuration, .seed = options.seed, .inputs = inputs};
  const std::string metrics = reproduce::ReproductionMetricsJson(reproduction);
  data_io::WriteFileWhole(output / "metrics.json", metrics);
  report::WriteReport(reproduce::MakeReproductionReport(reproduction, cli::ProvenanceToJson(provenance)),
                      output.staging());
  cli::WriteProvenance(output.staging(), provenance);
  output.Commit();

  if (options.common.json) {
    cli::PrintJson(Json::parse(metrics));
  } else {
    cli::PrintResult(SummaryText(reproduction, options.out));
  }
  return cli::ExitStatus::kDone;
}

void SetupReproduce(CLI::App& app) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = cli::AddCommand(app, "reproduce", "The paper's tank comparison, start to end");
  cli::AddOutFolder(*command, options->out, options->common, "Folder for report, metrics and pictures")
      ->required();
  command
      ->add_option("--recordings", options->recordings,
                   "Folder of real recordings [$SONARCAL_RECORDINGS, else ./recordings]")
      ->type_name("DIR");
  command->add_flag("--text-sizes", options->text_sizes,
                    "Tank and mock-ups of the sizes in the paper's text, not of its Table 5");
  cli::AddOption(*command, {.name = "seed", .help = "Seed of the synthetic recording's speckle and noise"},
                 options->seed);
  command->add_option("--threads", options->threads, "0 for all cores")->type_name("N");
  command->add_flag("--quick", options->quick, "Few rays and starts: to try the way, not for figures");
  cli::OnRun(command, options->common, [options] { return RunReproduce(*options); });
}

}  // namespace sonarcal::commands
