#include "data_io/pictures/picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonarcal::data_io {
namespace {

Grid<float> Row(std::initializer_list<float> values) {
  Grid<float> grid(1, static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), grid.values().begin());
  return grid;
}

Mask MaskRow(std::initializer_list<std::uint8_t> values) {
  Mask mask(1, static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), mask.values().begin());
  return mask;
}

double Luminance(const Rgb& color) {
  const auto linear = [](double byte) { return std::pow(byte / 255.0, 2.2); };
  return 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
}

TEST(ColorizeTest, GreyMapIsTheValueItself) {
  const RgbImage picture = Colorize(Row({0.0f, 100.0f, 255.0f}), {0.0, 255.0}, ColorMap::kGrey);
  EXPECT_EQ(picture(0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(picture(0, 1), (Rgb{100, 100, 100}));
  EXPECT_EQ(picture(0, 2), (Rgb{255, 255, 255}));
}

TEST(ColorizeTest, ValuesBeyondTheWindowAreShownAsItsEndsAndNaNAsTheLower) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const RgbImage picture = Colorize(Row({-5.0f, 1e9f, nan}), {0.0, 10.0}, ColorMap::kGrey);
  EXPECT_EQ(picture(0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(picture(0, 1), (Rgb{255, 255, 255}));
  EXPECT_EQ(picture(0, 2), (Rgb{0, 0, 0}));
}

TEST(ColorizeTest, BrighterValuesAreNeverDarkerColors) {
  Grid<float> ramp(1, 256);
  for (int i = 0; i < 256; ++i) ramp(0, i) = static_cast<float>(i);
  for (const ColorMap map : {ColorMap::kGrey, ColorMap::kViridis, ColorMap::kInferno}) {
    const RgbImage picture = Colorize(ramp, {0.0, 255.0}, map);
    for (int i = 1; i < 256; ++i) {
      ASSERT_GE(Luminance(picture(0, i)), Luminance(picture(0, i - 1)) - 0.01) << i;
    }
    EXPECT_GT(Luminance(picture(0, 255)) - Luminance(picture(0, 0)), 0.6);
  }
}

TEST(ColorizeTest, ViridisRunsFromPurpleToYellow) {
  const RgbImage picture = Colorize(Row({0.0f, 1.0f}), {0.0, 1.0}, ColorMap::kViridis);
  EXPECT_GT(picture(0, 0)[2], picture(0, 0)[1]);  // blue above green
  EXPECT_GT(picture(0, 1)[0], 200);               // red and green high, blue low
  EXPECT_GT(picture(0, 1)[1], 200);
  EXPECT_LT(picture(0, 1)[2], 100);
}

TEST(ColorizeTest, OutsideTheFanIsNeutral) {
  const FanImage fan{{1, 2, 0.1, 0.0, 1.0}, {}, Row({255.0f, 0.0f}), MaskRow({1, 0})};
  const RgbImage picture = Colorize(fan, ColorMap::kGrey);
  EXPECT_EQ(picture(0, 0), (Rgb{255, 255, 255}));
  EXPECT_EQ(picture(0, 1), kOutsideColor);
}

TEST(ColorizeTest, ADepthImageIsStretchedOverItsFiniteValues) {
  PolarImage depth;
  depth.value = Row({2.0f, std::numeric_limits<float>::infinity(), 4.0f});
  depth.scale.quantity = Quantity::kDepth;
  const RgbImage picture = Colorize(depth, ColorMap::kGrey);
  EXPECT_EQ(picture(0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(picture(0, 2), (Rgb{255, 255, 255}));
}

TEST(ColorizeTest, AnEmptyWindowIsRefused) {
  EXPECT_THROW(Colorize(Row({1.0f}), {5.0, 5.0}), DataError);
  EXPECT_THROW(Colorize(Row({1.0f}), {0.0, std::numeric_limits<double>::infinity()}), DataError);
}

TEST(DivergingTest, BlueBelowOrangeAboveAndGreyBetween) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const RgbImage picture = Diverging(Row({-2.0f, -1.0f, 0.0f, 0.5f, 1.0f, nan}), 1.0);
  EXPECT_EQ(picture(0, 0), kRealOnlyColor);
  EXPECT_EQ(picture(0, 1), kRealOnlyColor);
  EXPECT_EQ(picture(0, 2), (Rgb{226, 226, 226}));
  EXPECT_EQ(picture(0, 3), (Rgb{228, 193, 113}));  // halfway to orange
  EXPECT_EQ(picture(0, 4), kSimulatedOnlyColor);
  EXPECT_EQ(picture(0, 5), kOutsideColor);
  EXPECT_THROW(Diverging(Row({0.0f}), 0.0), DataError);
}

TEST(ShrinkTest, KeepsTheMeanAndTheShape) {
  RgbImage picture(4, 8);
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 8; ++col) {
      picture(row, col) = {static_cast<std::uint8_t>(10 * col), static_cast<std::uint8_t>(row < 2 ? 0 : 200),
                           7};
    }
  }
  const RgbImage half = Shrink(picture, 4);
  ASSERT_EQ(half.rows(), 2);
  ASSERT_EQ(half.cols(), 4);
  EXPECT_EQ(half(0, 0), (Rgb{5, 0, 7}));
  EXPECT_EQ(half(1, 3), (Rgb{65, 200, 7}));
  EXPECT_TRUE(std::ranges::equal(Shrink(picture, 8).values(), picture.values()));
}

TEST(SuperimposeTest, AgreementHasNoColorAndEachImageItsOwn) {
  const RgbImage picture = Superimpose(Row({80.0f, 200.0f, 0.0f}), Row({80.0f, 0.0f, 200.0f}), {0.0, 255.0});
  EXPECT_EQ(picture(0, 0), (Rgb{80, 80, 80}));
  EXPECT_EQ(picture(0, 1), (Rgb{0, 100, 200}));  // real alone: blue
  EXPECT_EQ(picture(0, 2), (Rgb{200, 100, 0}));  // simulated alone: orange
}

TEST(SuperimposeTest, SwappingTheImagesSwapsRedAndBlue) {
  const Grid<float> a = Row({10.0f, 130.0f, 255.0f});
  const Grid<float> b = Row({60.0f, 20.0f, 0.0f});
  const RgbImage ab = Superimpose(a, b, {0.0, 255.0});
  const RgbImage ba = Superimpose(b, a, {0.0, 255.0});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ab(0, i), (Rgb{ba(0, i)[2], ba(0, i)[1], ba(0, i)[0]}));
}

TEST(OverlayRegionsTest, EachKindOfPixelHasItsColor) {
  const Mask inside = MaskRow({1, 1, 1, 1, 0});
  const RgbImage picture = OverlayRegions(MaskRow({1, 1, 0, 0, 1}), MaskRow({1, 0, 1, 0, 1}), &inside);
  EXPECT_EQ(picture(0, 0), kBothColor);
  EXPECT_EQ(picture(0, 1), kRealOnlyColor);
  EXPECT_EQ(picture(0, 2), kSimulatedOnlyColor);
  EXPECT_EQ(picture(0, 3), kNeitherColor);
  EXPECT_EQ(picture(0, 4), kOutsideColor);
}

TEST(StretchPolarTest, ANarrowImageBecomesReadableAndKeepsItsPixels) {
  RgbImage narrow(780, 128);
  narrow(779, 127) = {1, 2, 3};
  const RgbImage wide = StretchPolar(narrow);
  EXPECT_EQ(wide.rows(), 780);
  EXPECT_EQ(wide.cols(), 128 * 5);
  EXPECT_EQ(wide(779, 128 * 5 - 1), (Rgb{1, 2, 3}));
  EXPECT_EQ(wide(779, 127 * 5), (Rgb{1, 2, 3}));
  EXPECT_EQ(wide(779, 127 * 5 - 1), (Rgb{0, 0, 0}));
}

TEST(StretchPolarTest, AShortImageGrowsAndAnEmptyOneStays) {
  const RgbImage tall = StretchPolar(RgbImage(150, 106));
  EXPECT_EQ(tall.rows(), 600);
  EXPECT_EQ(tall.cols(), 424);
  EXPECT_TRUE(StretchPolar(RgbImage()).empty());
}

// Sixteen beams of a long window: three quarters of the height would be a picture of 600 MB.
TEST(StretchPolarTest, ALongWindowOfFewBeamsStaysSmall) {
  const RgbImage stretched = StretchPolar(RgbImage(16384, 16));
  EXPECT_EQ(stretched.rows(), 16384);
  EXPECT_EQ(stretched.cols(), 1024);
}

}  // namespace
}  // namespace sonarcal::data_io
