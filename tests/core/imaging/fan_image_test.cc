#include "core/imaging/fan_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/types/units.h"

namespace sonarcal {
namespace {

using ::testing::HasSubstr;

// 61 beams over about 90 degrees, crowded in the middle, as real tables are.
PolarAxes UnevenAxes() {
  PolarAxes axes{1.0, 5.0, 200, {}};
  for (int beam = -30; beam <= 30; ++beam) {
    const double t = beam / 30.0;
    axes.beam_azimuth_rad.push_back(RadFromDeg(40.0 * t + 5.0 * t * t * t));
  }
  return axes;
}

PolarImage MakeImage(const PolarAxes& axes, const std::function<double(double, double)>& value) {
  PolarImage image{axes, {}, Grid<float>(axes.range_bins, axes.beam_count())};
  for (int bin = 0; bin < axes.range_bins; ++bin) {
    for (int beam = 0; beam < axes.beam_count(); ++beam) {
      image.value(bin, beam) =
          static_cast<float>(value(axes.range_centre_m(bin), axes.beam_azimuth_rad[beam]));
    }
  }
  return image;
}

// Calls visit(row, col, range_m, azimuth_rad) for each pixel inside the fan.
template <typename Visit>
void ForEachInside(const FanImage& fan, Visit visit) {
  for (int row = 0; row < fan.axes.rows; ++row) {
    for (int col = 0; col < fan.axes.cols; ++col) {
      if (fan.inside(row, col) == 0) continue;
      const double x_m = fan.axes.x_m(col);
      const double y_m = fan.axes.y_m(row);
      visit(row, col, std::hypot(x_m, y_m), std::atan2(x_m, y_m));
    }
  }
}

TEST(FanAxesTest, HeightIsTheNumberOfRangeBinsUpToTheLimit) {
  PolarAxes axes = UnevenAxes();
  EXPECT_EQ(FanAxesFor(axes).rows, 200);
  axes.range_bins = 5000;
  EXPECT_EQ(FanAxesFor(axes).rows, 800);
  EXPECT_EQ(FanAxesFor(axes, {.height_px = 1234}).rows, 1234);
}

TEST(FanAxesTest, TheGridHoldsTheWholeSectorAndNoMore) {
  const PolarAxes axes = UnevenAxes();
  const FanAxes fan = FanAxesFor(axes, {.pixel_m = 0.01});
  const double edge_rad = axes.BeamEdgesRad().back();
  EXPECT_NEAR(fan.y_max_m, 5.0, 1e-12);
  EXPECT_NEAR(fan.x_min_m, -5.0 * std::sin(edge_rad), 0.01);
  EXPECT_NEAR(fan.cols * 0.01, 2.0 * 5.0 * std::sin(edge_rad), 0.01);
  EXPECT_NEAR(fan.rows * 0.01, 5.0 - 1.0 * std::cos(edge_rad), 0.01);
}

TEST(FanAxesTest, ASectorWiderThanAHalfCircleReachesBehind) {
  const PolarAxes axes{
      1.0, 2.0, 50, {RadFromDeg(-120.0), RadFromDeg(-60.0), RadFromDeg(60.0), RadFromDeg(120.0)}};
  const FanAxes fan = FanAxesFor(axes, {.pixel_m = 0.01});  // edges at +-150 degrees
  EXPECT_EQ(fan.cols, 400);
  EXPECT_NEAR(fan.y_m(fan.rows - 1), -2.0 * std::cos(RadFromDeg(30.0)), 0.01);
}

TEST(FanAxesTest, AnAbsurdPixelIsRefusedByName) {
  EXPECT_THROW(FanAxesFor(UnevenAxes(), {.pixel_m = 1e-6}), DataError);
  try {
    FanAxesFor(UnevenAxes(), {.pixel_m = -1.0});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("pixel_m is -1"));
  }
}

TEST(FanMapTest, MaskAreaIsTheSectorsArea) {
  const PolarAxes axes = UnevenAxes();
  const FanMap map(axes, FanOptions{.height_px = 400});
  const std::vector<double> edges_rad = axes.BeamEdgesRad();
  const double sector_m2 = 0.5 * (edges_rad.back() - edges_rad.front()) * (5.0 * 5.0 - 1.0 * 1.0);
  const double mask_m2 =
      static_cast<double>(CountSet(map.inside())) * map.axes().pixel_m * map.axes().pixel_m;
  EXPECT_NEAR(mask_m2 / sector_m2, 1.0, 0.003);
}

TEST(FanMapTest, AFullCircleHasNoSeam) {
  PolarAxes axes{0.0, 2.0, 40, {}};
  for (int beam = 0; beam < 72; ++beam) axes.beam_azimuth_rad.push_back(RadFromDeg(-180.0 + 5.0 * beam));
  const FanMap map(axes, FanOptions{.pixel_m = 0.02});
  const double mask_m2 = static_cast<double>(CountSet(map.inside())) * 0.02 * 0.02;
  EXPECT_NEAR(mask_m2 / (kPi * 4.0), 1.0, 0.003);
}

TEST(FanMapTest, AConstantImageStaysConstantInside) {
  const FanMap map(UnevenAxes());
  const FanImage fan = map.Apply(MakeImage(UnevenAxes(), [](double, double) { return 77.0; }));
  for (int row = 0; row < fan.axes.rows; ++row) {
    for (int col = 0; col < fan.axes.cols; ++col) {
      ASSERT_EQ(fan.value(row, col), fan.inside(row, col) ? 77.0f : 0.0f) << row << ", " << col;
    }
  }
}

TEST(FanMapTest, AnImageLinearInRangeAndAzimuthIsReproduced) {
  const PolarAxes axes = UnevenAxes();
  const auto linear = [](double range_m, double azimuth_rad) { return 10.0 * range_m + 20.0 * azimuth_rad; };
  const FanImage fan = FanMap(axes).Apply(MakeImage(axes, linear));
  int compared = 0;
  ForEachInside(fan, [&](int row, int col, double range_m, double azimuth_rad) {
    // Half a bin and half a beam at the border hold the outermost value.
    const double held_range_m = std::clamp(range_m, axes.range_centre_m(0), axes.range_centre_m(199));
    const double held_azimuth_rad =
        std::clamp(azimuth_rad, axes.beam_azimuth_rad.front(), axes.beam_azimuth_rad.back());
    ASSERT_NEAR(fan.value(row, col), linear(held_range_m, held_azimuth_rad), 1e-4) << row << ", " << col;
    ++compared;
  });
  EXPECT_GT(compared, 10000);
}

TEST(FanMapTest, ABrightSpotLandsWhereItsRangeAndAzimuthSay) {
  const PolarAxes axes = UnevenAxes();
  const FanMap map(axes, FanOptions{.height_px = 400});
  for (const auto& [bin, beam] : {std::pair{150, 50}, std::pair{150, 10}, std::pair{20, 30}}) {
    PolarImage image{axes, {}, Grid<float>(200, 61)};
    image.value(bin, beam) = 100.0f;
    const FanImage fan = map.Apply(image);
    double mass = 0.0, x_m = 0.0, y_m = 0.0;
    ForEachInside(fan, [&](int row, int col, double, double) {
      mass += fan.value(row, col);
      x_m += fan.value(row, col) * fan.axes.x_m(col);
      y_m += fan.value(row, col) * fan.axes.y_m(row);
    });
    const double range_m = axes.range_centre_m(bin);
    const double azimuth_rad = axes.beam_azimuth_rad[beam];
    EXPECT_NEAR(x_m / mass, range_m * std::sin(azimuth_rad), 0.01);
    EXPECT_NEAR(y_m / mass, range_m * std::cos(azimuth_rad), 0.01);
  }
}

TEST(FanMapTest, PositiveAzimuthIsOnTheRight) {
  const PolarAxes axes = UnevenAxes();
  const FanImage fan =
      FanMap(axes).Apply(MakeImage(axes, [](double, double azimuth) { return azimuth > 0.3 ? 1.0 : 0.0; }));
  ForEachInside(fan, [&](int row, int col, double, double) {
    if (fan.value(row, col) > 0.0f) {
      ASSERT_GT(col, fan.axes.cols / 2);
    }
  });
}

// The slow, obvious way: walk over all bins and beams and ask which cell holds the pixel.
TEST(FanMapTest, NearestTakesTheCellThePixelLiesIn) {
  const PolarAxes axes{0.5, 2.0, 7, {RadFromDeg(-20.0), RadFromDeg(-5.0), RadFromDeg(1.0), RadFromDeg(30.0)}};
  Grid<int> cells(7, 4);
  for (int i = 0; i < 28; ++i) cells.values()[i] = i;
  const FanMap map(axes, FanOptions{.pixel_m = 0.013});
  const Grid<int> fan = map.ApplyNearest(cells, -1);
  const std::vector<double> edges_rad = axes.BeamEdgesRad();
  for (int row = 0; row < map.axes().rows; ++row) {
    for (int col = 0; col < map.axes().cols; ++col) {
      const double range_m = std::hypot(map.axes().x_m(col), map.axes().y_m(row));
      const double azimuth_rad = std::atan2(map.axes().x_m(col), map.axes().y_m(row));
      int expected = -1;
      for (int bin = 0; bin < 7; ++bin) {
        for (int beam = 0; beam < 4; ++beam) {
          if (std::abs(range_m - axes.range_centre_m(bin)) < 0.5 * axes.range_bin_m() &&
              azimuth_rad > edges_rad[beam] && azimuth_rad < edges_rad[beam + 1]) {
            expected = bin * 4 + beam;
          }
        }
      }
      ASSERT_EQ(fan(row, col), expected) << row << ", " << col;
    }
  }
}

TEST(FanMapTest, ASingleRangeBinIsEnough) {
  const PolarAxes axes{1.0, 2.0, 1, {-0.1, 0.1}};
  const FanImage fan =
      FanMap(axes, FanOptions{.pixel_m = 0.02}).Apply(MakeImage(axes, [](double, double) { return 5.0; }));
  ForEachInside(fan, [&](int row, int col, double, double) { ASSERT_EQ(fan.value(row, col), 5.0f); });
}

TEST(FanMapTest, AnImageOfAnotherShapeIsAProgrammersMistake) {
  const FanMap map(UnevenAxes());
  EXPECT_THROW(map.Apply(Grid<float>(3, 3)), std::logic_error);
}

}  // namespace
}  // namespace sonarcal
