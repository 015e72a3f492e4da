// The recording folder: recording.json and one PNG (8 or 16 bits) or float TIFF per frame. The project writes
// this format, and every other format is converted to it.
//
//   {"format": "sonar-recording/1",
//    "sonar": {"name", "frequency_hz", "beam_azimuth_deg": [...], "azimuth_beam_width_deg",
//              "elevation_beam_width_deg", "range_min_m", "range_max_m", "range_bins", "sound_speed_m_per_s",
//              "beam_forming": "array" | "lens", "azimuth_psf": [...], "beam_taper": [...], "pings": {...}},
//    "water": {...}, "source_level_db", "scene",
//    "image": {"layout": "polar", "bits": 8 | 16 | 32, "db_min", "db_max", "db_span", "full_scale",
//              "quantity": "grey" | "decibel" | "power" | "depth", "display_gamma",
//              "valid": "valid.png",
//              "settings": {"gain_db", "pulse_length_us", "time_varied_gain": true | false,
//                           "compression": "logarithm" | "power"}},
//    "synthetic": true, "generator", "details": [["name", "value"], ...], "notes": ["...", ...],
//    "frames": [{"file": "frame_0000.png", "time_s", "world_from_sonar": {...}, "motion": {...},
//                "settings"}, ...]}
//
// Row i of an image covers range_min_m + i (range_max_m - range_min_m) / range_bins to the next row's start.
// Column j is beam j, leftmost first. Required: `format`, the window and beams, `image.layout` and
// `image.bits`, and one frame with its `file` (a plain name: frames lie in the folder itself). Absent values
// are unknown.
//
//   bits        32 means float TIFF
//   full_scale  grey value displayed at db_max; default 255, 65535, or 1 for float images
//   quantity    quantity of the values; default grey
//   valid       name of an 8-bit PNG of the image's size: 0 for a sample without a measurement; default: none
//   settings    settings of all frames, unless a frame has its own
//   scene       path relative to the folder
//
// Unknown keys become notes, because other programs may add theirs. A recording counts as synthetic if
// `synthetic` is true, `generator` is present, or a truth.json lies in the folder.
//
// All functions throw DataError with file, line and key.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "core/types/recording.h"
#include "data_io/files/atomic_output.h"

namespace sonarcal::data_io {

// True if `path` is a folder with a recording.json, or such a file itself.
bool IsRecordingFolder(const std::filesystem::path& path);

// Reads recording.json immediately and frames on request. ReadFrame rejects an image whose size or depth
// differs from recording.json (before decoding it), and values that are not finite or, if grey, outside 0 ..
// full_scale. Several threads may read frames at once.
std::unique_ptr<RecordingSource> OpenRecordingFolder(const std::filesystem::path& path);

// Opens the recording that `folder`/recording.json describes, with its images in the folder `images`: for
// published images that came without a recording.json. `info().source` is `images`.
std::unique_ptr<RecordingSource> OpenRecordingOf(const std::filesystem::path& images,
                                                 const std::filesystem::path& folder);

// Reads a sonar without a recording: a file {"sonar": {...}, "water": {...}} whose members are those of
// recording.json; `water` may be absent. Fills these two, source and notes; rejects other keys.
RecordingInfo ReadSonarFile(const std::filesystem::path& file);

// Writes such a file. It appears completely or not at all.
void WriteSonarFile(const std::filesystem::path& file, const RecordingInfo& info);

struct WriteRecordingOptions {
  // Bits of the images: 8, 16, 32 (float). Grey values are rounded to 8 or 16 bits. 0: the fewest that hold
  // the values of all frames; 8 or 16 hold whole grey values only.
  int bits = 0;
  // Called after each frame.
  std::function<void(int frames_done, int frames_in_all)> progress = {};
  // True if a frame's file exists already, from an interrupted run. Such a frame is not read, only listed in
  // recording.json.
  std::function<bool(int index, const std::string& file)> is_written = {};
  // Called before each frame. After true, no more frames are written; recording.json lists the existing ones
  // and has a note.
  std::function<bool()> stop = {};
};

// Writes frame by frame, so a recording of any length needs constant memory. All frames must share axes and
// scale. `scene_path` is written relative to the folder; the scene itself is not copied. The folder appears
// completely or not at all. The files of an earlier recording are replaced in one step; others stay.
void WriteRecording(const RecordingSource& recording, const std::filesystem::path& folder,
                    const WriteRecordingOptions& options = {});

// Writes a recording among other outputs, which the caller commits. Returns the number of frames in
// recording.json. If stopped before the first frame, returns 0 and writes no recording.json.
int WriteRecording(const RecordingSource& recording, const OutputDirectory& output,
                   const WriteRecordingOptions& options = {});

}  // namespace sonarcal::data_io
