// Regions of interest: where in a polar image an object may be.
#pragma once

#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

// The bounding box of the object's pixels, wider by the margins on each side, cut at the image's borders.
// Nothing is set where the object has no pixel.
Mask BoxAround(const Mask& object, int margin_rows, int margin_cols);

// The object's pixels and all that lie within margin_rows rows and margin_cols columns of one. Nothing is set
// where the object has no pixel.
Mask Dilated(const Mask& object, int margin_rows, int margin_cols);

// All that lies within margin_m of the object along range and within margin_m of it along the arc (range
// times azimuth): a rectangle about each pixel, of as many beams as the pixel's range makes it.
Mask DilatedByMetres(const Mask& object, const PolarAxes& axes, double margin_m);

// A corner of a polygon, where range and azimuth put it.
struct PolygonCorner {
  double range_m = 0.0;
  double azimuth_deg = 0.0;

  bool operator==(const PolygonCorner&) const = default;
};

// The pixels whose centres lie inside the polygon (even-odd rule; sides straight in range and azimuth).
// Throws DataError where there are fewer than three corners, or one is not finite.
Mask InsidePolygon(const std::vector<PolygonCorner>& corners, const PolarAxes& axes);

}  // namespace sonarcal::metrics
