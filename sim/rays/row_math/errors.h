// Random errors of rows of echoes.
//
// Loops over arrays in vector instructions, in single precision unless a type says otherwise. The formulas
// are defined in sim/physics, in double precision; tests compare the two.
#pragma once

#include <cstdint>

namespace sonarcal::sim::row_math {

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

}  // namespace sonarcal::sim::row_math
