#include "metrics/segmentation/region.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/types/units.h"
#include "metrics/segmentation/object_region.h"

namespace sonarcal::metrics {

Mask BoxAround(const Mask& object, int margin_rows, int margin_cols) {
  return MaskOf(BoxOf(object, {.bins = margin_rows, .beams = margin_cols}), object.rows(), object.cols());
}

Mask Dilated(const Mask& object, int margin_rows, int margin_cols) {
  SONARCAL_CHECK(margin_rows >= 0 && margin_cols >= 0, "margins {} and {}", margin_rows, margin_cols);
  Mask dilated = object;
  if (object.empty()) return dilated;
  cv::Mat1b pixels(dilated.rows(), dilated.cols(), dilated.values().data());
  cv::Mat1b grown;
  cv::dilate(pixels, grown,
             cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * margin_cols + 1, 2 * margin_rows + 1)),
             cv::Point(-1, -1), 1, cv::BORDER_CONSTANT, 0);
  grown.copyTo(pixels);
  return dilated;
}

Mask DilatedByMetres(const Mask& object, const PolarAxes& axes, double margin_m) {
  SONARCAL_CHECK(object.rows() == axes.range_bins && object.cols() == axes.beam_count(),
                 "mask {} x {}, image {} x {}", object.rows(), object.cols(), axes.range_bins,
                 axes.beam_count());
  SONARCAL_CHECK(margin_m >= 0.0, "margin of {} m", margin_m);
  // Dilates along the arc first, at each pixel's own range.
  Mask wide(object.rows(), object.cols());
  for (int bin = 0; bin < object.rows(); ++bin) {
    const double reach_rad = margin_m / axes.range_centre_m(bin);
    for (int beam = 0; beam < object.cols(); ++beam) {
      if (object(bin, beam) == 0) continue;
      const auto mark = [&](int other) {
        const double apart_rad = std::abs(axes.beam_azimuth_rad[other] - axes.beam_azimuth_rad[beam]);
        if (apart_rad > reach_rad * (1.0 + 1e-9)) return false;
        wide(bin, other) = 1;
        return true;
      };
      for (int other = beam; other >= 0 && mark(other); --other) {
      }
      for (int other = beam + 1; other < object.cols() && mark(other); ++other) {
      }
    }
  }
  const double margin_rows = std::floor(margin_m / axes.range_bin_m() * (1.0 + 1e-9));
  return Dilated(wide, static_cast<int>(std::min<double>(margin_rows, object.rows())), 0);
}

Mask InsidePolygon(const std::vector<PolygonCorner>& corners, const PolarAxes& axes) {
  if (corners.size() < 3) throw DataError("a polygon of {} corners, expected 3 or more", corners.size());
  for (const PolygonCorner& corner : corners) {
    if (!std::isfinite(corner.range_m) || !std::isfinite(corner.azimuth_deg)) {
      throw DataError("a polygon's corner at range {} m and azimuth {} degrees, expected finite numbers",
                      corner.range_m, corner.azimuth_deg);
    }
  }
  Mask inside(axes.range_bins, axes.beam_count());
  for (int bin = 0; bin < inside.rows(); ++bin) {
    const double range_m = axes.range_centre_m(bin);
    for (int beam = 0; beam < inside.cols(); ++beam) {
      const double azimuth_deg = DegFromRad(axes.beam_azimuth_rad[beam]);
      // Number of sides to one side of the centre, at its range.
      bool odd = false;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const PolygonCorner& a = corners[i];
        const PolygonCorner& b = corners[(i + 1) % corners.size()];
        if ((a.range_m > range_m) == (b.range_m > range_m)) continue;
        const double part = (range_m - a.range_m) / (b.range_m - a.range_m);
        if (azimuth_deg < a.azimuth_deg + part * (b.azimuth_deg - a.azimuth_deg)) odd = !odd;
      }
      inside(bin, beam) = odd ? 1 : 0;
    }
  }
  return inside;
}

}  // namespace sonarcal::metrics
