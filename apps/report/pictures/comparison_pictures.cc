#include "apps/report/pictures/comparison_pictures.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

void WriteView(const std::filesystem::path& folder, const std::string& stem, const ViewPictures& view) {
  const auto write = [&](const char* what, const std::vector<std::uint8_t>& png) {
    data_io::WriteFileWhole(folder / fmt::format("{}_{}.png", stem, what),
                            {reinterpret_cast<const char*>(png.data()), png.size()});
  };
  write("real", view.real);
  write("simulated", view.simulated);
  write("overlay", view.overlay);
  write("regions", view.regions);
}

}  // namespace

FramePictures PictureMaker::Make(const PolarImage& real, const PolarImage& simulated,
                                 const metrics::FrameMetrics& metrics) {
  SONARCAL_CHECK(metrics.masks.has_value(), "frame {} was compared without masks", metrics.index);
  const metrics::FrameMasks& masks = *metrics.masks;
  const data_io::ValueWindow window{0.0, real.scale.full_scale};
  const auto polar = [&](const RgbImage& picture) {
    return data_io::EncodePng(data_io::StretchPolar(picture, height_px_));
  };
  FramePictures pictures{.index = metrics.index, .name = metrics.name, .polar = {}, .fan = {}};
  pictures.polar = {.real = polar(data_io::Colorize(real.value, window)),
                    .simulated = polar(data_io::Colorize(simulated.value, window)),
                    .overlay = polar(data_io::Superimpose(real.value, simulated.value, window)),
                    .regions = polar(data_io::OverlayRegions(masks.polar_real, masks.polar_simulated))};

  if (!map_ || !map_->polar_axes().Matches(real.axes))
    map_.emplace(real.axes, FanOptions{.height_px = height_px_});
  const Mask* inside = &map_->inside();
  const Grid<float> real_fan = map_->Apply(real.value);
  const Grid<float> simulated_fan = map_->Apply(simulated.value);
  const Mask real_object = map_->ApplyNearest(masks.polar_real);
  const Mask simulated_object = map_->ApplyNearest(masks.polar_simulated);
  pictures.fan = {
      .real = data_io::EncodePng(data_io::Colorize(real_fan, window, data_io::ColorMap::kInferno, inside)),
      .simulated =
          data_io::EncodePng(data_io::Colorize(simulated_fan, window, data_io::ColorMap::kInferno, inside)),
      .overlay = data_io::EncodePng(data_io::Superimpose(real_fan, simulated_fan, window, inside)),
      .regions = data_io::EncodePng(data_io::OverlayRegions(real_object, simulated_object, inside))};
  return pictures;
}

FramePictures ForPage(const FramePictures& pictures) {
  constexpr int kWidthPx = 480;
  const auto shrunk = [](const std::vector<std::uint8_t>& png) {
    const data_io::ImageFile file({reinterpret_cast<const char*>(png.data()), png.size()}, "picture");
    if (file.header().cols <= kWidthPx) return png;
    return data_io::EncodePng(data_io::Shrink(file.DecodeRgb(), kWidthPx));
  };
  const auto view = [&](const ViewPictures& of) {
    return ViewPictures{shrunk(of.real), shrunk(of.simulated), shrunk(of.overlay), shrunk(of.regions)};
  };
  return {pictures.index, pictures.name, view(pictures.polar), view(pictures.fan)};
}

void WritePictures(const std::filesystem::path& folder, const FramePictures& pictures) {
  WriteView(folder, fmt::format("frame_{:04}_polar", pictures.index), pictures.polar);
  WriteView(folder, fmt::format("frame_{:04}_fan", pictures.index), pictures.fan);
}

}  // namespace sonarcal::report
