// `sonarcal transfer`: trains a detector on simulated frames, tests it on recorded ones, and compares it with
// one that was trained on recorded frames (metrics/task/transfer.h).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/task/labelled_frames.h"
#include "core/types/error.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/scenes/cad_io.h"
#include "metrics/task/transfer.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;
using Paths = std::vector<std::filesystem::path>;

struct TransferCommandOptions {
  cli::CommonOptions common;
  Paths training;
  Paths training_masks;  // empty: by scene and object
  std::string object;
  Paths test;
  Paths test_masks;
  std::filesystem::path out;  // empty: only the figures are printed
};

struct Labelled {
  std::vector<metrics::LabelledFrame> frames;
  std::vector<std::string> names;  // of the recordings
};

std::vector<metrics::LabelledFrame> ByScene(const RecordingSource& recording, const std::string& object) {
  const std::optional<std::string>& scene = recording.info().scene_path;
  if (!scene) {
    throw DataError("{}: names no scene, expected one for --object, or --train-masks",
                    recording.info().source);
  }
  return workflow::LabelledByScene(recording, data_io::ReadScene(*scene), object);
}

// `object` labels the frames of recordings without masks.
Labelled Read(const Paths& recordings, const Paths& masks, const std::string& object) {
  Labelled labelled;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const auto recording = data_io::OpenRecording(recordings[i]);
    labelled.names.push_back(workflow::RecordingName(recording->info()));
    std::vector<metrics::LabelledFrame> frames =
        masks.empty() ? ByScene(*recording, object)
                      : workflow::LabelledByMasks(*recording, *data_io::OpenRecording(masks[i]));
    std::ranges::move(frames, std::back_inserter(labelled.frames));
  }
  return labelled;
}

Json FigureJson(const metrics::TransferFigure& figure) {
  return {{"value", figure.value ? Json(*figure.value) : Json(nullptr)},
          {"ci", figure.ci ? Json::array({figure.ci->lo, figure.ci->hi}) : Json(nullptr)}};
}

Json FiguresJson(const metrics::DetectorFigures& figures) {
  return {{"average_precision", FigureJson(figures.average_precision)},
          {"iou", FigureJson(figures.iou)},
          {"precision", FigureJson(figures.precision)},
          {"recall", FigureJson(figures.recall)}};
}

Json TransferJson(const metrics::Transfer& transfer, const Labelled& training, const Labelled& test) {
  return {{"format", "sonar-transfer/1"},
          {"training", training.names},
          {"test", test.names},
          {"training_frames", transfer.training_frames},
          {"test_frames", transfer.test_frames},
          {"blocks", transfer.blocks},
          {"object_share", transfer.object_share},
          {"trained_on_training", FiguresJson(transfer.simulated)},
          {"trained_on_test_blocks", FiguresJson(transfer.reference)},
          {"difference", FiguresJson(transfer.difference)}};
}

std::string FigureText(const metrics::TransferFigure& figure) {
  if (!figure.value) return "none";
  if (!figure.ci) return fmt::format("{:.3f}", *figure.value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", *figure.value, figure.ci->lo, figure.ci->hi);
}

std::string TransferText(const metrics::Transfer& transfer, const Labelled& training, const Labelled& test) {
  std::string text =
      fmt::format("trained on {} ({} frames), tested on {} ({} frames)\n", fmt::join(training.names, ", "),
                  transfer.training_frames, fmt::join(test.names, ", "), transfer.test_frames);
  constexpr auto kRow = "  {:<20}{:<24}{:<24}{}\n";
  text += fmt::format(kRow, "", "trained on --train", "on other --test frames", "difference");
  const auto add = [&](const char* label, metrics::TransferFigure metrics::DetectorFigures::*figure) {
    text += fmt::format(kRow, label, FigureText(transfer.simulated.*figure),
                        FigureText(transfer.reference.*figure), FigureText(transfer.difference.*figure));
  };
  add("average precision", &metrics::DetectorFigures::average_precision);
  add("IoU", &metrics::DetectorFigures::iou);
  add("precision", &metrics::DetectorFigures::precision);
  add("recall", &metrics::DetectorFigures::recall);
  return text + fmt::format(
                    "  guessing has an average precision of {:.3f}; in brackets: 95 % interval over "
                    "test frames\n",
                    transfer.object_share);
}

Json PathsJson(const Paths& paths) {
  Json json = Json::array();
  for (const std::filesystem::path& path : paths) json.push_back(path.string());
  return json;
}

void CheckMasks(const char* option, const Paths& masks, const Paths& recordings) {
  if (masks.size() == recordings.size()) return;
  throw UsageError("{} names {} recordings, expected {}, one for each recording", option, masks.size(),
                   recordings.size());
}

cli::ExitStatus RunTransfer(const TransferCommandOptions& options) {
  if (options.training_masks.empty() == options.object.empty())
    throw UsageError("expected either --train-masks or --object");
  if (options.object.empty()) CheckMasks("--train-masks", options.training_masks, options.training);
  CheckMasks("--test-masks", options.test_masks, options.test);
  std::optional<cli::RunOutput> output;
  if (!options.out.empty()) output.emplace(options.out, "transfer", options.common.force);
  const Labelled training = Read(options.training, options.training_masks, options.object);
  const Labelled test = Read(options.test, options.test_masks, {});
  std::optional<cli::Progress> progress;
  const metrics::Transfer transfer =
      metrics::MeasureTransfer(training.frames, test.frames, [&](int done, int total) {
        if (!progress) progress.emplace("Training", total, options.common, "detectors");
        progress->Update(done);
      });
  progress.reset();
  const Json json = TransferJson(transfer, training, test);
  if (output) {
    cli::Provenance provenance{.command = "transfer",
                               .configuration = {{"train", PathsJson(options.training)},
                                                 {"train_masks", PathsJson(options.training_masks)},
                                                 {"object", options.object},
                                                 {"test", PathsJson(options.test)},
                                                 {"test_masks", PathsJson(options.test_masks)}},
                               .inputs = options.training};
    for (const Paths* paths : {&options.training_masks, &options.test, &options.test_masks})
      provenance.inputs.insert(provenance.inputs.end(), paths->begin(), paths->end());
    data_io::WriteJson(*output / "transfer.json", json);
    cli::WriteProvenance(output->staging(), provenance);
    output->Commit();
  }
  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    cli::PrintResult(TransferText(transfer, training, test));
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
  command
      ->add_option("--object", options->object,
                   "Material of the object, which the scene of each training recording labels")
      ->type_name("MATERIAL");
  AddRecordings(*command, "--test", options->test,
                "Recordings to test on; a reference is trained on them too", true);
  AddRecordings(*command, "--test-masks", options->test_masks,
                "Recordings of their masks, with the same frames and shapes", true);
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for transfer.json (default: none is written)");
  cli::OnRun(command, options->common, [options] { return RunTransfer(*options); });
}

}  // namespace sonarcal::commands
