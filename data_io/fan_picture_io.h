// Fan pictures and videos as sonar viewers export them (PNG, JPEG, AVI, MP4): a picture, a folder of them, or
// a video, resampled to range and azimuth. What the picture does not say stands in a JSON file beside it:
// `NAME.fan.json` beside a file NAME, `fan.json` in a folder.
//
//   {"format": "sonar-fan-picture/1",
//    "range_m": [0.69, 3.0],                      required: ranges of the near and the far arc
//    "name": "ARIS Explorer 3000", "frequency_hz": 3e6, "sound_speed_m_per_s": 1480,
//    "azimuth_beam_width_deg": 0.3, "elevation_beam_width_deg": 15,
//    "beams": 128, "range_bins": 780,             of the polar image; default: as fine as the picture
//    "db_span": 80,                               from black to white, where known
//    "apex_px": [361.9, 1343.0], "radius_px": [309, 1340], "half_angle_deg": 15.13, "x_scale": 1.0}
//
// The last four (data_io/fan_geometry.h) come together or not at all; without them the fan is found by its
// edges, over up to 32 of the frames. half_angle_deg may also stand alone, where the sonar's is known: then
// x_scale follows from it, which the edges tell least.
//
// Beams are even in azimuth; each polar pixel is interpolated from the four picture pixels around its centre.
// Neighbours are not independent, grey values have passed through whatever the viewer did to them, and of a
// colour picture the luminance is taken: notes say so. Pixels that lie outside the picture are 0, and the
// share of them is noted.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/types/recording.h"

namespace sonarcal {

// A picture, a folder of pictures or a video. Reads first bytes only.
bool IsFanPictures(const std::filesystem::path& path);

// Throws DataError where the JSON file is absent (the sentence holds one to begin with, with the geometry
// that was found), where no fan can be made out, or a picture is not to be read.
std::unique_ptr<RecordingSource> OpenFanPictures(const std::filesystem::path& path);

}  // namespace sonarcal
