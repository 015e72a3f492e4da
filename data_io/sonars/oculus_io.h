// Raw messages of a Blueprint Subsea Oculus: "simple ping results", versions 1 and 2, one or more in
// sequence, or in the log of the manufacturer's viewer (data_io/sonars/oculus_log.h).
//
// Layout, little-endian, packed:
//
//   head, 16 bytes     u16 0x4f53, source, destination, message id (0x23), version; u32 payload size; u16
//                      spare
//   fire settings      u8 mode (1 low, 2 high frequency), ping rate, network speed, gamma, flags;
//                      f64 range (m, or % without flag 1), gain %, sound speed m/s, salinity ppt;
//                      version 2: u32 extended flags, 8 x u32 reserved
//   ping result 1      u32 ping id, status; f64 frequency Hz, temperature C, pressure bar, sound speed m/s;
//                      u32 start; u8 data size; f64 range resolution m; u16 ranges, beams;
//                      u32 image offset (from the head), image size, message size
//   ping result 2      as 1, with f64 heading, pitch, roll (degrees) before the sound speed, start as f64
//                      seconds since power-up, and 4 x u32 spare before the image offset
//   bearings           i16 per beam, 0.01 degree, NOT evenly spaced, positive to the right
//   image              row = range, row 0 nearest; samples of data size 0..3: 8, 16, 24, 32 bits. With flag 4
//                      each row begins with a u32 gain; its values are divided by the square root of it.
//
// Source: the manufacturer's Oculus.h. Descriptions of version 2 disagree about the extended flags; the sizes
// in the message determine whether they are present.
//
// Conversion: ranges 0 .. ranges x resolution; grey 0 .. 2^bits - 1, scale in dB unknown; display_gamma from
// the gamma byte g: g / 255, and 1 for g = 0. Other messages are skipped and a truncated last one is omitted,
// with notes. Temperature and pressure are often invalid; impossible values are omitted and noted.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True if the file begins with the head of an Oculus message, or of a log of them.
bool IsOculus(const std::filesystem::path& path);

// Reads the heads of all messages, and images on request. An item of a log with a damaged payload is a frame
// that cannot be read. A damaged head of an item ends the reading. The sonar is described from the first
// ping that can be read, with a note if it is not the first one. Throws DataError, naming byte and field, if
// the file holds no whole ping or none can be read. Reading a frame throws it if the ping's fields
// contradict each other or its size.
std::unique_ptr<RecordingSource> OpenOculus(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
