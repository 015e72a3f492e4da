// Public recordings of real imaging sonars, where they come from and under which licence: what
// `sonarcal recordings` lists and scripts/fetch_recording.sh brings here. None of them is part of sonarcal.
//
// To add one: an entry in recording_catalogue.cc, looked at by its author, with the commit that was.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sonarcal::data_io {

struct PublicRecording {
  std::string name;  // of its folder among the recordings
  std::string sensor;
  std::string shows;
  std::string licence;  // as its source states it; "none stated" leaves all rights with its makers
  std::string source;   // address of a git repository or of a page
  std::string commit;   // 40 digits, which stand for every byte; empty: not in git, to be fetched by hand
  // What to take: path in the repository, and what it is called in the folder.
  struct Path {
    std::string from;
    std::string to;
  };
  std::vector<Path> paths;
  // A file of the folder by which it is known, and its SHA-256.
  std::string witness;
  std::string witness_sha256;
};

const std::vector<PublicRecording>& RecordingCatalogue();

enum class RecordingPresence {
  kAbsent,
  kPresent,    // the witness is there, byte for byte
  kDifferent,  // the folder is there, but the witness is absent or another file
};

// Looks in `recordings`/name.
RecordingPresence PresenceOf(const PublicRecording& recording, const std::filesystem::path& recordings);

// Where recordings are looked for: $SONARCAL_RECORDINGS, or recordings/ of the working directory.
std::filesystem::path DefaultRecordingsFolder();

}  // namespace sonarcal::data_io
