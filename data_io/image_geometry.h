// Where the pixels of a bare picture of a sonar lie, as somebody who knows the sonar says it:
// sensor_msgs/Image and CompressedImage do not.
//
//   {"format": "sonar-image-geometry/1",
//    "range_min_m": 0.5, "range_max_m": 10.0,
//    "name": "...", "frequency_hz": 1.2e6, "sound_speed_m_per_s": 1480,        (each may be absent)
//    "polar": {"azimuth_first_deg": -30, "azimuth_last_deg": 30, "nearest_row": "top" or "bottom"}}
// or "fan": {"apex_px": [x, y], "pixel_m": 0.01, "half_angle_deg": 30, "beams": 256, "range_bins": 512}
//
// polar   rows are ranges from one end of the window to the other, columns beams, evenly spaced from the
// centre
//         of the first column to that of the last
// fan     ahead is up; the apex, where range is 0, lies at column x and row y, counted from the centre of the
// top
//         left pixel, and may be outside. The fan is sampled by nearest neighbour at the centres of that many
//         bins and beams, the outer beams' centres lying at the half angle.
#pragma once

#include <filesystem>
#include <string>

#include "data_io/ros_picture.h"
#include "data_io/types/image.h"

namespace sonarcal {

struct ImageGeometry {
  std::string name;
  double frequency_hz = 0.0;  // 0 = unknown, as is the sound speed
  double sound_speed_m_per_s = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  bool is_fan = false;
  // Polar.
  double azimuth_first_rad = 0.0;
  double azimuth_last_rad = 0.0;
  bool nearest_on_top = true;
  // Fan.
  double apex_col = 0.0;
  double apex_row = 0.0;
  double pixel_m = 0.0;
  double half_angle_rad = 0.0;
  int beams = 0;
  int range_bins = 0;

  bool operator==(const ImageGeometry&) const = default;
};

// Throws DataError with file, line and key.
ImageGeometry ReadImageGeometry(const std::filesystem::path& file);

// Columns from left to right, row 0 nearest. Throws DataError beginning with `where` where a fan reaches
// beyond the picture, or a polar picture has not two columns.
PolarImage PolarFromPicture(const RosPicture& picture, const ImageGeometry& geometry,
                            const std::string& where);

}  // namespace sonarcal
