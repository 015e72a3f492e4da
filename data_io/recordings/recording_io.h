// The recording folder: recording.json and one PNG (8 or 16 bits) or float TIFF a frame. This is the format
// the project writes, and the one every other format is converted to.
//
//   {"format": "sonar-recording/1",
//    "sonar": {"name", "frequency_hz", "beam_azimuth_deg": [...], "azimuth_beam_width_deg",
//              "elevation_beam_width_deg", "range_min_m", "range_max_m", "range_bins", "sound_speed_m_per_s",
//              "beam_forming": "array" | "lens", "azimuth_psf": [...], "beam_taper": [...]},
//    "water": {...}, "source_level_db", "scene",
//    "image": {"layout": "polar", "bits": 8 | 16 | 32, "db_min", "db_max", "db_span", "full_scale",
//              "quantity": "grey" | "decibel" | "power" | "depth", "display_gamma",
//              "valid": "valid.png",
//              "settings": {"gain_db", "pulse_length_us", "time_varied_gain": true | false,
//                           "compression": "logarithm" | "power"}},
//    "synthetic": true, "generator", "details": [["name", "value"], ...], "notes": ["...", ...],
//    "frames": [{"file": "frame_0000.png", "time_s", "world_from_sonar": {...}, "settings"}, ...]}
//
// Row i of an image covers range_min_m + i (range_max_m - range_min_m) / range_bins to the next; column j is
// beam j, leftmost first. Required are `format`, the window and beams, `image.layout` and `image.bits`, and
// one frame with its `file` (a plain name: frames lie in the folder itself). What is absent is unknown.
//   bits        32 means float TIFF
//   full_scale  grey value shown at db_max; if absent 255, 65535, or 1 for float images
//   quantity    what the numbers are; if absent, grey
//   valid       name of an 8-bit PNG of an image's size: 0 where a sample holds no measurement; absent: all
//   settings    of all frames but those that have their own
//   scene       relative to the folder
// Unknown keys become notes, as other programs add their own. A recording counts as synthetic where
// `synthetic` is true, `generator` names what made it, or a truth.json lies in the folder.
//
// Everything throws DataError with file, line and key.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "core/types/recording.h"
#include "data_io/files/atomic_output.h"

namespace sonarcal::data_io {

// Whether `path` is a folder with a recording.json, or such a file itself.
bool IsRecordingFolder(const std::filesystem::path& path);

// Reads recording.json at once and a frame when it is asked for. ReadFrame refuses an image whose size or
// depth is not that of recording.json (before decoding it), and values that are not finite or, if grey,
// beyond 0 .. full_scale. Frames may be read by several threads at once.
std::unique_ptr<RecordingSource> OpenRecordingFolder(const std::filesystem::path& path);

// A sonar without a recording: a file {"sonar": {...}, "water": {...}} whose members are those of
// recording.json; `water` may be absent. Fills these two, source and notes; other keys are refused.
RecordingInfo ReadSonarFile(const std::filesystem::path& file);

struct WriteRecordingOptions {
  // Of the images: 8, 16, 32 (float), or 0 for the fewest that hold the whole numbers 0 .. full_scale (grey
  // values; they are rounded) and 32 for every other quantity.
  int bits = 0;
  // Called after each frame.
  std::function<void(int frames_done, int frames_in_all)> progress = {};
  // Whether a frame's file is there already, from a run that was interrupted: such a frame is not read, only
  // named in recording.json.
  std::function<bool(int index, const std::string& file)> is_written = {};
  // Asked before each frame. Once it is so, no more are written, and recording.json names those that are
  // there and has a note of it.
  std::function<bool()> stop = {};
};

// Writes frame by frame, so that a recording of any length passes in constant memory. All frames must share
// axes and scale. `scene_path` is written relative to the folder; the scene itself is not copied. The folder
// appears whole or not at all.
void WriteRecording(const RecordingSource& recording, const std::filesystem::path& folder,
                    const WriteRecordingOptions& options = {});

// The same among other outputs, which the caller commits. Returns the number of frames in recording.json; 0
// where it was stopped before the first, and then there is no recording.json.
int WriteRecording(const RecordingSource& recording, const OutputDirectory& output,
                   const WriteRecordingOptions& options = {});

}  // namespace sonarcal::data_io
