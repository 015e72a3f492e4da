// provenance.json: what a run was, written beside its outputs, so that a result found years later says how it
// came about and can be made again.
//
//   {"format": "sonarcal-provenance/1", "program": "sonarcal", "version": "0.1.0", "command": "convert",
//    "command_line": ["sonarcal", "convert", ...], "configuration": {...}, "seed": 1,
//    "inputs": [{"path": "tank", "files": 9, "bytes": 1234, "sha256": "..."}],
//    "outputs": ["frame_0000.png", "recording.json"]}
//
// `outputs` are the files of the folder that the run wrote, except this one: the next run of the same command
// into the folder removes those that it does not replace (apps/cli/run_output.h).
//
// A run that can be resumed also has "made_of": {...}, what decides its outputs.
//
// No time and no host: the same run writes the same bytes. An input that is a folder gets one hash, that of
// the lines "<sha256>  <path within>\n" of its files, sorted by path (as `sha256sum` prints them).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace sonarcal::cli {

struct Provenance {
  std::string command;                        // "fit"
  nlohmann::ordered_json configuration = {};  // every option as resolved: default < file < command line
  std::optional<std::uint64_t> seed = {};
  nlohmann::ordered_json made_of =
      {};  // by which a run is resumed (apps/commands/simulate_resume.h); null for none
  std::vector<std::filesystem::path> inputs = {};  // files and folders that were read
};

// Throws DataError where an input can't be read any more, or the file can't be written.
void WriteProvenance(const std::filesystem::path& folder, const Provenance& provenance);

// The same as JSON, for a report.
nlohmann::ordered_json ProvenanceToJson(const Provenance& provenance);

}  // namespace sonarcal::cli
