// Surface patch that a ray represents.
#pragma once

#include <algorithm>

namespace sonarcal::sim {

// Lower limit of the cosine: an edge-on surface would have an unbounded area within a ray.
inline constexpr double kSmallestCosine = 0.02;

// a = R^2 dOmega / cos(delta). With this area, the level of a surface does not depend on the number of rays.
inline double PatchAreaM2(double range_m, double solid_angle_sr, double incidence_cosine) {
  return range_m * range_m * solid_angle_sr / std::max(incidence_cosine, kSmallestCosine);
}

}  // namespace sonarcal::sim
