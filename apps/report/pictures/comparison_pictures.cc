#include "apps/report/pictures/comparison_pictures.h"

#include <fmt/format.h>

#include "core/imaging/fan_image.h"
#include "core/types/error.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {

void WritePictures(const std::filesystem::path& folder, const PolarImage& real, const PolarImage& simulated,
                   const metrics::FrameMetrics& metrics) {
  SONARCAL_CHECK(metrics.masks.has_value(), "frame {} was compared without masks", metrics.index);
  constexpr int kHeightPx = 480;
  const metrics::FrameMasks& masks = *metrics.masks;
  const data_io::ValueWindow window{0.0, real.scale.full_scale};
  const auto polar = [&](const char* what, const RgbImage& picture) {
    data_io::WritePng(folder / fmt::format("frame_{:04}_polar_{}.png", metrics.index, what),
                      data_io::StretchPolar(picture, kHeightPx));
  };
  polar("real", data_io::Colorize(real.value, window));
  polar("simulated", data_io::Colorize(simulated.value, window));
  polar("overlay", data_io::Superimpose(real.value, simulated.value, window));
  polar("regions", data_io::OverlayRegions(masks.polar_real, masks.polar_simulated));

  const FanMap map(real.axes, FanOptions{.height_px = kHeightPx});
  const Mask* inside = &map.inside();
  const Grid<float> real_fan = map.Apply(real.value);
  const Grid<float> simulated_fan = map.Apply(simulated.value);
  const auto fan = [&](const char* what, const RgbImage& picture) {
    data_io::WritePng(folder / fmt::format("frame_{:04}_fan_{}.png", metrics.index, what), picture);
  };
  fan("real", data_io::Colorize(real_fan, window, data_io::ColorMap::kInferno, inside));
  fan("simulated", data_io::Colorize(simulated_fan, window, data_io::ColorMap::kInferno, inside));
  fan("overlay", data_io::Superimpose(real_fan, simulated_fan, window, inside));
  fan("regions", data_io::OverlayRegions(map.ApplyNearest(masks.polar_real),
                                         map.ApplyNearest(masks.polar_simulated), inside));
}

}  // namespace sonarcal::report
