// Opens a recording of any supported format. The format is detected from the content: magic numbers, and the
// files in a folder.
//
// To add a format: write its reader (data_io/README.md), then add a line to the table in open_recording.cc.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Path of the recording that `path` names: `path` itself or, for a folder that is no recording but holds
// exactly one, as a file or a subfolder, the path of that one. Throws DataError, naming them, if it holds
// several.
std::filesystem::path LocateRecording(const std::filesystem::path& path);

// Opens LocateRecording(path), with a note if that is not `path`. Throws DataError if `path` does not exist,
// has no known format (the message lists the known ones), or its reader refuses it.
std::unique_ptr<RecordingSource> OpenRecording(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
