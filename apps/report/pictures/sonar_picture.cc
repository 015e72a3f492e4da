#include "apps/report/pictures/sonar_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/imaging/fan_image.h"
#include "core/types/error.h"
#include "data_io/images/image_io.h"

namespace sonarcal::report {
namespace {

constexpr int kFanHeightPx = 480;

FanMap MapOf(const PolarAxes& axes) {
  return FanMap(axes, FanOptions{.height_px = kFanHeightPx});
}

struct Window {
  double low = 0.0;
  double high = 1.0;
  std::string name;
};

Window WindowOf(const PolarImage& image, const std::optional<ColourLimits>& limits) {
  const std::string name = image.scale.quantity == Quantity::kGrey      ? "grey level"
                           : image.scale.quantity == Quantity::kDecibel ? "dB"
                                                                        : "power";
  if (limits) return {limits->low, limits->high, name};
  if (image.scale.quantity == Quantity::kGrey) return {0.0, image.scale.full_scale, name};
  Window window{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), name};
  for (const float value : image.value.values()) {
    if (!std::isfinite(value)) continue;
    window.low = std::min<double>(window.low, value);
    window.high = std::max<double>(window.high, value);
  }
  if (!(window.low < window.high)) return {0.0, 1.0, window.name};
  return window;
}

std::vector<std::uint8_t> PngOf(const PolarImage& image, SonarView view, const Window& window) {
  if (view == SonarView::kPolar) return GreyPng(image.value, window.low, window.high);
  return GreyPng(MapOf(image.axes).Apply(image.value), window.low, window.high);
}

}  // namespace

std::vector<std::uint8_t> GreyPng(const Grid<float>& value, double low, double high) {
  Grid<std::uint8_t> grey(value.rows(), value.cols());
  std::ranges::transform(value.values(), grey.values().begin(), [&](float v) {
    const double level = 255.0 * (v - low) / (high - low);
    return level > 0.0 ? static_cast<std::uint8_t>(std::lround(std::min(level, 255.0))) : std::uint8_t{0};
  });
  return data_io::EncodePng(grey);
}

Grid<std::uint8_t> ObjectRegions(const metrics::FrameMetrics& metrics) {
  SONARCAL_CHECK(metrics.masks.has_value(), "frame {} was compared without masks", metrics.index);
  const metrics::FrameMasks& masks = *metrics.masks;
  Grid<std::uint8_t> regions(masks.polar_real.rows(), masks.polar_real.cols());
  std::ranges::transform(masks.polar_real.values(), masks.polar_simulated.values(), regions.values().begin(),
                         [](std::uint8_t in_real, std::uint8_t in_simulated) {
                           return std::uint8_t((in_real != 0 ? 1 : 0) + (in_simulated != 0 ? 2 : 0));
                         });
  return regions;
}

Picture SonarPicture(const PolarImage& image, SonarView view, std::string caption, std::string alt,
                     const std::optional<ColourLimits>& limits) {
  const Window window = WindowOf(image, limits);
  return {.png = PngOf(image, view, window),
          .caption = std::move(caption),
          .alt = std::move(alt),
          .plot = SonarPlot{
              .axes = image.axes,
              .view = view,
              .colours = SonarColours::kInferno,
              .bar = {fmt::format("{:.4g}", window.low), window.name, fmt::format("{:.5g}", window.high)}}};
}

Picture OverlayPicture(const PolarImage& real_image, const PolarImage& simulated, SonarView view,
                       const std::string& real, std::string alt) {
  return {.png = PngOf(real_image, view, WindowOf(real_image, {})),
          .caption = "Overlay",
          .alt = std::move(alt),
          .plot = SonarPlot{.axes = real_image.axes,
                            .view = view,
                            .colours = SonarColours::kOverlay,
                            .simulated = PngOf(simulated, view, WindowOf(simulated, {})),
                            .bar = {real, "← brighter →", "simulated"}}};
}

Picture RegionsPicture(const PolarAxes& axes, const Grid<std::uint8_t>& regions, SonarView view,
                       std::string alt) {
  return {.png = data_io::EncodePng(view == SonarView::kPolar ? regions : MapOf(axes).ApplyNearest(regions)),
          .caption = "Object regions",
          .alt = std::move(alt),
          .plot = SonarPlot{.axes = axes, .view = view, .colours = SonarColours::kRegions}};
}

}  // namespace sonarcal::report
