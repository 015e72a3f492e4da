#include "core/imaging/fan_image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/types/units.h"

namespace sonarcal {
namespace {

constexpr double kMaxPixels = 1e8;

struct Box {
  double x_lo = std::numeric_limits<double>::infinity();
  double x_hi = -std::numeric_limits<double>::infinity();
  double y_lo = std::numeric_limits<double>::infinity();
  double y_hi = -std::numeric_limits<double>::infinity();

  void Add(double range_m, double azimuth_rad) {
    const double x = range_m * std::sin(azimuth_rad);
    const double y = range_m * std::cos(azimuth_rad);
    x_lo = std::min(x_lo, x);
    x_hi = std::max(x_hi, x);
    y_lo = std::min(y_lo, y);
    y_hi = std::max(y_hi, y);
  }
};

// Extremes of the sector lie at its corners, or where an arc crosses one of the axes.
Box BoundingBox(const PolarAxes& polar) {
  const std::vector<double> edges_rad = polar.BeamEdgesRad();
  Box box;
  for (const double range_m : {polar.range_min_m, polar.range_max_m}) {
    box.Add(range_m, edges_rad.front());
    box.Add(range_m, edges_rad.back());
  }
  for (int quarter = -4; quarter <= 4; ++quarter) {
    const double azimuth_rad = quarter * 0.5 * kPi;
    if (azimuth_rad > edges_rad.front() && azimuth_rad < edges_rad.back()) {
      box.Add(polar.range_max_m, azimuth_rad);
    }
  }
  return box;
}

// Number of pixels for a length. Rounding does not add a pixel to a length that is a whole number of pixels.
double PixelsFor(double length_m, double pixel_m) {
  return std::max(1.0, std::ceil(length_m / pixel_m - 1e-9));
}

// Direction as an angle within the beams' edges, which may reach beyond +-180 degrees.
std::optional<double> AzimuthWithin(double x_m, double y_m, const std::vector<double>& edges_rad) {
  const double principal_rad = std::atan2(x_m, y_m);
  for (const double turn_rad : {0.0, 2.0 * kPi, -2.0 * kPi}) {
    const double azimuth_rad = principal_rad + turn_rad;
    if (azimuth_rad >= edges_rad.front() && azimuth_rad <= edges_rad.back()) return azimuth_rad;
  }
  return std::nullopt;
}

}  // namespace

void FanOptions::Check() const {
  if (!(std::isfinite(pixel_m) && pixel_m >= 0.0)) {
    throw DataError("fan pixel_m is {}, expected a length in metres, or 0 to take it from the height",
                    pixel_m);
  }
  if (height_px < 0) throw DataError("fan height_px is {}, expected 0 (automatic) or more", height_px);
  if (default_max_height_px < 1) {
    throw DataError("fan default_max_height_px is {}, expected at least 1", default_max_height_px);
  }
}

FanAxes FanAxesFor(const PolarAxes& polar, const FanOptions& options) {
  options.Check();
  polar.Validate("fan image");
  const Box box = BoundingBox(polar);
  const double height_m = box.y_hi - box.y_lo;
  const double width_m = box.x_hi - box.x_lo;

  FanAxes fan;
  fan.pixel_m = options.pixel_m;
  if (fan.pixel_m == 0.0) {
    const int height_px =
        options.height_px > 0 ? options.height_px : std::min(polar.range_bins, options.default_max_height_px);
    fan.pixel_m = height_m / height_px;
  }
  const double rows = PixelsFor(height_m, fan.pixel_m);
  const double cols = PixelsFor(width_m, fan.pixel_m);
  if (rows * cols > kMaxPixels) {
    throw DataError(
        "a fan of {:.4g} x {:.4g} m in pixels of {:.4g} m would have {:.3g} pixels, expected at most {:.0g}",
        width_m, height_m, fan.pixel_m, rows * cols, kMaxPixels);
  }
  fan.rows = static_cast<int>(rows);
  fan.cols = static_cast<int>(cols);
  // The surplus width of the last column is shared between left and right, so a symmetrical fan gives a
  // symmetrical picture.
  fan.x_min_m = 0.5 * (box.x_lo + box.x_hi) - 0.5 * fan.cols * fan.pixel_m;
  fan.y_max_m = box.y_hi;
  return fan;
}

FanMap::FanMap(const PolarAxes& polar, const FanAxes& fan)
    : polar_axes_(polar), axes_(fan), inside_(fan.rows, fan.cols) {
  polar.Validate("fan image");
  const std::vector<double> edges_rad = polar.BeamEdgesRad();
  const std::vector<double>& centres_rad = polar.beam_azimuth_rad;
  const int beams = polar.beam_count();
  for (int row = 0; row < fan.rows; ++row) {
    for (int col = 0; col < fan.cols; ++col) {
      const double x_m = fan.x_m(col);
      const double y_m = fan.y_m(row);
      const double range_m = std::hypot(x_m, y_m);
      if (range_m < polar.range_min_m || range_m > polar.range_max_m) continue;
      const std::optional<double> azimuth_rad = AzimuthWithin(x_m, y_m, edges_rad);
      if (!azimuth_rad) continue;

      const double bin_position = (range_m - polar.range_centre_m(0)) / polar.range_bin_m();
      const int bin =
          std::clamp(static_cast<int>(std::floor(bin_position)), 0, std::max(0, polar.range_bins - 2));
      const auto above = std::upper_bound(centres_rad.begin(), centres_rad.end(), *azimuth_rad);
      const int beam = std::clamp(static_cast<int>(above - centres_rad.begin()) - 1, 0, beams - 2);
      const double beam_weight =
          (*azimuth_rad - centres_rad[beam]) / (centres_rad[beam + 1] - centres_rad[beam]);
      samples_.push_back({.fan_index = row * fan.cols + col,
                          .polar_index = bin * beams + beam,
                          .bin_weight = static_cast<float>(std::clamp(bin_position - bin, 0.0, 1.0)),
                          .beam_weight = static_cast<float>(std::clamp(beam_weight, 0.0, 1.0))});
      inside_(row, col) = 1;
    }
  }
}

void FanMap::CheckShape(int rows, int cols) const {
  SONARCAL_CHECK(rows == polar_axes_.range_bins && cols == polar_axes_.beam_count(),
                 "an image of {} x {} for a map of {} bins x {} beams", rows, cols, polar_axes_.range_bins,
                 polar_axes_.beam_count());
}

Grid<float> FanMap::Apply(const Grid<float>& polar) const {
  CheckShape(polar.rows(), polar.cols());
  Grid<float> fan(axes_.rows, axes_.cols);
  const int step = bin_step();
  for (const Sample& sample : samples_) {
    const float* near = &polar.values()[sample.polar_index];
    const float* far = near + step;
    const float near_value = near[0] + sample.beam_weight * (near[1] - near[0]);
    const float far_value = far[0] + sample.beam_weight * (far[1] - far[0]);
    fan.values()[sample.fan_index] = near_value + sample.bin_weight * (far_value - near_value);
  }
  return fan;
}

FanImage FanMap::Apply(const PolarImage& polar) const {
  std::string why;
  SONARCAL_CHECK(polar_axes_.Matches(polar.axes, &why), "the map was made for another geometry: {}", why);
  return {axes_, polar.scale, Apply(polar.value), inside_};
}

}  // namespace sonarcal
