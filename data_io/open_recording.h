// Any recording the project understands, told by its content: magic numbers, and what a folder holds.
//
// Another format: write its reader (data_io/README.md), then add a line to the table in open_recording.cc.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Throws DataError where nothing is there, what is there is of no known format (the sentence lists those
// known), or its reader refuses it.
std::unique_ptr<RecordingSource> OpenRecording(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
