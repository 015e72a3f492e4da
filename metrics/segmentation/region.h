// Regions of interest: areas of a polar image in which an object may be.
#pragma once

#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

// Bounding box of the object's pixels, wider by the margins on each side, cut at the image's borders. Empty
// if the object has no pixel.
Mask BoxAround(const Mask& object, int margin_rows, int margin_cols);

// Pixels of the object, and all pixels within margin_rows rows and margin_cols columns of one. Empty if the
// object has no pixel.
Mask Dilated(const Mask& object, int margin_rows, int margin_cols);

// Pixels within margin_m of the object along range and along the arc (range times azimuth): a rectangle
// around each pixel, whose width in beams depends on its range.
Mask DilatedByMetres(const Mask& object, const PolarAxes& axes, double margin_m);

// Corner of a polygon, in range and azimuth.
struct PolygonCorner {
  double range_m = 0.0;
  double azimuth_deg = 0.0;

  bool operator==(const PolygonCorner&) const = default;
};

// Pixels whose centres lie inside the polygon (even-odd rule; sides straight in range and azimuth). Throws
// DataError for fewer than three corners, or if one is not finite.
Mask InsidePolygon(const std::vector<PolygonCorner>& corners, const PolarAxes& axes);

}  // namespace sonarcal::metrics
