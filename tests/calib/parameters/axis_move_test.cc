#include "calib/parameters/axis_move.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

PolarAxes Axes() {
  PolarAxes axes{.range_min_m = 1.0, .range_max_m = 5.0, .range_bins = 200, .beam_azimuth_rad = {}};
  for (int beam = -30; beam <= 30; ++beam) axes.beam_azimuth_rad.push_back(RadFromDeg(0.5 * beam));
  return axes;
}

// A smooth picture by true range and azimuth, recorded with a geometry.
Grid<double> Recorded(const SonarGeometry& geometry) {
  const PolarAxes axes = Corrected(Axes(), geometry);
  Grid<double> image(axes.range_bins, axes.beam_count());
  for (int bin = 0; bin < axes.range_bins; ++bin) {
    for (int beam = 0; beam < axes.beam_count(); ++beam) {
      image(bin, beam) =
          2.0 + std::sin(3.0 * axes.range_centre_m(bin)) * std::cos(8.0 * axes.beam_azimuth_rad[beam]);
    }
  }
  return image;
}

TEST(WithAxesMoved, AnImageIsThatOfTheOtherGeometry) {
  const SonarGeometry from = {.range_offset_m = 0.03, .range_scale = 1.01, .azimuth_offset_deg = -0.4};
  const SonarGeometry to = {.range_offset_m = 0.01,
                            .range_scale = 1.02,
                            .azimuth_offset_deg = 0.1,
                            .azimuth_scale = 1.03,
                            .azimuth_cubic = -0.01};
  const Grid<double> moved = WithAxesMoved(Recorded(from), Axes(), from, to);
  const Grid<double> expected = Recorded(to);
  double largest = 0.0;
  // Away from the ends, beyond which the first image holds nothing.
  for (int bin = 10; bin < 190; ++bin) {
    for (int beam = 4; beam < 57; ++beam)
      largest = std::max(largest, std::abs(moved(bin, beam) - expected(bin, beam)));
  }
  // Linear interpolation errs by an eighth of the second derivative times the squared step of the grid.
  EXPECT_LT(largest, 0.125 * (std::pow(3.0 * 0.02, 2) + std::pow(8.0 * RadFromDeg(0.5), 2)) * 1.1);
  EXPECT_GT(largest, 0.0);
}

TEST(PlacementDifference, IsHalfABinAtTheFarEndForAScale) {
  const CatalogEntry scale{
      .name = "geometry.range_scale", .unit = "1", .group = ParameterGroup::kGeometry, .index = 1};
  EXPECT_NEAR(PlacementDifference(Axes(), scale) * 5.0, 0.01, 1e-12);
}

}  // namespace
}  // namespace sonarcal::calib
