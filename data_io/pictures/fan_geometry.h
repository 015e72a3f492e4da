// Position of the fan in a picture exported by a sonar viewer: in pixels, row 0 at the top, the fan opening
// upwards.
//
// A point at range r and azimuth t is displayed at
//
//   x = apex_x_px + x_scale s sin(t),  y = apex_y_px - s cos(t),
//   s = radius_min_px + (r - range_min) (radius_max_px - radius_min_px) / (range_max - range_min).
//
// x and y refer to pixel centres: the centre of the first pixel is at 0.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "core/types/mask.h"

namespace sonarcal::data_io {

struct FanGeometry {
  double apex_x_px = 0.0;  // centre of the arcs; usually below the picture
  double apex_y_px = 0.0;
  double radius_min_px = 0.0;  // radius of the near arc
  double radius_max_px = 0.0;  // radius of the far arc
  double half_angle_deg = 0.0;
  double x_scale = 1.0;  // columns per row; differs from 1 in a picture with non-square pixels

  bool operator==(const FanGeometry&) const = default;

  // Throws DataError that names `what`, the field and the limit.
  void Validate(const std::string& what) const;
};

// Finds the geometry from the outline of `lit`, the pixels that are not black in some picture. It needs two
// straight sides, mostly lit, and the arcs. Returns nothing if there is no fan: fewer than 100 lit pixels,
// sides that do not meet below, no arcs, or a field outside the limits of Validate.
//
// The outline is that of the convex hull, so dark places inside have no effect. Accurate to about a pixel for
// radii and the forward position of the apex, and to 0.5 % of x_scale for a fan of +-15 degrees. If the far
// arc is lit in few directions only, it is taken as a circle through the farthest lit pixels.
std::optional<FanGeometry> FindFanGeometry(const Mask& lit);

// Fractions of the outline that lit pixels reach, 0..1.
struct FanVisibility {
  double left_side = 0.0;
  double right_side = 0.0;
  double far_arc = 0.0;

  double sum() const { return left_side + right_side + far_arc; }
  double min() const { return std::min({left_side, right_side, far_arc}); }
};

FanVisibility VisibilityOf(const FanGeometry& fan, const Mask& lit);

// True if the lit pixels of a single picture show another fan than `fan`: its sides or far arc are lit along
// most of their length and differ from those of `fan` by more than 5 pixels and 2 % of the picture's width.
// Dark places within `fan` are not another fan.
bool ShowsAnotherFan(const Mask& lit, const FanGeometry& fan);

}  // namespace sonarcal::data_io
