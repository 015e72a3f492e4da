// Pictures for viewing: grey values with a perceptually uniform colour map, the superimposed images of Park
// 2024 Figs. 11c and 12c, and the object regions of its Fig. 13.
//
// Every function converts a grid of values or masks, polar or fan, to a picture of the same shape.
// StretchPolar then gives a polar picture (e.g. 128 x 780) a readable shape. Outside the fan, where `inside`
// (same shape; null: everywhere) is 0, a picture has kOutsideColor.
//
// Two images are distinguished by blue (real) and orange (simulated). Colour-blind readers can distinguish
// these colours, and they add up to grey: equal values show no colour.
#pragma once

#include <array>
#include <cstdint>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/rgb_image.h"

namespace sonarcal::data_io {

using Rgb = std::array<std::uint8_t, 3>;

inline constexpr Rgb kOutsideColor = {255, 255, 255};
// Colours of object regions, after the palette of Okabe and Ito.
inline constexpr Rgb kRealOnlyColor = {0, 114, 178};
inline constexpr Rgb kSimulatedOnlyColor = {230, 159, 0};
inline constexpr Rgb kBothColor = {235, 235, 235};
inline constexpr Rgb kNeitherColor = {30, 30, 30};
inline constexpr double kAlikeGrey = 226.0;  // grey value for a difference of 0

enum class ColorMap { kGrey, kViridis, kInferno };

// Values at the start and end of the colour map. Values beyond them get the colour of the nearer end, NaN
// that of the lower end.
struct ValueWindow {
  double low = 0.0;
  double high = 255.0;
};

// Throws DataError if the window is not finite with low < high.
RgbImage Colorize(const Grid<float>& value, const ValueWindow& window, ColorMap map = ColorMap::kInferno,
                  const Mask* inside = nullptr);

// Window 0 .. full_scale for grey images, lowest .. highest finite value for other quantities.
RgbImage Colorize(const PolarImage& image, ColorMap map = ColorMap::kInferno);
RgbImage Colorize(const FanImage& image, ColorMap map = ColorMap::kInferno);

// Real image in blue (0, 1/2, 1) plus simulated image in orange (1, 1/2, 0). Equal values give exactly grey.
RgbImage Superimpose(const Grid<float>& real, const Grid<float>& simulated, const ValueWindow& window,
                     const Mask* inside = nullptr);

// Object pixels of both images, of the real one only, and of the simulated one only.
RgbImage OverlayRegions(const Mask& real, const Mask& simulated, const Mask* inside = nullptr);

// Signed values: blue below 0, orange above, full colour at `limit` and beyond, light grey at 0. NaN is
// kOutsideColor. Throws DataError if the limit is not finite and positive.
RgbImage Diverging(const Grid<float>& value, double limit);

// Repeats rows and columns an integer number of times, so a pixel stays a sharp block. The height becomes at
// least `min_height_px`, the width about three quarters of the height. The width is smaller if the picture
// would have more than 2^24 pixels. Never drops pixels.
RgbImage StretchPolar(const RgbImage& picture, int min_height_px = 480);

// Reduces the picture to at most `max_width_px` columns by area averaging. Does not change a narrower one.
RgbImage Shrink(const RgbImage& picture, int max_width_px);

}  // namespace sonarcal::data_io
