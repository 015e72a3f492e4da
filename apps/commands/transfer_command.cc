// `sonarcal transfer`: trains a detector on simulated frames, tests it on recorded ones, and compares it with
// one that was trained on recorded frames (apps/workflow/task/recording_transfer.h). Prints the figures, and
// with --out writes transfer.json and a report.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/report/detection/transfer_section.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/report_end.h"
#include "apps/workflow/task/recording_transfer.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;
using Paths = std::vector<std::filesystem::path>;

struct TransferCommandOptions {
  cli::CommonOptions common;
  Paths training;
  Paths training_masks;  // empty: by scene and object
  Paths test;
  Paths test_masks;
  std::filesystem::path out;  // empty: only the figures are printed
  workflow::TransferOptions transfer;
};

// Opened recordings, which the pointers of workflow::TransferRecordings need.
class OpenedRecordings {
 public:
  std::vector<const RecordingSource*> Open(const Paths& paths) {
    std::vector<const RecordingSource*> recordings;
    for (const std::filesystem::path& path : paths)
      recordings.push_back(opened_.emplace_back(data_io::OpenRecording(path)).get());
    return recordings;
  }

 private:
  std::vector<std::unique_ptr<RecordingSource>> opened_;
};

Json PathsJson(const Paths& paths) {
  Json json = Json::array();
  for (const std::filesystem::path& path : paths) json.push_back(path.string());
  return json;
}

cli::Provenance ProvenanceOf(const TransferCommandOptions& options) {
  cli::Provenance provenance{.command = "transfer",
                             .configuration = {{"train", PathsJson(options.training)},
                                               {"train_masks", PathsJson(options.training_masks)},
                                               {"test", PathsJson(options.test)},
                                               {"test_masks", PathsJson(options.test_masks)},
                                               {"out", options.out.string()}},
                             .inputs = options.training};
  provenance.configuration.update(cli::OptionsJson(options.transfer));
  for (const Paths* paths : {&options.training_masks, &options.test, &options.test_masks})
    provenance.inputs.insert(provenance.inputs.end(), paths->begin(), paths->end());
  return provenance;
}

report::HtmlReport MakeReport(const workflow::RecordingTransfer& result, const Json& provenance) {
  report::HtmlReport report("Simulated frames as training data",
                            fmt::format("{} training frames, {} test frames", result.transfer.training_frames,
                                        result.transfer.test_frames));
  report::AddTransfer(report, result);
  report::EndReport(report, provenance);
  return report;
}

cli::ExitStatus RunTransfer(const TransferCommandOptions& options) {
  OpenedRecordings opened;
  const workflow::TransferRecordings recordings{.training = opened.Open(options.training),
                                                .training_masks = opened.Open(options.training_masks),
                                                .test = opened.Open(options.test),
                                                .test_masks = opened.Open(options.test_masks)};
  std::optional<cli::RunOutput> output;
  if (!options.out.empty()) output.emplace(options.out, "transfer", options.common.force);
  std::optional<cli::Progress> progress;
  const workflow::RecordingTransfer result =
      workflow::Transfer(recordings, options.transfer,
                         {.progress =
                              [&](const std::string& step, int done, int total) {
                                if (!progress) progress.emplace(step, total, options.common, "detectors");
                                progress->Update(done);
                              },
                          .message = {},
                          .stop = {}});
  progress.reset();
  const Json json = report::TransferJson(result);
  if (output) {
    const cli::Provenance provenance = ProvenanceOf(options);
    data_io::WriteJson(*output / "transfer.json", json);
    cli::WriteProvenance(output->staging(), provenance);
    report::WriteReport(MakeReport(result, cli::ProvenanceToJson(provenance)), output->staging());
    output->Commit();
  }
  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    cli::PrintResult(report::TransferText(result));
    if (output) cli::PrintResult(fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return cli::ExitStatus::kDone;
}

void AddRecordings(CLI::App& command, const char* name, Paths& paths, const char* help, bool required) {
  command.add_option(name, paths, help)->type_name("REC")->delimiter(',')->required(required);
}

}  // namespace

void SetupTransfer(CLI::App& app) {
  auto options = std::make_shared<TransferCommandOptions>();
  CLI::App* command = cli::AddCommand(
      app, "transfer", "Measures how well simulated frames train a detector for recorded ones");
  AddRecordings(*command, "--train", options->training, "Recordings to train on, such as simulated ones",
                true);
  AddRecordings(*command, "--train-masks", options->training_masks,
                "Recordings of their masks: bright where the object is; required without --object", false);
  cli::AddOptions(*command, options->transfer);
  AddRecordings(*command, "--test", options->test,
                "Recordings to test on; a reference is trained on them too", true);
  AddRecordings(*command, "--test-masks", options->test_masks,
                "Recordings of their masks, with the same frames and shapes", true);
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for transfer.json and report.html (default: none is written)");
  cli::OnRun(command, options->common, [options] { return RunTransfer(*options); });
}

}  // namespace sonarcal::commands
