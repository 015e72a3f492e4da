#include "metrics/segmentation/region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/types/units.h"
#include "metrics/segmentation/object_region.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::MaskOf;

TEST(BoxAroundTest, TheBoundingBoxGrowsByItsMarginsAndEndsAtTheImage) {
  const Mask object = MaskOf({"......", "......", "..#...", "...#..", "......"});
  EXPECT_EQ(BoxAround(object, 0, 0), MaskOf({"......", "......", "..##..", "..##..", "......"}));
  EXPECT_EQ(BoxAround(object, 3, 1), MaskOf({".####.", ".####.", ".####.", ".####.", ".####."}));
  EXPECT_EQ(BoxAround(MaskOf({"#...", "....", "...#"}), 0, 0), Mask(3, 4, 1));
  EXPECT_EQ(BoxAround(MaskOf({"#..", "..."}), 1, 1), MaskOf({"##.", "##."}));
  EXPECT_EQ(CountSet(BoxAround(Mask(4, 4), 2, 2)), 0);
}

TEST(PixelBoxTest, ABoxWithoutRowsOrColumnsIsEmpty) {
  EXPECT_TRUE(PixelBox{}.empty());
  EXPECT_TRUE((PixelBox{.bin_begin = 3, .bin_end = 3, .beam_begin = 0, .beam_end = 2}.empty()));
  EXPECT_TRUE((PixelBox{.bin_begin = 0, .bin_end = 2, .beam_begin = 5, .beam_end = 5}.empty()));
  EXPECT_TRUE((PixelBox{.bin_begin = 0, .bin_end = 2, .beam_begin = 5, .beam_end = 4}.empty()));
  EXPECT_FALSE((PixelBox{.bin_begin = 0, .bin_end = 1, .beam_begin = 4, .beam_end = 5}.empty()));
}

TEST(DilatedTest, EachPixelGrowsByTheMargins) {
  const Mask object = MaskOf({"......", "#.....", "......", "....#.", "......"});
  EXPECT_EQ(Dilated(object, 0, 0), object);
  EXPECT_EQ(Dilated(object, 1, 0), MaskOf({"#.....", "#.....", "#...#.", "....#.", "....#."}));
  EXPECT_EQ(Dilated(object, 0, 2), MaskOf({"......", "###...", "......", "..####", "......"}));
  EXPECT_EQ(CountSet(Dilated(Mask(4, 4), 2, 2)), 0);
  EXPECT_TRUE(Dilated(Mask(), 1, 1).empty());
}

// 4 bins of 1 m from 1 m, beams at -2, -1, 0, 1, 2 degrees.
PolarAxes FiveBeams() {
  PolarAxes axes{1.0, 5.0, 4, {}};
  for (int beam = -2; beam <= 2; ++beam) axes.beam_azimuth_rad.push_back(RadFromDeg(1.0 * beam));
  return axes;
}

// Beams one degree apart lie 0.0262 m apart at 1.5 m, 0.0785 m at 4.5 m; bins are 1 m.
TEST(DilatedByMetresTest, AMarginInMetresIsMoreBeamsWhereTheObjectIsNear) {
  const Mask object = MaskOf({"..#..", ".....", ".....", "..#.."});
  EXPECT_EQ(DilatedByMetres(object, FiveBeams(), 0.0), object);
  EXPECT_EQ(DilatedByMetres(object, FiveBeams(), 0.03), MaskOf({".###.", ".....", ".....", "..#.."}));
  EXPECT_EQ(DilatedByMetres(object, FiveBeams(), 0.08), MaskOf({"#####", ".....", ".....", ".###."}));
  EXPECT_EQ(DilatedByMetres(object, FiveBeams(), 1.0), MaskOf({"#####", "#####", "#####", "#####"}));
  EXPECT_EQ(CountSet(DilatedByMetres(Mask(4, 5), FiveBeams(), 1.0)), 0);
}

// Bins of 0.25 m, beams 10 degrees apart.
TEST(DilatedByMetresTest, AMarginInMetresIsMoreBinsWhereTheyAreShort) {
  const PolarAxes axes{1.0, 2.25, 5, {RadFromDeg(-10.0), 0.0, RadFromDeg(10.0)}};
  const Mask object = MaskOf({"...", "...", ".#.", "...", "..."});
  EXPECT_EQ(DilatedByMetres(object, axes, 0.24), object);
  EXPECT_EQ(DilatedByMetres(object, axes, 0.25), MaskOf({"...", ".#.", ".#.", ".#.", "..."}));
  EXPECT_EQ(CountSet(DilatedByMetres(object, axes, 0.51)), 15);
}

TEST(InsidePolygonTest, PixelsWhoseCentresLieInside) {
  EXPECT_EQ(InsidePolygon({{2.0, -1.5}, {2.0, 1.5}, {4.0, 1.5}, {4.0, -1.5}}, FiveBeams()),
            MaskOf({".....", ".###.", ".###.", "....."}));
  // A triangle that narrows with range, either way round.
  EXPECT_EQ(InsidePolygon({{1.0, -2.5}, {1.0, 2.5}, {5.0, 0.1}}, FiveBeams()),
            MaskOf({"#####", ".###.", "..#..", "..#.."}));
  EXPECT_EQ(InsidePolygon({{5.0, 0.1}, {1.0, 2.5}, {1.0, -2.5}}, FiveBeams()),
            MaskOf({"#####", ".###.", "..#..", "..#.."}));
  // Corners at the ranges of centres: the near one counts, the far one does not.
  EXPECT_EQ(InsidePolygon({{1.5, -1.5}, {1.5, 1.5}, {3.5, 1.5}, {3.5, -1.5}}, FiveBeams()),
            MaskOf({".###.", ".###.", ".....", "....."}));
}

TEST(InsidePolygonTest, AHollowPolygonLeavesItsHollowOut) {
  // A U, open to far range.
  EXPECT_EQ(InsidePolygon({{1.0, -2.5},
                           {1.0, 2.5},
                           {5.0, 2.5},
                           {5.0, 1.5},
                           {2.0, 1.5},
                           {2.0, -1.5},
                           {5.0, -1.5},
                           {5.0, -2.5}},
                          FiveBeams()),
            MaskOf({"#####", "#...#", "#...#", "#...#"}));
}

TEST(InsidePolygonTest, TooFewCornersAndNumbersThatAreNoneAreRefused) {
  EXPECT_THROW(InsidePolygon({{1.0, 0.0}, {2.0, 0.0}}, FiveBeams()), DataError);
  EXPECT_THROW(InsidePolygon({{1.0, 0.0}, {2.0, 0.0}, {std::nan(""), 1.0}}, FiveBeams()), DataError);
}

}  // namespace
}  // namespace sonarcal::metrics
