// The arithmetic of a row of rays, in single precision (but for Dot) over arrays, as fast as the processor's
// vectors make it. Formulas are those of sim/physics, stated there; here they are only evaluated. Everything
// else about rays is in double precision and one at a time: the tests hold the two against each other.
//
// This file's source is compiled in one version for any processor and one for those with AVX2, chosen when
// the program starts. Infinities and NaN keep their meaning in both.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sonarcal::sim::row_math {

// Unit vectors: (x[i] across, y[i] across, up), turned by `rotation` (rows one after the other) and brought
// to length 1.
void Directions(const float* x, const float* y, float across, float up, const float* rotation, int count,
                float* world_x, float* world_y, float* world_z);

// The same, each first turned to the right by part x width_rad[i], which is within half a radian; (x[i],
// y[i]) of length 1.
void TurnedDirections(const float* x, const float* y, const float* width_rad, float part, float across,
                      float up, const float* rotation, int count, float* world_x, float* world_y,
                      float* world_z);

// The same, each then raised by raise[i] x height_rad, which is within half a radian.
void TurnedAndRaisedDirections(const float* x, const float* y, const float* width_rad, float part,
                               const float* raise, float height_rad, float across, float up,
                               const float* rotation, int count, float* world_x, float* world_y,
                               float* world_z);

// What the cells of a row of a pinhole count: the elevation that each covers, from slope - height / 2 to
// slope + height / 2 but no further than +-limit[i], times per_rad[i]. cosine[i] is that of the azimuth.
void CellWeights(const float* cosine, const float* limit, const float* per_rad, float slope, float height,
                 int count, float* weight);

// tan(delta / 2) of the angle delta between a direction and a normal of any length and either side, 0..1:
// exact to single precision at every angle, where a cosine is blind about 0.
void HalfTangents(const float* dx, const float* dy, const float* dz, const float* nx, const float* ny,
                  const float* nz, int count, float* half_tangent);

// A function of one variable on 0..1, in even steps, linear between: values[0 .. steps + 1].
struct Table {
  const float* values = nullptr;
  int steps = 0;
};

// Steps of a fixed-point sum: echo[i] = offset - per_log x ln(range) - per_m x range + table(half_tangent),
// kept within +-limit, times weight[i], rounded. Ranges count from 0.1 mm to 1000 km: a miss, which is
// infinite, is as far.
struct EchoLevel {
  float offset = 0.0F;
  float per_log = 0.0F;
  float per_m = 0.0F;
  float limit = 0.0F;
};
void EchoSteps(const EchoLevel& level, const Table& table, const float* range_m, const float* half_tangent,
               const float* weight, int count, std::int32_t* steps);

// Two standard normal numbers for each of `count` indices first + offset[i]: those of
// NormalPairOfRay (core/math/random.h), but for rounding. Indices are below 2^32.
void NormalPairs(std::uint64_t seed, std::uint32_t first, const std::int32_t* offset, int count, float* a,
                 float* b);

// Standard deviation of an error that grows with range: scale x g(R), g^2 (or g, where not `root`) =
// 1 + (R / reference)^2; added to what it disturbs.
struct Growth {
  float per_reference_square = 0.0F;  // 1 / reference^2
  bool root = true;
};
void Disturb(const Growth& growth, float range_scale, float azimuth_scale, const float* range_m,
             const float* azimuth_rad, const float* a, const float* b, int count, float* noisy_range_m,
             float* noisy_azimuth_rad);

// table((at + per_raise x raise[i]) x steps) x width[i]: what hangs on a ray's elevation, times its column's
// width. Positions outside 0..1 are taken at the nearer end.
void RaisedWeights(const Table& table, float at, float per_raise, const float* raise, const float* width,
                   int count, float* weight);

// table(half_tangent[i]) x weight[i] x exp(-per_m x range_m[i]) / range_m[i]^2.
void PatchPowers(const Table& table, float per_m, const float* range_m, const float* half_tangent,
                 const float* weight, int count, float* power);

double Dot(const double* a, const double* b, int count);

// floor((value - first) x per_step), -1 where that is not 0 .. bins - 1.
void Bins(const float* value, float first, float per_step, int bins, int count, std::int32_t* bin);

// bin[i] x beams + beam[i], `other` where either is negative or range_m[i] is not within nearest_m ..
// farthest_m or not positive.
void Pixels(const float* range_m, float nearest_m, float farthest_m, const std::int32_t* bin,
            const std::int32_t* beam, int beams, std::int32_t other, int count, std::int32_t* pixel);

}  // namespace sonarcal::sim::row_math
