#include "apps/comparison_viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/types/error.h"
#include "data_io/images/image_io.h"

namespace sonarcal {
namespace {

constexpr std::size_t kPictureBytes = 7'500'000;
constexpr std::size_t kFewestFrames = 3;

std::vector<std::uint8_t> GreyPng(const PolarImage& image) {
  Grid<std::uint8_t> grey(image.value.rows(), image.value.cols());
  std::ranges::transform(image.value.values(), grey.values().begin(), [&](float value) {
    const double level = 255.0 * value / image.scale.full_scale;
    return static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.0, 255.0)));
  });
  return EncodePng(grey);
}

std::string FigureText(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "none";
}

}  // namespace

std::size_t ViewerFrameCount(std::size_t pixels, std::size_t frames) {
  // Two pictures of a byte a pixel; that of the objects compresses to next to nothing.
  const std::size_t fitting = kPictureBytes / std::max<std::size_t>(2 * pixels, 1);
  return std::min(frames, std::max(kFewestFrames, fitting));
}

std::vector<int> SpreadFrames(const MetricsReport& report, const std::vector<int>& always,
                              std::size_t count) {
  std::set<int> chosen(always.begin(), always.end());
  const std::size_t frames = report.frames.size();
  // Halves, quarters, eighths ... of the recording, until there are enough.
  for (std::size_t parts = 1; parts <= 2 * frames; parts *= 2) {
    for (std::size_t i = 0; i <= parts; ++i) {
      if (chosen.size() >= count) return {chosen.begin(), chosen.end()};
      const std::size_t place = std::min(frames - 1, i * frames / parts);
      chosen.insert(report.frames[place].index);
    }
  }
  return {chosen.begin(), chosen.end()};
}

ViewerFrame MakeViewerFrame(const PolarImage& real, const PolarImage& simulated, const FrameMetrics& metrics,
                            IntensityDomain domain) {
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
          .objects = EncodePng(objects)};
}

std::string ViewerCaption(std::size_t shown, std::size_t compared) {
  return shown == compared
             ? fmt::format("All {} compared frames.", compared)
             : fmt::format(
                   "{} of the {} compared frames, spread evenly and with the best, the middle and the "
                   "worst among them: the page would be too large with all. Figures are of all frames.",
                   shown, compared);
}

}  // namespace sonarcal
