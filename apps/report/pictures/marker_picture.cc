#include "apps/report/pictures/marker_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

constexpr data_io::Rgb kResidualColor = {213, 94, 0};  // Okabe and Ito's vermilion

void Dot(RgbImage& picture, const Eigen::Vector2d& pixel, const data_io::Rgb& color) {
  const double u = std::round(pixel.x());
  const double v = std::round(pixel.y());
  if (!(u >= 0.0 && v >= 0.0 && u < picture.cols() && v < picture.rows())) return;
  picture(static_cast<int>(v), static_cast<int>(u)) = color;
}

void Line(RgbImage& picture, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
          const data_io::Rgb& color) {
  const double length_px = (to - from).norm();
  constexpr double kMaxPx = 1e5;
  if (!(length_px < kMaxPx)) return;
  const int steps = 1 + static_cast<int>(2.0 * length_px);
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d at = from + (to - from) * i / steps;
    // Two pixels wide, for visibility.
    Dot(picture, at, color);
    Dot(picture, at + Eigen::Vector2d(1.0, 0.0), color);
    Dot(picture, at + Eigen::Vector2d(0.0, 1.0), color);
  }
}

}  // namespace

RgbImage MarkerPicture(const Grid<std::uint8_t>& grey, const calib::MarkerFramePose& frame) {
  RgbImage picture(grey.rows(), grey.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) picture.values()[i].fill(grey.values()[i]);
  for (const calib::MarkerResidual& marker : frame.markers) {
    for (int k = 0; k < 4; ++k) {
      Line(picture, marker.projected_px[k], marker.projected_px[(k + 1) % 4],
           marker.left_out ? data_io::kSimulatedOnlyColor : data_io::kRealOnlyColor);
    }
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d residual = marker.observation.corners_px[k] - marker.projected_px[k];
      Line(picture, marker.projected_px[k], marker.projected_px[k] + kResidualEnlarged * residual,
           kResidualColor);
    }
  }
  return picture;
}

}  // namespace sonarcal::report
