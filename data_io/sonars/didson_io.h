// Pings of a Sound Metrics DIDSON as published with github.com/pvazteixeira/multibeam: a folder with two
// files a ping, both named for its time in microseconds since 1970,
//   1468966376476216.png    8-bit grey, 512 ranges (row 0 nearest) x 96 beams
//   1468966376476216.json   settings, below
// or the path of one of the two, for that ping alone.
//
// Fields of the JSON, all required, others passed over: "num_beams", "num_bins"; "min_range", "max_range", m;
// "fov", rad; "psf", azimuth point spread function by offset in beams, offset 0 in the middle; "taper",
// relative level of each beam; "noise", no unit given; "rx_gain", dB.
//
// Beams are not evenly spaced. The lens puts an azimuth of t degrees on
//   beam = 0.0030 t^3 - 0.0055 t^2 + 2.6829 t + 48.04
// (known for 96 beams only). Beams are counted from 0, a whole number being a beam's centre: then the outer
// edges, -0.5 and 95.5, lie 28.99 degrees apart, in keeping with the 28.80 of "fov", and users of the maker's
// polynomial add 1 for arrays that begin at 1. Beam 0 is taken as the leftmost column: the source does not
// say which side it is.
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

// Reads the settings of the first ping; every ping's own settings are read with its frame. Throws DataError
// naming file and key where they are damaged or outside their domain.
std::unique_ptr<RecordingSource> OpenDidson(const std::filesystem::path& path);

// Azimuths of the centres of the 96 beams, radians, strictly increasing: the inverse of the polynomial.
std::vector<double> DidsonAzimuthsRad();

}  // namespace sonarcal::data_io
