#include "apps/recordings_command.h"

#include <fmt/format.h>

#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "data_io/recordings/recording_catalogue.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

const char* ToString(RecordingPresence presence) {
  switch (presence) {
    case RecordingPresence::kAbsent:
      return "absent";
    case RecordingPresence::kPresent:
      return "present";
    case RecordingPresence::kDifferent:
      return "different";
  }
  return "";
}

std::string PresenceText(const PublicRecording& recording, RecordingPresence presence,
                         const std::filesystem::path& folder) {
  switch (presence) {
    case RecordingPresence::kPresent:
      return fmt::format(
          "here, {}{}", (folder / recording.name).string(),
          recording.witness.empty() ? " (not checked: no checksum is known)" : ", and the checksum is right");
    case RecordingPresence::kDifferent:
      return fmt::format("{} is there, but {} in it is not what was published",
                         (folder / recording.name).string(), recording.witness);
    case RecordingPresence::kAbsent:
      return recording.commit.empty()
                 ? "not here; to be fetched from its page by hand"
                 : fmt::format("not here; scripts/fetch_recording.sh {} brings it", recording.name);
  }
  return {};
}

Json ToJson(const PublicRecording& recording, RecordingPresence presence) {
  Json paths = Json::array();
  for (const PublicRecording::Path& path : recording.paths)
    paths.push_back({{"from", path.from}, {"to", path.to}});
  return {{"name", recording.name},
          {"sensor", recording.sensor},
          {"shows", recording.shows},
          {"licence", recording.licence},
          {"source", recording.source},
          {"commit", recording.commit},
          {"paths", paths},
          {"witness", recording.witness},
          {"witness_sha256", recording.witness_sha256},
          {"presence", ToString(presence)}};
}

}  // namespace

ExitStatus RunRecordings(const RecordingsOptions& options) {
  const std::filesystem::path folder = options.folder.empty() ? DefaultRecordingsFolder() : options.folder;
  Json recordings = Json::array();
  std::string text;
  for (const PublicRecording& recording : RecordingCatalogue()) {
    const RecordingPresence presence = PresenceOf(recording, folder);
    recordings.push_back(ToJson(recording, presence));
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", recording.name);
    const auto add = [&](const char* label, const std::string& value) {
      text += fmt::format("  {:<9} {}\n", label, value);
    };
    add("sensor", recording.sensor);
    add("shows", recording.shows);
    add("licence", recording.licence);
    add("source",
        recording.source + (recording.commit.empty() ? "" : " at " + recording.commit.substr(0, 12)));
    add("status", PresenceText(recording, presence, folder));
  }
  if (options.common.json) {
    PrintJson({{"folder", folder.string()}, {"recordings", recordings}});
  } else {
    PrintResult(text);
  }
  return ExitStatus::kDone;
}

void SetupRecordings(CLI::App& app) {
  auto options = std::make_shared<RecordingsOptions>();
  CLI::App* command = AddCommand(
      app, "recordings", "Lists public recordings of real sonars, their licences, and which are here");
  command->add_option("--dir", options->folder,
                      "Folder where they are looked for; default: $SONARCAL_RECORDINGS, else recordings/");
  OnRun(command, options->common, [options] { return RunRecordings(*options); });
}

}  // namespace sonarcal
