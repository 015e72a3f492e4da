// `sonarcal recordings`: lists public recordings of real sonars with their licences, and which are present.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/commands/commands.h"
#include "data_io/recordings/recording_catalogue.h"

namespace sonarcal::commands {
namespace {

struct RecordingsOptions {
  cli::CommonOptions common;
  std::filesystem::path folder;  // empty: DefaultRecordingsFolder()
};

using Json = nlohmann::ordered_json;

const char* ToString(data_io::RecordingPresence presence) {
  switch (presence) {
    case data_io::RecordingPresence::kAbsent:
      return "absent";
    case data_io::RecordingPresence::kPresent:
      return "present";
    case data_io::RecordingPresence::kDifferent:
      return "different";
  }
  return "";
}

std::string PresenceText(const data_io::PublicRecording& recording, data_io::RecordingPresence presence,
                         const std::filesystem::path& folder) {
  switch (presence) {
    case data_io::RecordingPresence::kPresent:
      return fmt::format(
          "here, {}{}", (folder / recording.name).string(),
          recording.witness.empty() ? " (not checked: no checksum is known)" : ", and the checksum is right");
    case data_io::RecordingPresence::kDifferent:
      return fmt::format("{} exists, but {} in it differs from the published file",
                         (folder / recording.name).string(), recording.witness);
    case data_io::RecordingPresence::kAbsent:
      return fmt::format("not in {}; {}", folder.string(),
                         recording.commit.empty()
                             ? "address only: download it by hand"
                             : "get it with scripts/fetch_recording.sh " + recording.name);
  }
  return {};
}

Json ToJson(const data_io::PublicRecording& recording, data_io::RecordingPresence presence) {
  Json paths = Json::array();
  for (const data_io::PublicRecording::Path& path : recording.paths)
    paths.push_back({{"from", path.from}, {"to", path.to}});
  return {{"name", recording.name},
          {"sensor", recording.sensor},
          {"shows", recording.shows},
          {"truth", recording.truth},
          {"licence", recording.licence},
          {"source", recording.source},
          {"data", recording.data},
          {"commit", recording.commit},
          {"paths", paths},
          {"witness", recording.witness},
          {"witness_sha256", recording.witness_sha256},
          {"presence", ToString(presence)}};
}

}  // namespace

cli::ExitStatus RunRecordings(const RecordingsOptions& options) {
  const std::filesystem::path folder =
      options.folder.empty() ? data_io::DefaultRecordingsFolder() : options.folder;
  Json recordings = Json::array();
  std::string text;
  for (const data_io::PublicRecording& recording : data_io::RecordingCatalogue()) {
    const data_io::RecordingPresence presence = data_io::PresenceOf(recording, folder);
    recordings.push_back(ToJson(recording, presence));
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", recording.name);
    const auto add = [&](const char* label, const std::string& value) {
      text += fmt::format("  {:<9} {}\n", label, value);
    };
    add("sensor", recording.sensor);
    add("shows", recording.shows);
    if (!recording.truth.empty()) add("truth", recording.truth);
    add("licence", recording.licence);
    add("source",
        recording.source + (recording.commit.empty() ? "" : " at " + recording.commit.substr(0, 12)));
    if (!recording.data.empty()) add("data", recording.data);
    add("status", PresenceText(recording, presence, folder));
  }
  if (options.common.json) {
    cli::PrintJson({{"folder", folder.string()}, {"recordings", recordings}});
  } else {
    cli::PrintResult(text);
  }
  return cli::ExitStatus::kDone;
}

void SetupRecordings(CLI::App& app) {
  auto options = std::make_shared<RecordingsOptions>();
  CLI::App* command =
      cli::AddCommand(app, "recordings", "Lists public recordings of real sonars, and which are here");
  command->add_option("--dir", options->folder,
                      "Folder of the recordings; default: $SONARCAL_RECORDINGS, else recordings/");
  cli::OnRun(command, options->common, [options] { return RunRecordings(*options); });
}

}  // namespace sonarcal::commands
