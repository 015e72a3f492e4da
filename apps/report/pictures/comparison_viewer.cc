#include "apps/report/pictures/comparison_viewer.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/sonar_picture.h"
#include "data_io/images/image_io.h"

namespace sonarcal::report {
namespace {

constexpr std::size_t kPictureBytes = 7'500'000;
constexpr std::size_t kMinFrames = 3;

}  // namespace

std::size_t ViewerFrameCount(std::size_t pixels, std::size_t frames) {
  // Two pictures with one byte per pixel. That of the objects compresses to almost nothing.
  const std::size_t fitting = kPictureBytes / std::max<std::size_t>(2 * pixels, 1);
  return std::min(frames, std::max(kMinFrames, fitting));
}

ViewerFrame MakeViewerFrame(const PolarImage& real, const PolarImage& simulated,
                            const metrics::FrameMetrics& metrics, metrics::IntensityDomain domain) {
  const std::string number = fmt::format("frame {}", metrics.index);
  return {.name = metrics.name.empty() || metrics.name == number ? number : number + ": " + metrics.name,
          .figures = fmt::format("IoU {}, intensity error {}, Ns/Nr {}",
                                 FormatNumber(metrics.polar.occupancy.iou(), 3),
                                 FormatNumber(metrics.polar.intensity.Over(domain).mean_absolute(), 3),
                                 FormatNumber(metrics.polar.occupancy.ns_over_nr(), 3)),
          .axes = real.axes,
          .full_scale = real.scale.full_scale,
          .real = GreyPng(real.value, 0.0, real.scale.full_scale),
          .simulated = GreyPng(simulated.value, 0.0, real.scale.full_scale),
          .objects = data_io::EncodePng(ObjectRegions(metrics))};
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
