// Native recordings of the Sound Metrics DIDSON, versions 3 and 4 (`.ddf`).
//
// Layout, little-endian. File header, 512 bytes (version 3) or 1024 (4), offset and type:
//   "DDF" 0, version byte 3; frames 4 i32; frame rate 8 i32 Hz; resolution 12 i32, 1 = high frequency; beams
//   16 i32, 48 or 96; samples per beam 24 i32, 512; gain 28 i32 dB; reverse 40 i32; serial number 44 i32;
//   date 48 char[32]; id 80 char[256]
// then for each frame a header of 256 bytes (version 3) or 1024 (4):
//   number 0 i32; year, month, day, hour, minute, second, hundredth 20..44 i32; transmit 48; window start
//   code 52 i32; window length code 56 i32; gain 68 i32 dB; temperatures of the housing 72, 76 i32 degrees C;
//   focus 84; sonar pan, tilt, roll 160, 164, 168 f32 degrees; flags 192 i32, bit 0 classic windows (else
//   extended ones), bit 1 long range
// and beams x 512 bytes of grey, row = range, row 0 nearest.
//
// Conversion: window start = code x 0.375 m (classic) or 0.419 m (extended), twice that at low frequency.
// Window length by code (plus 2 at low frequency), one table per flag. Sonars with a serial number below 19
// have classic windows regardless of the flags, number 15 also the long range. If the reverse flag is 0,
// columns come from the right. Beams by the lens's polynomial (data_io/sonars/didson_io.h); each of 48 beams
// lies midway between two of the 96. Source: the manufacturer's MATLAB readers as published with
// github.com/gavinmacaulay/collpen. Tested with files made from this layout; not tested with a real file.
//
// Not recorded, and noted: sound speed, water, dB scale, elevation beam width. Clock fields have no time zone
// and are read as UTC. A truncated last frame is omitted with a note. If the header's frame count contradicts
// the file's size, the size is used, with a note. Every frame has its own window.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True if the file begins with "DDF" and version 3 or 4.
bool IsDdf(const std::filesystem::path& path);

// Reads the headers of the file and the first frame, and frames on request. Throws DataError, naming byte and
// field, if a field is out of range, or there is no whole frame.
std::unique_ptr<RecordingSource> OpenDdf(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
