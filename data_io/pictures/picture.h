// Pictures for people: grey values through a perceptually uniform colour map, the superimposed images of Park
// 2024 Figs. 11c and 12c, and the object regions of its Fig. 13.
//
// Every function takes a grid of values or masks, polar or fan alike, and makes a picture of the same shape;
// StretchPolar then gives a polar picture (128 x 780, say) a shape that can be read. Outside the fan, where
// `inside` (same shape; null: everywhere) is 0, a picture is kOutsideColor.
//
// Two images are told apart by blue (real) and orange (simulated), which colour-blind readers keep apart, and
// which add up to grey: where the two agree, no colour is seen.
#pragma once

#include <array>
#include <cstdint>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/rgb_image.h"

namespace sonarcal::data_io {

using Rgb = std::array<std::uint8_t, 3>;

inline constexpr Rgb kOutsideColor = {255, 255, 255};
// Object regions, after Okabe and Ito's palette.
inline constexpr Rgb kRealOnlyColor = {0, 114, 178};
inline constexpr Rgb kSimulatedOnlyColor = {230, 159, 0};
inline constexpr Rgb kBothColor = {235, 235, 235};
inline constexpr Rgb kNeitherColor = {30, 30, 30};
inline constexpr double kAlikeGrey = 226.0;  // of a difference of 0

enum class ColorMap { kGrey, kViridis, kInferno };

// The values that the colour map starts and ends at; values beyond are shown as the nearer end, NaN as the
// lower one.
struct ValueWindow {
  double low = 0.0;
  double high = 255.0;
};

// Throws DataError where the window is not finite with low < high.
RgbImage Colorize(const Grid<float>& value, const ValueWindow& window, ColorMap map = ColorMap::kInferno,
                  const Mask* inside = nullptr);

// Windows 0 .. full_scale for grey images; lowest .. highest finite value for any other quantity.
RgbImage Colorize(const PolarImage& image, ColorMap map = ColorMap::kInferno);
RgbImage Colorize(const FanImage& image, ColorMap map = ColorMap::kInferno);

// Real in blue (0, 1/2, 1) plus simulated in orange (1, 1/2, 0). Equal values are grey, to the digit.
RgbImage Superimpose(const Grid<float>& real, const Grid<float>& simulated, const ValueWindow& window,
                     const Mask* inside = nullptr);

// Which pixels belong to the object in both images, in the real one alone, in the simulated one alone.
RgbImage OverlayRegions(const Mask& real, const Mask& simulated, const Mask* inside = nullptr);

// Signed values, blue below 0 and orange above, full colour at `limit` and beyond, light grey at 0; NaN is
// kOutsideColor. Throws DataError where the limit is not finite and positive.
RgbImage Diverging(const Grid<float>& value, double limit);

// Repeats rows and columns a whole number of times, so that a pixel stays a crisp block: the height becomes
// at least `min_height_px`, the width about three quarters of the height. Never leaves pixels out.
RgbImage StretchPolar(const RgbImage& picture, int min_height_px = 480);

// The picture no wider than `max_width_px`, by the mean over areas; one that is narrower stays as it is.
RgbImage Shrink(const RgbImage& picture, int max_width_px);

}  // namespace sonarcal::data_io
