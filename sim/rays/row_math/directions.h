// Directions and angles of rows of rays.
//
// Loops over arrays in vector instructions, in single precision unless a type says otherwise. The formulas
// are defined in sim/physics, in double precision; tests compare the two.
#pragma once

#include <array>
#include <cstdint>

namespace sonarcal::sim::row_math {

// Rotates the vectors (x[i] across, y[i] across, up) by `rotation` (row-major 3x3) and normalises them.
void Directions(const float* x, const float* y, float across, float up, const float* rotation, int count,
                float* world_x, float* world_y, float* world_z);

// As Directions, but first turns each vector to the right by part x width_rad[i]. The angle is within half a
// radian. (x[i], y[i]) and (across, up) have length 1.
void TurnedDirections(const float* x, const float* y, const float* width_rad, float part, float across,
                      float up, const float* rotation, int count, float* world_x, float* world_y,
                      float* world_z);

// As TurnedDirections, but then raises each vector by elevation_offset[i] x height_rad, within half a radian.
void TurnedAndRaisedDirections(const float* x, const float* y, const float* width_rad, float part,
                               const float* elevation_offset, float height_rad, float across, float up,
                               const float* rotation, int count, float* world_x, float* world_y,
                               float* world_z);

// Weights of the cells of a pinhole's row: the elevation that each cell covers times per_rad[i]. A cell
// covers slope - height / 2 to slope + height / 2, limited to +-limit[i]. cosine[i] is the cosine of the
// azimuth.
void CellWeights(const float* cosine, const float* limit, const float* per_rad, float slope, float height,
                 int count, float* weight);

// tan(delta / 2), 0..1, of the angle delta between a direction and a normal of any length and either
// orientation. Exact to single precision at every angle; a cosine loses its precision near 0.
void HalfTangents(const float* dx, const float* dy, const float* dz, const float* nx, const float* ny,
                  const float* nz, int count, float* half_tangent);

// Plane n . x = d: unit normal n, and distance d from the world's origin, m.
using Plane = std::array<double, 4>;
// Rays from any points, by component. Directions are unit vectors.
struct Rays {
  std::array<const float*, 3> origin_m;
  std::array<const float*, 3> direction;
  const float* farthest_m = nullptr;
};
// Range along ray i to planes[plane[i]], m, limited to 0 .. farthest_m. It is computed in double precision
// and then rounded. A ray that is parallel to its plane gets either limit.
void PlaneRanges(const Plane* planes, const std::uint32_t* plane, const Rays& rays, int count,
                 float* range_m);

// Angles between 0 and 90 degrees of these sines and cosines (or of any multiple of both), rad.
void Angles(const float* sine, const float* cosine, int count, float* angle_rad);

// Azimuth atan2(x, y) and elevation atan2(z, sqrt(x^2 + y^2)) of directions of any length, rad.
void Bearings(const float* x, const float* y, const float* z, int count, float* azimuth_rad,
              float* elevation_rad);

}  // namespace sonarcal::sim::row_math
