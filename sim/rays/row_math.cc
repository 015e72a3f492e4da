#include "sim/rays/row_math.h"

#if defined(__x86_64__)
#include <immintrin.h>
#define SONARCAL_AVX2
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/math/random.h"
#include "sim/rays/vector_versions.h"

namespace sonarcal::sim::row_math {

SONARCAL_VECTOR_VERSIONS
void WideSums(const float* const* __restrict weight, const float* __restrict values, int count,
              float* __restrict sums) {
  // A vector type, because GCC otherwise makes vectors of values of different i, which it has to shuffle.
  using Half = float __attribute__((vector_size(kWideSum / 2 * sizeof(float))));
  const float* __restrict a = weight[0];
  const float* __restrict b = weight[1];
  Half sum[4] = {};
  for (int i = 0; i < count; ++i, values += kWideSum) {
    Half first;
    Half second;
    std::memcpy(&first, values, sizeof first);
    std::memcpy(&second, values + kWideSum / 2, sizeof second);
    sum[0] += a[i] * first;
    sum[1] += a[i] * second;
    sum[2] += b[i] * first;
    sum[3] += b[i] * second;
  }
  std::memcpy(sums, sum, sizeof sum);
}

namespace {

// Angle of a sine and a cosine that are not negative. The quotient of the smaller by the larger one keeps the
// digits at both ends.
__attribute__((always_inline)) inline float AngleOf(float sine, float cosine) {
  const bool steep = sine > cosine;
  const float small = steep ? cosine : sine;
  const float large = steep ? sine : cosine;
  const float angle = std::atan(small / (large + 1e-30F));
  return steep ? 0.5F * std::numbers::pi_v<float> - angle : angle;
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void Angles(const float* __restrict sine, const float* __restrict cosine, int count,
            float* __restrict angle_rad) {
  for (int i = 0; i < count; ++i) angle_rad[i] = AngleOf(sine[i], cosine[i]);
}

SONARCAL_VECTOR_VERSIONS
void Bearings(const float* __restrict x, const float* __restrict y, const float* __restrict z, int count,
              float* __restrict azimuth_rad, float* __restrict elevation_rad) {
  for (int i = 0; i < count; ++i) {
    const float aside = AngleOf(std::abs(x[i]), std::abs(y[i]));
    azimuth_rad[i] = std::copysign(y[i] < 0.0F ? std::numbers::pi_v<float> - aside : aside, x[i]);
  }
  for (int i = 0; i < count; ++i) {
    const float raised = AngleOf(std::abs(z[i]), std::sqrt(x[i] * x[i] + y[i] * y[i]));
    elevation_rad[i] = std::copysign(raised, z[i]);
  }
}

SONARCAL_VECTOR_VERSIONS
void AddScaled(double weight, const double* __restrict values, int count, double* __restrict sums) {
  for (int i = 0; i < count; ++i) sums[i] += weight * values[i];
}

SONARCAL_VECTOR_VERSIONS
double Dot(const double* __restrict a, const double* __restrict b, int count) {
  // Separate sums for each vector lane, several vectors at once.
  constexpr int kLanes = 16;
  double sums[kLanes] = {};
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  }
  double sum = 0.0;
  for (; i < count; ++i) sum += a[i] * b[i];
  for (const double of_lane : sums) sum += of_lane;
  return sum;
}

namespace {

using FourDoubles = double __attribute__((vector_size(32)));
using EightFloats = float __attribute__((vector_size(32)));

// A vector type, because GCC otherwise makes vectors of the sums, whose values it has to gather.
template <typename Vector, typename T>
__attribute__((always_inline)) inline void DotsOf(const T* const* __restrict weight,
                                                  const T* const* __restrict values, int count,
                                                  T* __restrict sums) {
  constexpr int kInVector = sizeof(Vector) / sizeof(T);
  const T* __restrict first = weight[0];
  const T* __restrict second = weight[1];
  Vector by_first[kDots] = {};
  Vector by_second[kDots] = {};
  int i = 0;
  for (; i + kInVector <= count; i += kInVector) {
    Vector a;
    Vector b;
    std::memcpy(&a, first + i, sizeof a);
    std::memcpy(&b, second + i, sizeof b);
    for (int k = 0; k < kDots; ++k) {
      Vector v;
      std::memcpy(&v, values[k] + i, sizeof v);
      by_first[k] += a * v;
      by_second[k] += b * v;
    }
  }
  const auto total = [](const Vector& lanes) {
    T sum = 0;
    for (int lane = 0; lane < kInVector; ++lane) sum += lanes[lane];
    return sum;
  };
  for (int k = 0; k < kDots; ++k) {
    T of_first = total(by_first[k]);
    T of_second = total(by_second[k]);
    for (int rest = i; rest < count; ++rest) {
      of_first += first[rest] * values[k][rest];
      of_second += second[rest] * values[k][rest];
    }
    sums[k] = of_first;
    sums[kDots + k] = of_second;
  }
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void Dots(const double* const* weight, const double* const* values, int count, double* sums) {
  DotsOf<FourDoubles>(weight, values, count, sums);
}

SONARCAL_VECTOR_VERSIONS
void Dots(const float* const* weight, const float* const* values, int count, float* sums) {
  DotsOf<EightFloats>(weight, values, count, sums);
}

SONARCAL_VECTOR_VERSIONS
void WeighRows(const float* __restrict weight, const float* __restrict values, int count,
               float* __restrict sums) {
  constexpr int kLanes = 8;
  constexpr int kVectors = kBlockCols / kLanes;
  using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
  Lanes sum[kVectors];
  std::memcpy(sum, sums, sizeof sum);
  for (int i = 0; i < count; ++i, values += kBlockCols) {
    for (int v = 0; v < kVectors; ++v) {
      Lanes of_row;
      std::memcpy(&of_row, values + v * kLanes, sizeof of_row);
      sum[v] += weight[i] * of_row;
    }
  }
  std::memcpy(sums, sum, sizeof sum);
}

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

SONARCAL_VECTOR_VERSIONS
void Directions(const float* __restrict x, const float* __restrict y, float across, float up,
                const float* __restrict rotation, int count, float* __restrict world_x,
                float* __restrict world_y, float* __restrict world_z) {
  for (int i = 0; i < count; ++i) {
    const float right = x[i] * across;
    const float ahead = y[i] * across;
    const float scale = 1.0F / std::sqrt(right * right + ahead * ahead + up * up);
    world_x[i] = scale * (rotation[0] * right + rotation[1] * ahead + rotation[2] * up);
    world_y[i] = scale * (rotation[3] * right + rotation[4] * ahead + rotation[5] * up);
    world_z[i] = scale * (rotation[6] * right + rotation[7] * ahead + rotation[8] * up);
  }
}

namespace {

// Sine and cosine of an angle by the first terms of their series, exact to single precision: all terms within
// half a radian, two terms of each within kNarrowRad.
enum class Terms { kAll, kTwo };
constexpr float kNarrowRad = 0.02F;

template <Terms kTerms>
struct SmallTurn {
  explicit SmallTurn(float angle_rad) {
    const float square = angle_rad * angle_rad;
    // Factors rather than quotients, because the compiler may not turn a division into a multiplication.
    if constexpr (kTerms == Terms::kTwo) {
      sine = angle_rad * (1.0F - square * (1.0F / 6.0F));
      cosine = 1.0F - square * 0.5F;
    } else {
      sine = angle_rad * (1.0F - square * (1.0F / 6.0F) *
                                     (1.0F - square * (1.0F / 20.0F) * (1.0F - square * (1.0F / 42.0F))));
      cosine = 1.0F - square * 0.5F * (1.0F - square * (1.0F / 12.0F) * (1.0F - square * (1.0F / 30.0F)));
    }
  }
  float sine;
  float cosine;
};

// Factor that gives a vector the length 1. Its squared length is already 1 up to rounding, so one step of
// Newton's method for the inverse of the square root suffices.
__attribute__((always_inline)) inline float ToUnit(float squared_length) {
  return 1.5F - 0.5F * squared_length;
}

template <Terms kTerms>
__attribute__((always_inline)) inline void TurnAndRaise(const float* __restrict x, const float* __restrict y,
                                                        const float* __restrict width_rad, float part,
                                                        const float* __restrict elevation_offset,
                                                        float height_rad, float across, float up,
                                                        const float* __restrict rotation, int count,
                                                        float* __restrict world_x, float* __restrict world_y,
                                                        float* __restrict world_z) {
  for (int i = 0; i < count; ++i) {
    const SmallTurn<kTerms> aside(part * width_rad[i]);
    const SmallTurn<kTerms> raised(elevation_offset[i] * height_rad);
    const float level = across * raised.cosine - up * raised.sine;
    const float height = up * raised.cosine + across * raised.sine;
    const float right = (x[i] * aside.cosine + y[i] * aside.sine) * level;
    const float ahead = (y[i] * aside.cosine - x[i] * aside.sine) * level;
    const float scale = ToUnit(right * right + ahead * ahead + height * height);
    world_x[i] = scale * (rotation[0] * right + rotation[1] * ahead + rotation[2] * height);
    world_y[i] = scale * (rotation[3] * right + rotation[4] * ahead + rotation[5] * height);
    world_z[i] = scale * (rotation[6] * right + rotation[7] * ahead + rotation[8] * height);
  }
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void TurnedAndRaisedDirections(const float* x, const float* y, const float* width_rad, float part,
                               const float* elevation_offset, float height_rad, float across, float up,
                               const float* rotation, int count, float* world_x, float* world_y,
                               float* world_z) {
  int wide = std::abs(height_rad) < kNarrowRad ? 0 : 1;
  for (int i = 0; i < count; ++i) wide += std::abs(part * width_rad[i]) < kNarrowRad ? 0 : 1;
  if (wide == 0) {
    TurnAndRaise<Terms::kTwo>(x, y, width_rad, part, elevation_offset, height_rad, across, up, rotation,
                              count, world_x, world_y, world_z);
  } else {
    TurnAndRaise<Terms::kAll>(x, y, width_rad, part, elevation_offset, height_rad, across, up, rotation,
                              count, world_x, world_y, world_z);
  }
}

SONARCAL_VECTOR_VERSIONS
void TurnedDirections(const float* __restrict x, const float* __restrict y, const float* __restrict width_rad,
                      float part, float across, float up, const float* __restrict rotation, int count,
                      float* __restrict world_x, float* __restrict world_y, float* __restrict world_z) {
  for (int i = 0; i < count; ++i) {
    const SmallTurn<Terms::kAll> aside(part * width_rad[i]);
    const float right = (x[i] * aside.cosine + y[i] * aside.sine) * across;
    const float ahead = (y[i] * aside.cosine - x[i] * aside.sine) * across;
    const float scale = ToUnit(right * right + ahead * ahead + up * up);
    world_x[i] = scale * (rotation[0] * right + rotation[1] * ahead + rotation[2] * up);
    world_y[i] = scale * (rotation[3] * right + rotation[4] * ahead + rotation[5] * up);
    world_z[i] = scale * (rotation[6] * right + rotation[7] * ahead + rotation[8] * up);
  }
}

SONARCAL_VECTOR_VERSIONS
void CellWeights(const float* __restrict cosine, const float* __restrict limit,
                 const float* __restrict per_rad, float slope, float height, int count,
                 float* __restrict weight) {
  const float upper = slope + 0.5F * height;
  const float lower = slope - 0.5F * height;
  for (int i = 0; i < count; ++i) {
    const float top = upper < limit[i] ? upper : limit[i];
    const float bottom = lower > -limit[i] ? lower : -limit[i];
    // The height minus the parts beyond the limits keeps the digits that top - bottom would lose.
    const float within = height - (upper - top) - (bottom - lower);
    const float kept = within > 0.0F ? within : 0.0F;
    const float near = cosine[i];
    // An elevation is atan(slope x cosine). The difference of two is the arctangent of (a - b) / (1 + a b).
    const float beside = 1.0F + top * bottom * near * near;
    const float turned = beside < 0.0F ? std::numbers::pi_v<float> : 0.0F;
    weight[i] = per_rad[i] * (std::atan(kept * near / beside) + turned);
  }
}

SONARCAL_VECTOR_VERSIONS
void HalfTangents(const float* __restrict dx, const float* __restrict dy, const float* __restrict dz,
                  const float* __restrict nx, const float* __restrict ny, const float* __restrict nz,
                  int count, float* __restrict half_tangent) {
  for (int i = 0; i < count; ++i) {
    const float x = dy[i] * nz[i] - dz[i] * ny[i];
    const float y = dz[i] * nx[i] - dx[i] * nz[i];
    const float z = dx[i] * ny[i] - dy[i] * nx[i];
    const float sine_square = x * x + y * y + z * z;
    const float cosine = std::abs(dx[i] * nx[i] + dy[i] * ny[i] + dz[i] * nz[i]);
    const float length = std::sqrt(sine_square + cosine * cosine);
    half_tangent[i] = std::sqrt(sine_square) / (length + cosine + 1e-30F);
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

namespace {

// Philox2 (core/math/random.h), one lane per index.
void PhiloxWordsPlain(std::uint64_t seed, std::uint32_t first, const std::int32_t* offset,
                      std::uint32_t* word0, std::uint32_t* word1) {
  for (int i = 0; i < kLanes; ++i) {
    const auto words =
        Philox2({first + static_cast<std::uint32_t>(offset[i]), static_cast<std::uint32_t>(seed >> 32)},
                static_cast<std::uint32_t>(seed));
    word0[i] = words[0];
    word1[i] = words[1];
  }
}

#ifdef SONARCAL_AVX2
struct PhiloxLanes {
  __m256i word0;
  __m256i word1;
};

__attribute__((target("avx2"))) inline void Round(PhiloxLanes& lanes, __m256i by, __m256i key) {
  // 32 x 32 bit products of the even and of the odd lanes. Their high and low halves are then interleaved.
  const __m256i even = _mm256_mul_epu32(lanes.word0, by);
  const __m256i odd = _mm256_mul_epu32(_mm256_srli_epi64(lanes.word0, 32), by);
  const __m256i high = _mm256_blend_epi32(_mm256_srli_epi64(even, 32), odd, 0xAA);
  const __m256i low = _mm256_blend_epi32(even, _mm256_slli_epi64(odd, 32), 0xAA);
  lanes.word0 = _mm256_xor_si256(_mm256_xor_si256(high, key), lanes.word1);
  lanes.word1 = low;
}

// Four vectors at a time, which hides the latency of the multiplications.
__attribute__((target("avx2"))) void PhiloxWordsAvx2(std::uint64_t seed, std::uint32_t first,
                                                     const std::int32_t* offset, std::uint32_t* word0,
                                                     std::uint32_t* word1) {
  constexpr int kVectors = 4;
  constexpr int kOfVector = 8;
  const __m256i by = _mm256_set1_epi64x(philox::kMultiplierOfTwo);
  const __m256i weyl = _mm256_set1_epi32(static_cast<int>(philox::kWeyl0));
  const __m256i from = _mm256_set1_epi32(static_cast<int>(first));
  const __m256i high = _mm256_set1_epi32(static_cast<int>(static_cast<std::uint32_t>(seed >> 32)));
  for (int start = 0; start < kLanes; start += kVectors * kOfVector) {
    PhiloxLanes lanes[kVectors];
    for (int v = 0; v < kVectors; ++v) {
      const auto* offsets = reinterpret_cast<const __m256i*>(offset + start + v * kOfVector);
      lanes[v] = {_mm256_add_epi32(from, _mm256_loadu_si256(offsets)), high};
    }
    __m256i key = _mm256_set1_epi32(static_cast<int>(static_cast<std::uint32_t>(seed)));
    for (int round = 0; round < philox::kRounds; ++round) {
      for (PhiloxLanes& of_vector : lanes) Round(of_vector, by, key);
      key = _mm256_add_epi32(key, weyl);
    }
    for (int v = 0; v < kVectors; ++v) {
      _mm256_store_si256(reinterpret_cast<__m256i*>(word0 + start + v * kOfVector), lanes[v].word0);
      _mm256_store_si256(reinterpret_cast<__m256i*>(word1 + start + v * kOfVector), lanes[v].word1);
    }
  }
}
#endif

void PhiloxWords(std::uint64_t seed, std::uint32_t first, const std::int32_t* offset, std::uint32_t* word0,
                 std::uint32_t* word1) {
#ifdef SONARCAL_AVX2
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (has_avx2) {
    PhiloxWordsAvx2(seed, first, offset, word0, word1);
    return;
  }
#endif
  PhiloxWordsPlain(seed, first, offset, word0, word1);
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void NormalPairs(std::uint64_t seed, std::uint32_t first, const std::int32_t* __restrict offset, int count,
                 float* __restrict a, float* __restrict b) {
  for (int start = 0; start < count; start += kLanes) {
    const int here = count - start < kLanes ? count - start : kLanes;
    std::int32_t whole[kLanes] = {};  // last offsets, if they do not fill all lanes
    if (here < kLanes) std::copy_n(offset + start, here, whole);
    alignas(32) std::uint32_t first_word[kLanes];
    alignas(32) std::uint32_t second_word[kLanes];
    PhiloxWords(seed, first, here < kLanes ? whole : offset + start, first_word, second_word);
    // Box-Muller transform. Angles lie within half a turn of 0, where a single-precision sine is most
    // accurate. Sine and cosine have separate loops because the compiler does not vectorise a loop that
    // contains both.
    constexpr float kStep = 0x1p-32F;
    constexpr float kWholeTurn = 2.0F * std::numbers::pi_v<float>;
    float radius[kLanes];
    float angle[kLanes];
    float normal_a[kLanes];
    float normal_b[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const float u =
          (static_cast<float>(static_cast<std::int32_t>(first_word[i] >> 1)) * 2.0F + 1.0F) * kStep;
      radius[i] = std::sqrt(-2.0F * std::log(u));
      angle[i] = static_cast<float>(static_cast<std::int32_t>(second_word[i])) * (kWholeTurn * kStep);
    }
    for (int i = 0; i < kLanes; ++i) normal_a[i] = radius[i] * std::cos(angle[i]);
    for (int i = 0; i < kLanes; ++i) normal_b[i] = radius[i] * std::sin(angle[i]);
    for (int i = 0; i < here; ++i) {
      a[start + i] = normal_a[i];
      b[start + i] = normal_b[i];
    }
  }
}

SONARCAL_VECTOR_VERSIONS
void Disturb(const Growth& growth, float range_scale, float azimuth_scale, const float* __restrict range_m,
             const float* __restrict azimuth_rad, const float* __restrict a, const float* __restrict b,
             int count, float* __restrict noisy_range_m, float* __restrict noisy_azimuth_rad) {
  const float per_square = growth.per_reference_square;
  if (growth.root) {
    for (int i = 0; i < count; ++i) {
      const float g = std::sqrt(1.0F + range_m[i] * range_m[i] * per_square);
      noisy_range_m[i] = range_m[i] + range_scale * g * a[i];
      noisy_azimuth_rad[i] = azimuth_rad[i] + azimuth_scale * g * b[i];
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    const float g = 1.0F + range_m[i] * range_m[i] * per_square;
    noisy_range_m[i] = range_m[i] + range_scale * g * a[i];
    noisy_azimuth_rad[i] = azimuth_rad[i] + azimuth_scale * g * b[i];
  }
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
