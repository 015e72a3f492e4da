#include "data_io/pictures/picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace sonarcal::data_io {
namespace {

using Palette = std::array<Rgb, 256>;

Palette MakePalette(ColorMap map) {
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
  cv::Mat colors;
  switch (map) {
    case ColorMap::kGrey:
      cv::cvtColor(ramp, colors, cv::COLOR_GRAY2BGR);
      break;
    case ColorMap::kViridis:
      cv::applyColorMap(ramp, colors, cv::COLORMAP_VIRIDIS);
      break;
    case ColorMap::kInferno:
      cv::applyColorMap(ramp, colors, cv::COLORMAP_INFERNO);
      break;
  }
  Palette palette;
  for (int i = 0; i < 256; ++i) {
    const cv::Vec3b bgr = colors.at<cv::Vec3b>(0, i);
    palette[i] = {bgr[2], bgr[1], bgr[0]};
  }
  return palette;
}

// Position of a value in the window, 0..1.
double Place(double value, const ValueWindow& window) {
  const double place = (value - window.low) / (window.high - window.low);
  return place > 0.0 ? std::min(place, 1.0) : 0.0;  // NaN compares false
}

std::uint8_t Byte(double place) {
  return static_cast<std::uint8_t>(std::lround(255.0 * place));
}

void CheckWindow(const ValueWindow& window) {
  if (!(std::isfinite(window.low) && std::isfinite(window.high) && window.low < window.high)) {
    throw DataError("a picture of the values {} .. {}, expected a finite lower end below a finite upper one",
                    window.low, window.high);
  }
}

template <typename A, typename B>
void CheckSameShape(const Grid<A>& a, const Grid<B>& b) {
  SONARCAL_CHECK(a.rows() == b.rows() && a.cols() == b.cols(), "{} x {} and {} x {}", a.rows(), a.cols(),
                 b.rows(), b.cols());
}

// Picture with color(i) as pixel i inside, kOutsideColor outside.
template <typename Color>
RgbImage Paint(int rows, int cols, const Mask* inside, Color color) {
  RgbImage picture(rows, cols, kOutsideColor);
  if (inside != nullptr) CheckSameShape(picture, *inside);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (inside == nullptr || inside->values()[i] != 0) picture.values()[i] = color(i);
  }
  return picture;
}

ValueWindow WindowOf(const ImageScale& scale, const Grid<float>& value, const Mask* inside) {
  if (scale.quantity == Quantity::kGrey) return {0.0, scale.full_scale};
  ValueWindow window{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (inside != nullptr && inside->values()[i] == 0) continue;
    const double v = value.values()[i];
    if (!std::isfinite(v)) continue;
    window.low = std::min(window.low, v);
    window.high = std::max(window.high, v);
  }
  // Without any contrast all pixels get the colour of the lower end.
  if (!(window.low <= window.high)) return {0.0, 1.0};
  if (window.low == window.high) window.high = window.low + 1.0;
  return window;
}

}  // namespace

RgbImage Colorize(const Grid<float>& value, const ValueWindow& window, ColorMap map, const Mask* inside) {
  CheckWindow(window);
  const Palette palette = MakePalette(map);
  return Paint(value.rows(), value.cols(), inside,
               [&](std::size_t i) { return palette[Byte(Place(value.values()[i], window))]; });
}

RgbImage Colorize(const PolarImage& image, ColorMap map) {
  return Colorize(image.value, WindowOf(image.scale, image.value, nullptr), map);
}

RgbImage Colorize(const FanImage& image, ColorMap map) {
  return Colorize(image.value, WindowOf(image.scale, image.value, &image.inside), map, &image.inside);
}

RgbImage Superimpose(const Grid<float>& real, const Grid<float>& simulated, const ValueWindow& window,
                     const Mask* inside) {
  CheckWindow(window);
  CheckSameShape(real, simulated);
  return Paint(real.rows(), real.cols(), inside, [&](std::size_t i) -> Rgb {
    const double r = Place(real.values()[i], window);
    const double s = Place(simulated.values()[i], window);
    return {Byte(s), Byte(0.5 * (r + s)), Byte(r)};
  });
}

RgbImage Diverging(const Grid<float>& value, double limit) {
  CheckWindow({0.0, limit});
  return Paint(value.rows(), value.cols(), nullptr, [&](std::size_t i) -> Rgb {
    const double v = value.values()[i];
    if (std::isnan(v)) return kOutsideColor;
    const double part = std::min(1.0, std::abs(v) / limit);
    const Rgb& end = v < 0.0 ? kRealOnlyColor : kSimulatedOnlyColor;
    Rgb colour;
    for (std::size_t k = 0; k < colour.size(); ++k) {
      colour[k] = static_cast<std::uint8_t>(std::lround(kAlikeGrey + part * (end[k] - kAlikeGrey)));
    }
    return colour;
  });
}

RgbImage OverlayRegions(const Mask& real, const Mask& simulated, const Mask* inside) {
  CheckSameShape(real, simulated);
  return Paint(real.rows(), real.cols(), inside, [&](std::size_t i) {
    const bool in_real = real.values()[i] != 0;
    const bool in_simulated = simulated.values()[i] != 0;
    if (in_real && in_simulated) return kBothColor;
    if (in_real) return kRealOnlyColor;
    return in_simulated ? kSimulatedOnlyColor : kNeitherColor;
  });
}

RgbImage StretchPolar(const RgbImage& picture, int min_height_px) {
  if (picture.empty()) return {};
  const int row_repeat = std::max(1, (min_height_px + picture.rows() - 1) / picture.rows());
  const int height_px = picture.rows() * row_repeat;
  constexpr double kMaxPixels = 1 << 24;
  const double width_px = std::min(0.75 * height_px, kMaxPixels / height_px);
  const int col_repeat = std::max(1, static_cast<int>(std::lround(width_px / picture.cols())));
  RgbImage stretched(height_px, picture.cols() * col_repeat);
  for (int row = 0; row < stretched.rows(); ++row) {
    for (int col = 0; col < stretched.cols(); ++col) {
      stretched(row, col) = picture(row / row_repeat, col / col_repeat);
    }
  }
  return stretched;
}

RgbImage Shrink(const RgbImage& picture, int max_width_px) {
  SONARCAL_CHECK(max_width_px > 0, "a width of {} pixels", max_width_px);
  if (picture.cols() <= max_width_px) return picture;
  const int height_px = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(picture.rows()) * max_width_px / picture.cols())));
  cv::Mat large(picture.rows(), picture.cols(), CV_8UC3);
  std::memcpy(large.data, picture.values().data(), 3 * picture.size());
  cv::Mat small;
  cv::resize(large, small, {max_width_px, height_px}, 0.0, 0.0, cv::INTER_AREA);
  RgbImage shrunk(height_px, max_width_px);
  std::memcpy(shrunk.values().data(), small.data, 3 * shrunk.size());
  return shrunk;
}

}  // namespace sonarcal::data_io
