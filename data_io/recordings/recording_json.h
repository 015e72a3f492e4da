// recording.json to and from plain types; see data_io/recordings/recording_io.h, which is what to include.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/types/recording.h"

namespace sonarcal::data_io {

inline constexpr const char* kRecordingFile = "recording.json";

struct RecordingHeader {
  RecordingInfo info;
  int bits = 8;                   // of the images: 8, 16, or 32 for float
  std::vector<FrameInfo> frames;  // `name` is the name of the image file
  std::string valid_file = {};    // of info.valid, which stands in a picture of its own; empty: none
};

// `folder` is where recording.json lies.
RecordingHeader ReadRecordingHeader(const std::filesystem::path& folder);

// `folder` is where the file will lie, absolute; the scene's path is made relative to it.
nlohmann::ordered_json RecordingJson(const RecordingHeader& header, const std::filesystem::path& folder);

}  // namespace sonarcal::data_io
