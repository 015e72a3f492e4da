// Native recordings of the Sound Metrics ARIS, version 5 (`.aris`).
//
// Layout, little-endian:
//
//   file header   1024 bytes, u32 magic 0x05464444 ("DDF" 5) at byte 0, u32 frame count at 4
//   then frames of 1024 bytes of header and beams x samples bytes of grey, row = range, row 0 nearest.
//
// Frame header fields used (offset, type): FrameIndex 0 u32; FrameTime 4 u64, microseconds since 1970;
// Version 12 u32, the magic again; WindowStart 52 f32 m; WindowLength 56 f32 m; ReceiverGain 68 u32 dB;
// WaterTemp 224 f32 degrees C; PingMode 436 u32; FrequencyHiLow 440 u32, 1 = high; PulseWidth 444 u32 us;
// CyclePeriod 448 u32 us between two pings; SamplePeriod 452 u32 us; FrameRate 460 f32 Hz; SoundSpeed 464
// f32 m/s; SamplesPerBeam 468 u32; SampleStartDelay 476 u32 us; LargeLens 480 u32; TheSystemType 484 u32;
// ReorderedSamples 516 u32; Salinity 520 u32 ppt.
//
// Pings of a frame follow from PingMode, their period from the CyclePeriod of the first frame. FrameTime is
// taken as the time of the first ping.
//
// ReorderedSamples 0 means that the samples are in the order of sending, ping by ping: they are sorted by
// beam (core/sonars/aris_pings.h).
//
// Source: the manufacturer's ARIS File SDK, docs/understanding-aris-data.md and FrameHeader.h.
//
// Conversion: range edges (SampleStartDelay + i SamplePeriod) 1e-6 SoundSpeed / 2; beams by the
// manufacturer's table, reversed so that column 0 is the leftmost (aris_beam_tables.h); grey 0..255 over 80
// dB, the level of 0 unknown.
//
// The file's size replaces the frame count of the file header, and the sample timing replaces
// WindowStart/WindowLength; a note states a disagreement. A truncated last frame is omitted with a note.
// Up to 32 frames are read when a file is opened, to find pings without samples
// (data_io/sonars/aris_empty_pings.h). If there are any, all frames are read.
//
// Every frame must have the first one's ping mode and number of samples, because the positions of the frames
// depend on them. Window and sound speed may change between frames.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True if the file begins with the magic number.
bool IsAris(const std::filesystem::path& path);

// Reads the headers of the file and the first frame, and frames on request. Throws DataError, naming byte and
// field, if the header is invalid, a field is out of range, or there is no whole frame.
std::unique_ptr<RecordingSource> OpenAris(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
