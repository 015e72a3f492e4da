// Native recordings of the Sound Metrics DIDSON, versions 3 and 4 (`.ddf`).
//
// Layout, little-endian. File header, 512 bytes (version 3) or 1024 (4), offset and type:
//   "DDF" 0, version byte 3; frames 4 i32; frame rate 8 i32 Hz; resolution 12 i32, 1 = high frequency; beams
//   16 i32, 48 or 96; samples a beam 24 i32, 512; gain 28 i32 dB; reverse 40 i32; serial number 44 i32;
//   date 48 char[32]; id 80 char[256]
// then for each frame a header of 256 bytes (version 3) or 1024 (4):
//   number 0 i32; year, month, day, hour, minute, second, hundredth 20..44 i32; transmit 48; window start
//   code 52 i32; window length code 56 i32; gain 68 i32 dB; temperatures of the housing 72, 76 i32 degrees C;
//   focus 84; sonar pan, tilt, roll 160, 164, 168 f32 degrees; flags 192 i32, bit 0 classic windows (else
//   extended ones), bit 1 long range
// and beams x 512 bytes of grey, row = range, row 0 nearest.
//
// What it becomes: window start = code x 0.375 m (classic) or 0.419 m (extended), twice that at low
// frequency; window length by code (plus 2 at low frequency), a table a flag; sonars with a serial number
// below 19 have classic windows whatever the flags say, number 15 also the long range. Where the reverse flag
// is 0, columns come from the right. Beams by the lens's polynomial (data_io/sonars/didson_io.h); of 48
// beams, each lies midway between two of the 96. Source: the maker's MATLAB readers as published with
// github.com/gavinmacaulay/collpen. No real file was at hand to try: what follows from the layout alone is
// tested.
//
// Not recorded, and noted: sound speed, water, dB scale, elevation beam width. Clock fields have no time zone
// and are taken as UTC. A last frame that is cut short is left out, with a note; so is a frame count of the
// header that the file's size contradicts. Every frame has its own window.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True where the file begins with "DDF" and version 3 or 4.
bool IsDdf(const std::filesystem::path& path);

// Reads the headers of file and first frame; frames are read when asked for. Throws DataError naming byte and
// field where a field lies outside its domain, or not one whole frame is there.
std::unique_ptr<RecordingSource> OpenDdf(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
