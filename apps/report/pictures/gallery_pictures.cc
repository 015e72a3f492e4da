#include "apps/report/pictures/gallery_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/pictures/depth_picture.h"
#include "core/imaging/fan_image.h"
#include "core/math/statistics.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

constexpr int kFanHeight_px = 320;
constexpr int kGap_px = 12;
constexpr double kShareBelowBrightest = 0.995;

// Number of rows of a pinhole grid with square pixels.
int SquarePixelRows(const SonarModel& sonar, int cols) {
  const PolarAxes& axes = sonar.axes;
  const double width = std::tan(axes.BeamEdgeRad(axes.beam_count())) - std::tan(axes.BeamEdgeRad(0));
  const double height = 2.0 * std::tan(RadFromDeg(0.5 * sonar.elevation_beam_width_deg));
  return std::max(1, static_cast<int>(std::lround(cols * height / width)));
}

// Square root of the grey level, so that a bed with its shadows and a wall are both visible: a bed returns a
// few per cent of the echo of a wall.
Grid<float> Brightened(const Grid<float>& grey, double brightest_grey) {
  Grid<float> bright(grey.rows(), grey.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const double share = std::clamp(static_cast<double>(grey.values()[i]) / brightest_grey, 0.0, 1.0);
    bright.values()[i] = static_cast<float>(std::sqrt(share));
  }
  return bright;
}

void Paste(const RgbImage& picture, int row, int col, RgbImage* sheet) {
  for (int r = 0; r < picture.rows(); ++r) {
    std::copy(picture.row(r).begin(), picture.row(r).end(), sheet->row(row + r).begin() + col);
  }
}

}  // namespace

GalleryView SeeView(const sim::Simulator& simulator, const Pose& world_from_sonar,
                    const ParameterSet& parameters, int frame_idx, int depth_cols) {
  const SonarModel& sonar = simulator.sonar();
  const sim::RayFan fan(
      sonar,
      {.sampling = sim::Sampling::kFrustum, .cols = depth_cols, .rows = SquarePixelRows(sonar, depth_cols)});
  const sim::FanHits hits = simulator.caster().Cast(fan, world_from_sonar, sonar.axes.range_max_m);
  GalleryView view{Grid<float>(fan.rows(), fan.cols()), {}};
  for (std::size_t i = 0; i < view.depth_m.size(); ++i) {
    if (std::isfinite(hits.range_m[i])) view.depth_m.values()[i] = hits.range_m[i];
  }
  view.image = simulator.Render(world_from_sonar, parameters, frame_idx);
  return view;
}

double BrightestGrey(const std::vector<GalleryView>& views) {
  std::vector<float> lit;
  for (const GalleryView& view : views) {
    for (const float grey : view.image.value.values()) {
      if (grey > 0.0F) lit.push_back(grey);
    }
  }
  if (lit.empty()) return 255.0;
  return LowerQuantile(std::move(lit), kShareBelowBrightest);
}

GalleryPictures MakePictures(const GalleryView& view, double brightest_grey) {
  const data_io::ValueWindow window{0.0, 1.0};
  const FanMap map(view.image.axes, FanOptions{.height_px = kFanHeight_px});
  return {.depth = DepthPicture(view.depth_m, view.image.axes.range_max_m),
          .fan = data_io::Colorize(Brightened(map.Apply(view.image.value), brightest_grey), window,
                                   data_io::ColorMap::kInferno, &map.inside()),
          .polar = data_io::StretchPolar(
              data_io::Colorize(Brightened(view.image.value, brightest_grey), window), kFanHeight_px)};
}

RgbImage Sheet(const std::vector<GalleryPictures>& rows) {
  SONARCAL_CHECK(!rows.empty(), "a sheet of no views");
  std::array<int, 3> width_px{};
  std::vector<int> height_px;
  const auto columns = [](const GalleryPictures& row) {
    return std::array<const RgbImage*, 3>{&row.depth, &row.fan, &row.polar};
  };
  int total_height_px = kGap_px * static_cast<int>(rows.size() - 1);
  for (const GalleryPictures& row : rows) {
    int highest_px = 0;
    for (std::size_t column = 0; column < 3; ++column) {
      width_px[column] = std::max(width_px[column], columns(row)[column]->cols());
      highest_px = std::max(highest_px, columns(row)[column]->rows());
    }
    height_px.push_back(highest_px);
    total_height_px += highest_px;
  }
  RgbImage sheet(total_height_px, width_px[0] + width_px[1] + width_px[2] + 2 * kGap_px,
                 data_io::kOutsideColor);
  int top_px = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    int left_px = 0;
    for (std::size_t column = 0; column < 3; ++column) {
      const RgbImage& picture = *columns(rows[row])[column];
      Paste(picture, top_px + (height_px[row] - picture.rows()) / 2,
            left_px + (width_px[column] - picture.cols()) / 2, &sheet);
      left_px += width_px[column] + kGap_px;
    }
    top_px += height_px[row] + kGap_px;
  }
  return sheet;
}

}  // namespace sonarcal::report
