// Public recordings of real imaging sonars, with their sources and licences. `sonarcal recordings` lists
// them, scripts/fetch_recording.sh downloads them. None of them is part of sonarcal.
//
// To add one: an entry in recording_catalogue.cc, checked by its author, with the commit that was checked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sonarcal::data_io {

struct PublicRecording {
  std::string name;  // name of its folder among the recordings
  std::string sensor;
  std::string shows;
  std::string truth = {};  // what is known besides the images: poses, models; empty: nothing
  std::string licence;     // as its source states it; with "none stated" all rights remain with its authors
  std::string source;      // address of a git repository or of a page
  std::string data = {};   // address of the data if the source only describes them
  std::string commit;  // 40 digits, which identify every byte; empty: not in git, to be downloaded by hand
  // Files to take: path in the repository, and name in the folder.
  struct Path {
    std::string from;
    std::string to;
  };
  std::vector<Path> paths;
  // File of the folder that identifies it, and its SHA-256.
  std::string witness;
  std::string witness_sha256;
};

const std::vector<PublicRecording>& RecordingCatalogue();

enum class RecordingPresence {
  kAbsent,
  kPresent,    // the witness is present and identical
  kDifferent,  // the folder exists, but the witness is absent or different
};

// Checks `recordings`/name.
RecordingPresence PresenceOf(const PublicRecording& recording, const std::filesystem::path& recordings);

// Folder of recordings: $SONARCAL_RECORDINGS, or recordings/ in the working directory.
std::filesystem::path DefaultRecordingsFolder();

}  // namespace sonarcal::data_io
