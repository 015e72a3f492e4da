// Levels, powers and pixels of rows of echoes.
//
// Loops over arrays in vector instructions, in single precision unless a type says otherwise. The formulas
// are defined in sim/physics, in double precision; tests compare the two.
#pragma once

#include <cstdint>

namespace sonarcal::sim::row_math {

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

// floor((value - first) x per_step), or -1 if that is outside 0 .. bins - 1.
void Bins(const float* value, float first, float per_step, int bins, int count, std::int32_t* bin);

// bin[i] x beams + beam[i]. Returns `other` if either is negative, or if range_m[i] is not positive or not
// within nearest_m .. farthest_m.
void Pixels(const float* range_m, float nearest_m, float farthest_m, const std::int32_t* bin,
            const std::int32_t* beam, int beams, std::int32_t other, int count, std::int32_t* pixel);

}  // namespace sonarcal::sim::row_math
