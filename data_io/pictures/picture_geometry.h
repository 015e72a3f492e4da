// Geometry of a bare picture of a sonar, written by the user. Pictures and videos exported by viewers, and
// pictures in bags, do not contain it.
//
//   {"format": "sonar-picture-geometry/1",
//    "range_m": [0.69, 3.0],                       nearest and farthest edge; all other keys are optional
//    "name": "ARIS Explorer 3000", "frequency_hz": 3e6, "sound_speed_m_per_s": 1480,
//    "azimuth_beam_width_deg": 0.3, "elevation_beam_width_deg": 15,
//    "db_span": 80,                                from black to white
//    "synthetic": true,                            made by a simulation
//    "fan": {"apex_px": [361.9, 1343.0], "radius_px": [309, 1340], "half_angle_deg": 15.13, "x_scale": 1.0,
//            "beams": 128, "range_bins": 780}}
//
// or, instead of "fan",
//
//    "polar": {"azimuth_first_deg": -30, "azimuth_last_deg": 30, "nearest_row": "top" | "bottom"}
//
//   range_m  Of a fan, the farthest edge alone is enough: [3.0]. The radii of its arcs then give the nearest.
//   fan    Forward is up (data_io/pictures/fan_geometry.h). apex_px and radius_px must occur together.
//          Without them, or without "fan" and "polar", the fan is found by its edges. half_angle_deg may
//          occur alone if the sonar's is known; it determines x_scale, which edges determine least. Default
//          of beams and range_bins: the resolution of the picture. Beams are evenly spaced, with the outer
//          edges of the outer ones at the half angle. A polar pixel is interpolated from the four picture
//          pixels around its centre.
//   polar  Rows are ranges from one end of the window to the other. Columns are beams, evenly spaced from the
//          centre of the first column to that of the last.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types/mask.h"
#include "core/types/recording.h"
#include "data_io/pictures/fan_geometry.h"

namespace sonarcal::data_io {

class JsonReader;

struct PictureGeometry {
  std::optional<double> range_min_m = {};  // absent: by the radii of the fan
  double range_max_m = 0.0;
  std::string name = {};
  double frequency_hz = 0.0;  // 0 = unknown; the following members likewise
  double sound_speed_m_per_s = 0.0;
  double azimuth_beam_width_deg = 0.0;
  double elevation_beam_width_deg = 0.0;
  std::optional<double> db_span = {};
  bool synthetic = false;  // made by a simulation

  struct Polar {
    double azimuth_first_rad = 0.0;
    double azimuth_last_rad = 0.0;
    bool nearest_on_top = true;

    bool operator==(const Polar&) const = default;
  };
  std::optional<Polar> polar = {};            // absent: a fan
  std::optional<FanGeometry> fan = {};        // absent: found by its edges
  std::optional<double> half_angle_deg = {};  // half angle of a fan that is found by its edges
  int beams = 0;                              // fan only; 0: resolution of the picture; range_bins likewise
  int range_bins = 0;

  // Stores a fan that was found, stretched to half_angle_deg if that is known.
  void TakeFound(FanGeometry found);

  // Fills the scale and the origin of `info`, and its sonar without the axes.
  void Describe(RecordingInfo& info) const;

  bool operator==(const PictureGeometry&) const = default;
};

// Throws DataError with file, line and key.
PictureGeometry ReadPictureGeometry(const std::filesystem::path& file);

// Members of "fan" as text: "\"apex_px\": [...], \"radius_px\": ...".
std::string JsonOf(const FanGeometry& fan);

// Reads the members of "fan", which must contain its position: apex_px, radius_px, half_angle_deg and,
// optional, x_scale. Throws DataError with file, line and key.
FanGeometry ReadFanGeometry(const JsonReader& json);

// Samples a fan picture at the centres of the beams and range bins of `axes`, by nearest neighbour. The near
// and the far arc of `fan` show axes.range_min_m and axes.range_max_m. Throws DataError beginning with
// `where` if the picture does not hold all samples.
Grid<float> SampleFan(const Grid<float>& picture, const FanGeometry& fan, const PolarAxes& axes,
                      const std::string& where);

// Converts pictures of one size to range and azimuth. Stores the weights that all pictures share.
class PictureSampler {
 public:
  // geometry.polar or geometry.fan must be set. Throws DataError, beginning with `where`, if a polar picture
  // has fewer than two columns.
  PictureSampler(const PictureGeometry& geometry, int rows, int cols, const std::string& where);

  const PolarAxes& axes() const { return axes_; }
  int rows() const { return rows_; }
  int cols() const { return cols_; }
  // Polar pixels that lie within the picture; absent if all do. The others are 0.
  std::optional<Mask> inside() const;

  // The picture must have the given size. Row 0 nearest, columns from left to right.
  Grid<float> Apply(const Grid<float>& picture) const;

 private:
  // Four picture pixels around a polar pixel's centre, and the weights of the right and the lower ones.
  struct Sample {
    std::int32_t index = -1;  // index of the upper left pixel; -1 outside the picture
    float right = 0.0F;
    float below = 0.0F;
  };

  void LayOutFan(const PictureGeometry& geometry);
  void LayOutPolar(const PictureGeometry& geometry);
  Sample SampleAt(double x, double y) const;

  int rows_;
  int cols_;
  PolarAxes axes_;
  std::vector<Sample> samples_;
};

}  // namespace sonarcal::data_io
