// provenance.json: description of a run, written beside its outputs, so that a result can be explained and
// made again years later.
//
//   {"format": "sonarcal-provenance/1", "program": "sonarcal", "version": "0.1.0", "command": "convert",
//    "command_line": ["sonarcal", "convert", ...], "configuration": {...}, "seed": 1,
//    "inputs": [{"path": "tank", "files": 9, "bytes": 1234, "sha256": "..."}],
//    "outputs": ["frame_0000.png", "recording.json"]}
//
// `outputs` are the files that the run wrote into the folder, except this one. The next run of the same
// command into the folder removes those that it does not replace (apps/cli/run_output.h).
//
// A run that can be resumed also has "made_of": {...}, the data that determine its outputs.
//
// Time and host are not stored: the same run writes the same bytes. An input that is a folder has one hash,
// that of the lines "<sha256>  <path within>\n" of its files, sorted by path (as `sha256sum` prints them).
// Staged outputs and the output folder of the run do not count as its files.
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
  // Data that determine the outputs, for resuming (apps/commands/simulate_resume.h). Null: cannot be resumed.
  nlohmann::ordered_json made_of = {};
  // Files and folders that were read. Empty paths are left out.
  std::vector<std::filesystem::path> inputs = {};
};

// Throws DataError if an input cannot be read any more or if the file cannot be written.
void WriteProvenance(const std::filesystem::path& folder, const Provenance& provenance);

// Returns the object as JSON, for a report.
nlohmann::ordered_json ProvenanceToJson(const Provenance& provenance);

}  // namespace sonarcal::cli
