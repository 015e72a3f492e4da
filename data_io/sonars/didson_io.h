// Pings of a Sound Metrics DIDSON as published with github.com/pvazteixeira/multibeam: a folder with two
// files per ping, both named after its time in microseconds since 1970,
//
//   1468966376476216.png    8-bit grey, 512 ranges (row 0 nearest) x 96 beams
//   1468966376476216.json   settings, below
//
// or the path of one of the two, for that ping only.
//
// Fields of the JSON, all required, others ignored: "num_beams", "num_bins"; "min_range", "max_range", m;
// "fov", rad; "psf", azimuth point spread function by offset in beams, offset 0 in the middle; "taper",
// relative level of each beam; "noise", no unit given; "rx_gain", dB.
//
// Beams are not evenly spaced. The lens maps an azimuth of t degrees to
//
//   beam = 0.0030 t^3 - 0.0055 t^2 + 2.6829 t + 48.04
//
// (known for 96 beams only). Beams are numbered from 0, with integers at beam centres. The outer edges, -0.5
// and 95.5, are then 28.99 degrees apart, which agrees with the 28.80 of "fov"; users of the manufacturer's
// polynomial add 1 for arrays that begin at 1. Beam 0 is assumed to be the leftmost column, because the
// source does not state its side.
//
// Not recorded, and noted: frequency (96 beams: 1.8 MHz), sound speed, elevation beam width, dB scale, pose.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True for a folder with such a pair of files, and for either file of a pair. Reads no content.
bool IsDidson(const std::filesystem::path& path);

// Reads the settings of the first ping; each other ping's settings are read with its frame. Throws DataError,
// naming file and key, if they are damaged or out of range.
std::unique_ptr<RecordingSource> OpenDidson(const std::filesystem::path& path);

// Azimuths of the centres of the 96 beams, radians, strictly ascending: the inverse of the polynomial.
std::vector<double> DidsonAzimuthsRad();

}  // namespace sonarcal::data_io
