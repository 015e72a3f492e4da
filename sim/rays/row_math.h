// Vectorised arithmetic for rows of rays, on arrays in single precision (sums in double precision). The
// formulas are defined in sim/physics; this file only evaluates them. All other code for rays uses double
// precision, one ray at a time; tests compare the two.
//
// The source is compiled in two versions, for any processor and for processors with AVX2. The program selects
// one at start. Infinities and NaN keep their meaning in both.
#pragma once

#include <cstddef>
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

// Piecewise linear function on 0..1 with even steps: values[0 .. steps + 1].
struct Table {
  const float* values = nullptr;
  int steps = 0;
};

// Echo in whole steps of a fixed-point sum: echo[i] = offset - per_log x ln(range) - per_m x range +
// table(half_tangent), clamped to +-limit, times weight[i], rounded. Ranges are clamped to 0.1 mm .. 1000 km;
// a miss (infinity) gets the upper bound.
struct EchoLevel {
  float offset = 0.0F;
  float per_log = 0.0F;
  float per_m = 0.0F;
  float limit = 0.0F;
};
void EchoSteps(const EchoLevel& level, const Table& table, const float* range_m, const float* half_tangent,
               const float* weight, int count, std::int32_t* steps);

// Two standard normal numbers for each of `count` indices first + offset[i]. They equal those of
// NormalPairOfRay (core/math/random.h) up to rounding. Indices are below 2^32.
void NormalPairs(std::uint64_t seed, std::uint32_t first, const std::int32_t* offset, int count, float* a,
                 float* b);

// Adds a random error that grows with range. Its standard deviation is scale x g(R), with g^2 (or g, if not
// `root`) = 1 + (R / reference)^2.
struct Growth {
  float per_reference_square = 0.0F;  // 1 / reference^2
  bool root = true;
};
void Disturb(const Growth& growth, float range_scale, float azimuth_scale, const float* range_m,
             const float* azimuth_rad, const float* a, const float* b, int count, float* noisy_range_m,
             float* noisy_azimuth_rad);

// table((at + per_offset x elevation_offset[i]) x steps) x width[i]: a function of a ray's elevation, times
// the width of its column. Positions outside 0..1 are clamped.
void ElevationWeights(const Table& table, float at, float per_offset, const float* elevation_offset,
                      const float* width, int count, float* weight);

// (a + b x + c x^2) x width[i], with x = elevation_offset[i].
void QuadraticWeights(float a, float b, float c, const float* elevation_offset, const float* width, int count,
                      float* weight);

// table(at[i]), for positions 0..1.
void Lookup(const Table& table, const float* at, int count, float* value);

// table(half_tangent[i]) x weight[i] x exp(-per_m x range_m[i]) / range_m[i]^2.
void PatchPowers(const Table& table, float per_m, const float* range_m, const float* half_tangent,
                 const float* weight, int count, float* power);

// Rows of range, as sim/physics/fine_rows.h (FineRows) defines them.
struct RangeRows {
  float nearest_m = 0.0F;  // window of the echoes to keep
  float farthest_m = 0.0F;
  float first_m = 0.0F;
  float per_m = 0.0F;
  float part_m = 0.0F;
  float max_parts = 0.0F;
};
// Parts of echoes from patches with slopes along the height of their cells (PatchDepthM of
// sim/physics/patch.h; tangents are limited to max_tangent): number of parts, position of the first one in
// rows, and step between two in rows. 0 parts for an echo outside of the window.
void EchoParts(const RangeRows& rows, float height_rad, float max_tangent, const float* range_m,
               const float* half_tangent, int count, float* parts, float* position, float* step);

// Angles between 0 and 90 degrees of these sines and cosines (or of any multiple of both), rad.
void Angles(const float* sine, const float* cosine, int count, float* angle_rad);

// Azimuth atan2(x, y) and elevation atan2(z, sqrt(x^2 + y^2)) of directions of any length, rad.
void Bearings(const float* x, const float* y, const float* z, int count, float* azimuth_rad,
              float* elevation_rad);

// Adds weight x values[i] to sums[i].
void AddScaled(double weight, const double* values, int count, double* sums);

double Dot(const double* a, const double* b, int count);

// sums[w kDots + k] = sum over i of weight[w][i] x values[k][i], for two weights.
inline constexpr int kDots = 4;
void Dots(const double* const* weight, const double* const* values, int count, double* sums);
void Dots(const float* const* weight, const float* const* values, int count, float* sums);

// Adds to sums[k] the sum over i of weight[i] x values[i kBlockCols + k], for k = 0 .. kBlockCols - 1.
inline constexpr int kBlockCols = 64;
void WeighRows(const float* weight, const float* values, int count, float* sums);

// sums[w kWideSum + k] = sum over i of weight[w][i] x values[i kWideSum + k], for two weights.
inline constexpr int kWideSum = 16;
void WideSums(const float* const* weight, const float* values, int count, float* sums);

// floor((value - first) x per_step), or -1 if that is outside 0 .. bins - 1.
void Bins(const float* value, float first, float per_step, int bins, int count, std::int32_t* bin);

// bin[i] x beams + beam[i]. Returns `other` if either is negative, or if range_m[i] is not positive or not
// within nearest_m .. farthest_m.
void Pixels(const float* range_m, float nearest_m, float farthest_m, const std::int32_t* bin,
            const std::int32_t* beam, int beams, std::int32_t other, int count, std::int32_t* pixel);

}  // namespace sonarcal::sim::row_math
