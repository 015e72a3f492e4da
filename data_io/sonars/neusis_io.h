// Recordings in the form of NeuSIS (github.com/rpl-cmu/neusis), which AONeuS and SonarSplat share: images of
// the simulator HoloOcean, or of a real sonar, with poses. A folder
//
//   Config.json    a HoloOcean configuration: agents[i].sensors[k] with sensor_type "ImagingSonar" and its
//                  `configuration`; or that `configuration` alone
//   Data/NNN.pkl   a frame: a pickled dict with the arrays "ImagingSonar" and "PoseSensor" (may be absent);
//                  the pickles may also lie beside Config.json
//
// or the path of one pickle, for that frame only. Frames are in natural order of their names.
//
// Fields of `configuration`: RangeMin, RangeMax, m; Azimuth, degrees, the field of view; Elevation, degrees,
// the height of the beams (optional); RangeBins, AzimuthBins (optional; the images have priority, with a
// note). Others are ignored, such as the noise of the simulator.
//
//   ImagingSonar   ranges x beams; row 0 nearest, row i covers RangeMin + i (RangeMax - RangeMin) / rows to
//                  the next. Column j covers the azimuths from -Azimuth/2 + j Azimuth / columns to the next,
//                  positive to the LEFT: column 0 is the rightmost beam, so columns are reversed here.
//                  uint8 and uint16 are grey levels. float32 and float64 are 0..1, as the published programs
//                  read them, and become grey levels 0..65535; larger values are cut off.
//   PoseSensor     4 x 4, world from sonar; metres, world Z up; sonar X ahead, Y left, Z up. The published
//                  programs apply it to points of the image, so it is the pose of the sonar, not of the
//                  vehicle. A note says so if Config.json mounts the two sensors differently.
//
// A recording is synthetic if Config.json names a world of the simulator.
//
// Not recorded, and noted: frequency, sound speed, water, dB scale, gain, time.
//
// Source: load_data.py and get_arcs in helpers.py of NeuSIS; ImagingSonar.cpp of HoloOcean.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True for a folder with Config.json and pickles, for its folder Data, and for one such pickle. Reads no
// content.
bool IsNeusis(const std::filesystem::path& path);

// Reads Config.json and the first frame; other frames are read on request. Throws DataError, naming file and
// key or byte, if they are damaged or a pickle holds anything but data (data_io/files/pickle.h).
std::unique_ptr<RecordingSource> OpenNeusis(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
