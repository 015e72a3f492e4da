// Where the fan lies in a picture as a sonar's viewer exports it: in pixels, the picture's row 0 uppermost,
// the fan opening upwards.
//
// A point at range r and azimuth t is shown at
//   x = apex_x_px + x_scale s sin(t),  y = apex_y_px - s cos(t),
//   s = radius_min_px + (r - range_min) (radius_max_px - radius_min_px) / (range_max - range_min).
// x and y are those of pixel centres: the first pixel's centre is at 0.
#pragma once

#include <optional>
#include <string>

#include "core/types/mask.h"

namespace sonarcal::data_io {

struct FanGeometry {
  double apex_x_px = 0.0;  // centre of the arcs; most often below the picture
  double apex_y_px = 0.0;
  double radius_min_px = 0.0;  // of the near arc
  double radius_max_px = 0.0;  // of the far arc
  double half_angle_deg = 0.0;
  double x_scale = 1.0;  // columns a row: other than 1 where a picture was resized unevenly

  bool operator==(const FanGeometry&) const = default;

  // Throws DataError naming `what`, field and limit.
  void Validate(const std::string& what) const;
};

// The geometry of which `lit`, the pixels that are not black in any picture, shows the outline: two straight
// sides, of which most pixels must be lit, and the arcs. Nothing where no fan can be made out: fewer than 100
// lit pixels, sides that do not meet below, or arcs that are none.
//
// The outline is that of the convex hull, which dark places within do not change. Right to about a pixel for
// radii and apex in the direction ahead, and half a per cent of x_scale for a fan of +-15 degrees.
std::optional<FanGeometry> FindFanGeometry(const Mask& lit);

// Whether the lit pixels of a single picture show another fan than `fan`: it has two sides or a far arc of
// its own, lit along most of their length, more than 5 pixels and 2 % of the picture's width away from those
// of `fan`. Dark places within `fan` do not count as another fan.
bool ShowsAnotherFan(const Mask& lit, const FanGeometry& fan);

}  // namespace sonarcal::data_io
