#include "apps/report/pictures/comparison_viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/types/error.h"
#include "data_io/images/image_io.h"

namespace sonarcal::report {
namespace {

constexpr std::size_t kPictureBytes = 7'500'000;
constexpr std::size_t kMinFrames = 3;

std::vector<std::uint8_t> GreyPng(const PolarImage& image) {
  Grid<std::uint8_t> grey(image.value.rows(), image.value.cols());
  std::ranges::transform(image.value.values(), grey.values().begin(), [&](float value) {
    const double level = 255.0 * value / image.scale.full_scale;
    return static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.0, 255.0)));
  });
  return data_io::EncodePng(grey);
}

std::string FigureText(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "none";
}

}  // namespace

std::size_t ViewerFrameCount(std::size_t pixels, std::size_t frames) {
  // Two pictures with one byte per pixel. That of the objects compresses to almost nothing.
  const std::size_t fitting = kPictureBytes / std::max<std::size_t>(2 * pixels, 1);
  return std::min(frames, std::max(kMinFrames, fitting));
}

ViewerFrame MakeViewerFrame(const PolarImage& real, const PolarImage& simulated,
                            const metrics::FrameMetrics& metrics, metrics::IntensityDomain domain) {
  SONARCAL_CHECK(metrics.masks.has_value(), "frame {} was compared without masks", metrics.index);
  Grid<std::uint8_t> objects(real.value.rows(), real.value.cols());
  std::ranges::transform(metrics.masks->polar_real.values(), metrics.masks->polar_simulated.values(),
                         objects.values().begin(), [](std::uint8_t in_real, std::uint8_t in_simulated) {
                           return std::uint8_t((in_real != 0 ? 1 : 0) + (in_simulated != 0 ? 2 : 0));
                         });
  return {.name = metrics.name.empty() ? fmt::format("frame {}", metrics.index)
                                       : fmt::format("frame {}: {}", metrics.index, metrics.name),
          .figures =
              fmt::format("IoU {}, intensity error {}, Ns/Nr {}", FigureText(metrics.polar.occupancy.iou()),
                          FigureText(metrics.polar.intensity.Over(domain).mean_absolute()),
                          FigureText(metrics.polar.occupancy.ns_over_nr())),
          .axes = real.axes,
          .full_scale = real.scale.full_scale,
          .real = GreyPng(real),
          .simulated = GreyPng(simulated),
          .objects = data_io::EncodePng(objects)};
}

std::string ViewerCaption(std::size_t shown, std::size_t compared) {
  return shown == compared
             ? fmt::format("All {} compared frames.", compared)
             : fmt::format(
                   "{} of the {} compared frames, evenly spread and including the best, the median and the "
                   "worst, to limit the size of the page. Figures are those of all frames.",
                   shown, compared);
}

}  // namespace sonarcal::report
