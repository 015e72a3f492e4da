// Converts recording.json to and from plain types. Internal to data_io/recordings/recording_io.h; include
// that file instead.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/types/recording.h"

namespace sonarcal::data_io {

inline constexpr const char* kRecordingFile = "recording.json";

struct RecordingHeader {
  RecordingInfo info;
  int bits = 8;                   // bits of the images: 8, 16, or 32 for float
  std::vector<FrameInfo> frames;  // `name` is the name of the image file
  std::string valid_file = {};    // file of info.valid, which is a separate picture; empty: none
};

// `folder` contains recording.json.
RecordingHeader ReadRecordingHeader(const std::filesystem::path& folder);

// Reads a text that will be recording.json in `folder`.
RecordingHeader ParseRecordingHeader(std::string_view text, const std::filesystem::path& folder);

// `folder` will contain the file, absolute; the scene's path is made relative to it.
nlohmann::ordered_json RecordingJson(const RecordingHeader& header, const std::filesystem::path& folder);

}  // namespace sonarcal::data_io
