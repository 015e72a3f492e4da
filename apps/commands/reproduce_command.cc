// `sonarcal reproduce`: runs the case studies of the cases folder (apps/reproduce/case_plan.h): the paper's
// tank comparison, start to end, and the same on a real sonar's frames if the recordings are present.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/pictures/comparison_pictures.h"
#include "apps/report/pictures/shown_frames.h"
#include "apps/reproduce/reproduce_report.h"
#include "apps/reproduce/summary_rows.h"
#include "apps/workflow/rays/ray_options.h"
#include "data_io/files/atomic_output.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_catalogue.h"
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

// The cases that are run: one that is synthetic, and all targets.
struct Cases {
  reproduce::CasePlan synthetic;
  std::vector<reproduce::CasePlan> targets;
};

Cases ReadCases() {
  const std::filesystem::path folder = reproduce::CasesFolder();
  std::optional<reproduce::CasePlan> synthetic;
  Cases cases;
  for (const std::string& name : reproduce::CaseNames(folder)) {
    reproduce::CasePlan plan = reproduce::ReadCase(folder / name);
    if (std::holds_alternative<reproduce::TargetCase>(plan.study))
      cases.targets.push_back(std::move(plan));
    else if (std::holds_alternative<reproduce::SyntheticCase>(plan.study) && !synthetic)
      synthetic = std::move(plan);
  }
  if (!synthetic) throw DataError("{}: no synthetic case, expected one", folder.string());
  cases.synthetic = std::move(*synthetic);
  return cases;
}

std::filesystem::path RecordingsFolder(const ReproduceOptions& options) {
  if (!options.recordings.empty()) {
    if (!std::filesystem::is_directory(options.recordings)) {
      throw UsageError("--recordings {}: no such folder", options.recordings.string());
    }
    return options.recordings;
  }
  return data_io::DefaultRecordingsFolder();
}

reproduce::ShownRecording Show(const std::string& name, const std::filesystem::path& path) {
  reproduce::ShownRecording shown{.name = name, .failure = {}, .info = {}, .first = {}};
  try {
    const auto recording = data_io::OpenRecording(path);
    shown.first = recording->ReadFrame(0).image;
    shown.info = recording->info();
    shown.frame_count = recording->frame_count();
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
  const reproduce::SyntheticComparison& synthetic = reproduction.synthetic;
  add(synthetic.plan.title, reproduce::SyntheticRows(synthetic),
      {{"paper model", &synthetic.fit}, {"acoustic model", &synthetic.acoustic}});
  for (const reproduce::TargetResult& result : reproduction.targets) {
    if (!result.comparison) continue;
    const reproduce::TargetComparison& target = *result.comparison;
    add(target.plan.title, reproduce::TargetRows(target),
        {{"paper model", &target.paper}, {"acoustic model", &target.fitted.acoustic}});
    for (const std::string& sentence : reproduce::KnownSentences(target.plan))
      text += fmt::format("  known beforehand: {}\n", sentence);
  }
  return text + fmt::format("report: {}\n", (out / "report.html").string());
}

// With its scene, so that the folder can be fitted and compared by itself, and with its true parameters.
void WriteSyntheticRecording(const reproduce::SyntheticComparison& synthetic,
                             const std::filesystem::path& folder) {
  RecordingInfo info = synthetic.recording->info();
  info.scene_path = (folder / "scene.gltf").string();
  std::vector<Frame> frames;
  for (int i = 0; i < synthetic.recording->frame_count(); ++i)
    frames.push_back(synthetic.recording->ReadFrame(i));
  data_io::WriteRecording(MemoryRecording(info, std::move(frames)), folder);
  data_io::WriteGltf(synthetic.scene, folder / "scene.gltf");
  data_io::WriteParameters(folder / "params.json", synthetic.truth);
}

void WriteAll(const std::filesystem::path& folder, const std::vector<workflow::ComparedFrame>& frames) {
  if (frames.empty()) return;
  std::filesystem::create_directories(folder);
  for (const workflow::ComparedFrame& frame : frames)
    report::WritePictures(folder, frame.real, frame.simulated, frame.metrics);
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
  WriteAll(output / (prefix + "_pictures"), report::ShowFit(fit).examples);
}

// The acoustic model's fit and its evaluation, which FitRecording did not make.
void WriteTargetAcoustic(const cli::RunOutput& output, const std::string& prefix,
                         const reproduce::TargetComparison::Fitted& target) {
  std::string extra;
  if (target.acoustic.fit.usable) {
    extra = fmt::format(R"("metrics_after": {}, "sample_metrics_after": {})",
                        metrics::MetricsJson(target.expected), metrics::MetricsJson(target.samples));
    data_io::WriteParameters(output / (prefix + "_params.json"), target.acoustic.fit.parameters);
  }
  data_io::WriteFileWhole(output / (prefix + "_fit.json"),
                          calib::FitReportJson(target.acoustic.fit.report, extra));
  WriteAll(output / (prefix + "_pictures"), target.expected_frames);
  WriteAll(output / (prefix + "_sample_pictures"), target.sample_frames);
}

reproduce::SyntheticComparison RunSynthetic(const reproduce::CasePlan& plan, const ReproduceOptions& options,
                                            const cli::RunOutput& output) {
  cli::PrintNote(options.common, "making the SYNTHETIC recording, by the coherent model: " + plan.title);
  cli::Progress progress("Recording", 0, options.common);
  reproduce::SyntheticOptions synthetic{.text_sizes = options.text_sizes,
                                        .seed = options.seed,
                                        .threads = options.threads,
                                        .quick = options.quick};
  synthetic.on_frame = [&](int done, int) { progress.Update(done); };
  synthetic.on_note = [&](const std::string& line) {
    cli::PrintNote(options.common, plan.name + ": " + line);
  };
  reproduce::SyntheticComparison result = reproduce::CompareSynthetic(plan, synthetic);
  WriteSyntheticRecording(result, output / "synthetic_recording");
  data_io::WriteParameters(output / (plan.name + "_initial_params.json"), result.initial);
  data_io::WriteParameters(output / (plan.name + "_acoustic_initial_params.json"), result.acoustic_initial);
  WriteFit(output, plan.name, result.fit);
  WriteFit(output, plan.name + "_acoustic", result.acoustic, &*result.acoustic.sample_after);
  return result;
}

// Absent without the recording.
reproduce::TargetResult RunTarget(const reproduce::CasePlan& plan, const std::filesystem::path& recordings,
                                  const ReproduceOptions& options, const cli::RunOutput& output) {
  const std::filesystem::path images = recordings / reproduce::TargetOf(plan).recording;
  reproduce::TargetResult result{.name = plan.name, .comparison = {}, .absent = {}};
  if (!std::filesystem::is_directory(images)) {
    result.absent = fmt::format(
        "The frames of a real sonar are evaluated too if they are present; there is no {} (set "
        "SONARCAL_RECORDINGS, or --recordings).",
        images.string());
    cli::PrintNote(options.common, result.absent);
    return result;
  }
  const reproduce::TargetComparisonOptions target{
      .threads = options.threads, .quick = options.quick, .on_note = [&](const std::string& line) {
        cli::PrintNote(options.common, plan.name + ": " + line);
      }};
  result.comparison = reproduce::CompareTarget(plan, images, target);
  WriteFit(output, plan.name, result.comparison->paper);
  WriteTargetAcoustic(output, plan.name + "_acoustic", result.comparison->fitted);
  return result;
}

}  // namespace

cli::ExitStatus RunReproduce(const ReproduceOptions& options) {
  const workflow::ThreadLimit threads(options.threads);
  const std::filesystem::path recordings = RecordingsFolder(options);
  const Cases cases = ReadCases();
  cli::RunOutput output(options.out, "reproduce", options.common.force);
  reproduce::Reproduction reproduction{
      .synthetic = RunSynthetic(cases.synthetic, options, output), .targets = {}, .shown = {}};
  std::vector<std::filesystem::path> inputs = {cases.synthetic.folder};
  for (const reproduce::CasePlan& plan : cases.targets) {
    reproduction.targets.push_back(RunTarget(plan, recordings, options, output));
    if (!reproduction.targets.back().comparison) continue;
    inputs.push_back(plan.folder);
    inputs.push_back(recordings / reproduce::TargetOf(plan).recording);
  }
  for (const auto& [title, path] : reproduce::SyntheticOf(cases.synthetic).also_shown) {
    if (!std::filesystem::exists(recordings / path)) continue;
    reproduction.shown.push_back(Show(title, recordings / path));
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
  command->add_flag("--quick", options->quick,
                    "Few rays and starts, no search for other curves: to try the way, not for figures");
  cli::OnRun(command, options->common, [options] { return RunReproduce(*options); });
}

}  // namespace sonarcal::commands
