#include "sim/rays/row_math/echoes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/math/vector_versions.h"

namespace sonarcal::sim::row_math {

SONARCAL_VECTOR_VERSIONS
void EchoParts(const RangeRows& rows, float height_rad, float max_tangent, const float* __restrict range_m,
               const float* __restrict half_tangent, int count, float* __restrict parts,
               float* __restrict position, float* __restrict step) {
  const RangeRows r = rows;
  const float per_part = 1.0F / r.part_m;
  for (int i = 0; i < count; ++i) {
    const float range = range_m[i];
    const float tangent = 2.0F * half_tangent[i] / (1.0F - half_tangent[i] * half_tangent[i] + 1e-30F);
    const float slope = tangent < max_tangent ? tangent : max_tangent;
    const float spread = range * height_rad * slope * per_part;
    const float in_parts = spread < r.max_parts ? spread : r.max_parts;
    const float whole = std::ceil(in_parts);
    const float number = whole > 1.0F ? whole : 1.0F;
    const bool inside = range > 0.0F && range >= r.nearest_m && range < r.farthest_m;
    const float depth = in_parts * r.part_m;
    parts[i] = inside ? number : 0.0F;
    position[i] = (range + depth * (0.5F / number - 0.5F) - r.first_m) * r.per_m;
    step[i] = depth / number * r.per_m;
  }
}

namespace {

constexpr int kLanes = 64;

// Calls of_lanes(first, count, value) for each kLanes of `count` elements. value[i] is that of the table at
// position(first + i), in steps, interpolated linearly. The look-ups have a loop of their own, because the
// compiler makes no vectors of a loop that contains them.
template <typename Position, typename OfLanes>
__attribute__((always_inline)) inline void Interpolate(const Table& table, int count,
                                                       const Position& position, const OfLanes& of_lanes) {
  const float* __restrict values = table.values;
  float at[kLanes];
  std::int32_t cell[kLanes];
  float between[2 * kLanes];  // values at both ends of the cell, which one load reads
  float value[kLanes];
  for (int first = 0; first < count; first += kLanes) {
    const int here = count - first < kLanes ? count - first : kLanes;
    for (int i = 0; i < here; ++i) {
      at[i] = position(first + i);
      cell[i] = static_cast<std::int32_t>(at[i]);
    }
    for (int i = 0; i < here; ++i) std::memcpy(&between[2 * i], &values[cell[i]], 2 * sizeof(float));
    for (int i = 0; i < here; ++i) {
      value[i] =
          between[2 * i] + (at[i] - static_cast<float>(cell[i])) * (between[2 * i + 1] - between[2 * i]);
    }
    of_lanes(first, here, value);
  }
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void EchoSteps(const EchoLevel& level, const Table& table, const float* __restrict range_m,
               const float* __restrict half_tangent, const float* __restrict weight, int count,
               std::int32_t* __restrict steps) {
  constexpr float kNearestM = 1e-4F;
  constexpr float kFarthestM = 1e6F;
  const EchoLevel l = level;
  const auto table_steps = static_cast<float>(table.steps);
  Interpolate(
      table, count, [&](int i) { return half_tangent[i] * table_steps; },
      [&](int first, int here, const float* strength) {
        for (int i = 0; i < here; ++i) {
          const float range = range_m[first + i];
          const float near = range > kNearestM ? range : kNearestM;
          const float metres = near < kFarthestM ? near : kFarthestM;
          const float echo = l.offset - l.per_log * std::log(metres) - l.per_m * metres + strength[i];
          const float kept = echo > l.limit ? l.limit : (echo < -l.limit ? -l.limit : echo);
          steps[first + i] = static_cast<std::int32_t>(std::nearbyint(kept * weight[first + i]));
        }
      });
}

SONARCAL_VECTOR_VERSIONS
void ElevationWeights(const Table& table, float at, float per_offset,
                      const float* __restrict elevation_offset, const float* __restrict width, int count,
                      float* __restrict weight) {
  const auto table_steps = static_cast<float>(table.steps);
  Interpolate(
      table, count,
      [&](int i) {
        const float along = (at + per_offset * elevation_offset[i]) * table_steps;
        const float inside = along > table_steps ? table_steps : along;
        return inside > 0.0F ? inside : 0.0F;
      },
      [&](int first, int here, const float* value) {
        for (int i = 0; i < here; ++i) weight[first + i] = width[first + i] * value[i];
      });
}

SONARCAL_VECTOR_VERSIONS
void QuadraticWeights(float a, float b, float c, const float* __restrict elevation_offset,
                      const float* __restrict width, int count, float* __restrict weight) {
  for (int i = 0; i < count; ++i)
    weight[i] = (a + elevation_offset[i] * (b + elevation_offset[i] * c)) * width[i];
}

SONARCAL_VECTOR_VERSIONS
void Lookup(const Table& table, const float* __restrict at, int count, float* __restrict value) {
  const auto table_steps = static_cast<float>(table.steps);
  Interpolate(
      table, count, [&](int i) { return at[i] * table_steps; },
      [&](int first, int here, const float* found) { std::copy_n(found, here, value + first); });
}

SONARCAL_VECTOR_VERSIONS
void PatchPowers(const Table& table, float per_m, const float* __restrict range_m,
                 const float* __restrict half_tangent, const float* __restrict weight, int count,
                 float* __restrict power) {
  const auto table_steps = static_cast<float>(table.steps);
  Interpolate(
      table, count, [&](int i) { return half_tangent[i] * table_steps; },
      [&](int first, int here, const float* strength) {
        for (int i = 0; i < here; ++i) {
          const float range = range_m[first + i];
          power[first + i] = strength[i] * weight[first + i] * std::exp(-per_m * range) / (range * range);
        }
      });
}

SONARCAL_VECTOR_VERSIONS
void Bins(const float* __restrict value, float first, float per_step, int bins, int count,
          std::int32_t* __restrict bin) {
  const auto end = static_cast<float>(bins);
  for (int i = 0; i < count; ++i) {
    const float position = (value[i] - first) * per_step;
    const bool inside = position >= 0.0F && position < end;
    const float kept = inside ? position : -1.0F;
    bin[i] = static_cast<std::int32_t>(kept);
  }
}

SONARCAL_VECTOR_VERSIONS
void Pixels(const float* __restrict range_m, float nearest_m, float farthest_m,
            const std::int32_t* __restrict bin, const std::int32_t* __restrict beam, int beams,
            std::int32_t other, int count, std::int32_t* __restrict pixel) {
  for (int i = 0; i < count; ++i) {
    const bool in_window = range_m[i] > 0.0F && range_m[i] >= nearest_m && range_m[i] < farthest_m;
    const bool inside = in_window && bin[i] >= 0 && beam[i] >= 0;
    pixel[i] = inside ? bin[i] * beams + beam[i] : other;
  }
}

}  // namespace sonarcal::sim::row_math
