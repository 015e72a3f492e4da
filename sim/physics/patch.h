// Surface patch that a ray represents.
#pragma once

#include <algorithm>
#include <cmath>

namespace sonarcal::sim {

// Lower limit of the cosine: an edge-on surface would have an unbounded area within a ray.
inline constexpr double kSmallestCosine = 0.02;

// a = R^2 dOmega / cos(delta). With this area, the level of a surface does not depend on the number of rays.
inline double PatchAreaM2(double range_m, double solid_angle_sr, double incidence_cosine) {
  return range_m * range_m * solid_angle_sr / std::max(incidence_cosine, kSmallestCosine);
}

// Range that the patch covers if the surface slopes along the height of the ray's cell, as a floor does:
// R height tan(delta).
inline double PatchDepthM(double range_m, double height_rad, double incidence_cosine) {
  const double cosine = std::max(incidence_cosine, kSmallestCosine);
  return range_m * height_rad * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
}

// Largest tangent of incidence that PatchDepthM uses.
inline double LargestTangent() {
  return PatchDepthM(1.0, 1.0, 0.0);
}

}  // namespace sonarcal::sim
