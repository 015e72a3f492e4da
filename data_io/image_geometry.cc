#include "data_io/image_geometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "data_io/json_reader.h"
#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

constexpr double kMostRangeM = 10000.0;
constexpr int kMostBins = 1 << 14;

void ReadPolar(const JsonReader& json, ImageGeometry& geometry) {
  const auto angle_rad = [&](const char* key) {
    return RadFromDeg(json.At(key).Number(NumberRange::Between(-180.0, 180.0)));
  };
  geometry.azimuth_first_rad = angle_rad("azimuth_first_deg");
  geometry.azimuth_last_rad = angle_rad("azimuth_last_deg");
  if (geometry.azimuth_first_rad == geometry.azimuth_last_rad)
    json.At("azimuth_last_deg").Fail("is azimuth_first_deg, expected another angle");
  geometry.nearest_on_top =
      json.At("nearest_row").Word(JsonWords<bool, 2>{{{"top", true}, {"bottom", false}}});
}

void ReadFan(const JsonReader& json, ImageGeometry& geometry) {
  const std::vector<double> apex = json.At("apex_px").Numbers(NumberRange::Between(-1e6, 1e6));
  if (apex.size() != 2)
    json.At("apex_px").Fail(fmt::format("has {} numbers, expected a column and a row", apex.size()));
  geometry.is_fan = true;
  geometry.apex_col = apex[0];
  geometry.apex_row = apex[1];
  geometry.pixel_m = json.At("pixel_m").Number(NumberRange::AboveUpTo(0.0, 1000.0));
  geometry.half_angle_rad = RadFromDeg(json.At("half_angle_deg").Number(NumberRange::AboveUpTo(0.0, 90.0)));
  geometry.beams = static_cast<int>(json.At("beams").Integer(2, kMostBins));
  geometry.range_bins = static_cast<int>(json.At("range_bins").Integer(1, kMostBins));
}

// From `first` to `last`, both included.
std::vector<double> Evenly(double first, double last, int count) {
  std::vector<double> values(count);
  for (int i = 0; i < count; ++i) values[i] = first + (last - first) * i / (count - 1);
  return values;
}

PolarImage SampleFan(const RosPicture& picture, const ImageGeometry& geometry, const std::string& where) {
  PolarImage image{{geometry.range_min_m, geometry.range_max_m, geometry.range_bins,
                    Evenly(-geometry.half_angle_rad, geometry.half_angle_rad, geometry.beams)},
                   {},
                   Grid<float>(geometry.range_bins, geometry.beams)};
  for (int beam = 0; beam < geometry.beams; ++beam) {
    const double azimuth_rad = image.axes.beam_azimuth_rad[beam];
    for (int bin = 0; bin < geometry.range_bins; ++bin) {
      const double radius_px = image.axes.range_centre_m(bin) / geometry.pixel_m;
      const double row = std::round(geometry.apex_row - radius_px * std::cos(azimuth_rad));
      const double col = std::round(geometry.apex_col + radius_px * std::sin(azimuth_rad));
      if (!(row >= 0.0 && row < picture.value.rows() && col >= 0.0 && col < picture.value.cols())) {
        throw DataError(
            "{}: the fan reaches beyond the picture of {} x {} pixels: {:.3f} m at {:.2f} degrees would lie "
            "at row "
            "{:g}, column {:g}",
            where, picture.value.rows(), picture.value.cols(), image.axes.range_centre_m(bin),
            DegFromRad(azimuth_rad), row, col);
      }
      image.value(bin, beam) = picture.value(static_cast<int>(row), static_cast<int>(col));
    }
  }
  return image;
}

PolarImage TurnPolar(const RosPicture& picture, const ImageGeometry& geometry, const std::string& where) {
  const int bins = picture.value.rows();
  const int beams = picture.value.cols();
  if (beams < 2) throw DataError("{}: a picture of {} columns, expected at least 2 beams", where, beams);
  const bool from_right = geometry.azimuth_first_rad > geometry.azimuth_last_rad;
  const auto [left_rad, right_rad] = std::minmax(geometry.azimuth_first_rad, geometry.azimuth_last_rad);
  PolarImage image{{geometry.range_min_m, geometry.range_max_m, bins, Evenly(left_rad, right_rad, beams)},
                   {},
                   Grid<float>(bins, beams)};
  for (int bin = 0; bin < bins; ++bin) {
    const int row = geometry.nearest_on_top ? bin : bins - 1 - bin;
    for (int beam = 0; beam < beams; ++beam)
      image.value(bin, beam) = picture.value(row, from_right ? beams - 1 - beam : beam);
  }
  return image;
}

}  // namespace

ImageGeometry ReadImageGeometry(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.At("format").Word(JsonWords<bool, 1>{{{"sonar-image-geometry/1", true}}});
  ImageGeometry geometry;
  if (const auto name = json.Find("name")) geometry.name = name->String();
  json.Update("frequency_hz", geometry.frequency_hz, NumberRange::AboveUpTo(0.0, 1e8));
  json.Update("sound_speed_m_per_s", geometry.sound_speed_m_per_s, NumberRange::Between(1300.0, 1700.0));
  geometry.range_min_m = json.At("range_min_m").Number(NumberRange::Between(0.0, kMostRangeM));
  geometry.range_max_m = json.At("range_max_m").Number(NumberRange::AboveUpTo(0.0, kMostRangeM));
  if (geometry.range_max_m <= geometry.range_min_m)
    json.At("range_max_m").Fail("is not beyond range_min_m, expected a window");
  const auto polar = json.Find("polar");
  const auto fan = json.Find("fan");
  if (polar.has_value() == fan.has_value()) json.Fail("has both 'polar' and 'fan', or neither, expected one");
  polar ? ReadPolar(*polar, geometry) : ReadFan(*fan, geometry);
  json.Finish();
  return geometry;
}

PolarImage PolarFromPicture(const RosPicture& picture, const ImageGeometry& geometry,
                            const std::string& where) {
  PolarImage image =
      geometry.is_fan ? SampleFan(picture, geometry, where) : TurnPolar(picture, geometry, where);
  image.scale.full_scale = picture.full_scale;
  image.axes.Validate(where);
  return image;
}

}  // namespace sonarcal
