// The surface that a ray stands for.
#pragma once

#include <algorithm>

namespace sonarcal::sim {

// A surface seen edge on has no bounds within a ray: its cosine is taken no smaller than this.
inline constexpr double kSmallestCosine = 0.02;

// a = R^2 dOmega / cos(delta): with it the level of a surface does not depend on the number of rays.
inline double PatchAreaM2(double range_m, double solid_angle_sr, double incidence_cosine) {
  return range_m * range_m * solid_angle_sr / std::max(incidence_cosine, kSmallestCosine);
}

}  // namespace sonarcal::sim
