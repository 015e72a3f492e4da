// Where the pixels of a bare picture of a sonar lie, as somebody who knows the sonar says it: pictures and
// videos that viewers export, and pictures in bags, do not.
//
//   {"format": "sonar-picture-geometry/1",
//    "range_m": [0.69, 3.0],                       of the nearest and the farthest edge; all else may be
//    absent "name": "ARIS Explorer 3000", "frequency_hz": 3e6, "sound_speed_m_per_s": 1480,
//    "azimuth_beam_width_deg": 0.3, "elevation_beam_width_deg": 15,
//    "db_span": 80,                                from black to white
//    "fan": {"apex_px": [361.9, 1343.0], "radius_px": [309, 1340], "half_angle_deg": 15.13, "x_scale": 1.0,
//            "beams": 128, "range_bins": 780}}
// or, in place of "fan",
//    "polar": {"azimuth_first_deg": -30, "azimuth_last_deg": 30, "nearest_row": "top" | "bottom"}
//
// fan    Ahead is up (data_io/pictures/fan_geometry.h). apex_px and radius_px come together; without them, or
// without
//        "fan" and "polar", the fan is to be found by its edges. half_angle_deg may stand alone, where the
//        sonar's is known: x_scale follows from it, which edges tell least. Default of beams and range_bins:
//        as fine as the picture. Beams are even in azimuth, the outer edges of the outer ones at the half
//        angle; a polar pixel is interpolated between the four picture pixels around its centre.
// polar  Rows are ranges from one end of the window to the other, columns beams, even from the centre of the
//        first column to that of the last.
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

struct PictureGeometry {
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  std::string name = {};
  double frequency_hz = 0.0;  // 0 = unknown, and so on
  double sound_speed_m_per_s = 0.0;
  double azimuth_beam_width_deg = 0.0;
  double elevation_beam_width_deg = 0.0;
  std::optional<double> db_span = {};

  struct Polar {
    double azimuth_first_rad = 0.0;
    double azimuth_last_rad = 0.0;
    bool nearest_on_top = true;

    bool operator==(const Polar&) const = default;
  };
  std::optional<Polar> polar = {};            // else a fan
  std::optional<FanGeometry> fan = {};        // absent: to be found
  std::optional<double> half_angle_deg = {};  // of a fan that is to be found
  int beams = 0;                              // of a fan; 0: as fine as the picture, as are range_bins
  int range_bins = 0;

  // Takes a fan that was found, stretched to half_angle_deg where that is known.
  void TakeFound(FanGeometry found);

  // Sonar, but for its axes, and scale of `info`.
  void Describe(RecordingInfo& info) const;

  bool operator==(const PictureGeometry&) const = default;
};

// Throws DataError with file, line and key.
PictureGeometry ReadPictureGeometry(const std::filesystem::path& file);

// "\"apex_px\": [...], \"radius_px\": ...": the members of "fan".
std::string JsonOf(const FanGeometry& fan);

// From pictures of one size to range and azimuth: what is computed once for all of them.
class PictureSampler {
 public:
  // geometry.polar or geometry.fan is there. Throws DataError beginning with `where` where a polar picture
  // has not two columns.
  PictureSampler(const PictureGeometry& geometry, int rows, int cols, const std::string& where);

  const PolarAxes& axes() const { return axes_; }
  int rows() const { return rows_; }
  int cols() const { return cols_; }
  // Polar pixels that lie within the picture, where not all do; the others are 0.
  std::optional<Mask> inside() const;

  // The picture has the size given. Row 0 nearest, columns from left to right.
  Grid<float> Apply(const Grid<float>& picture) const;

 private:
  // Four picture pixels about a polar pixel's centre; weights of the right and the lower ones.
  struct Sample {
    std::int32_t index = -1;  // of the upper left; -1 outside the picture
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
