#include "sim/rays/row_math/errors.h"

#if defined(__x86_64__)
#include <immintrin.h>
#define SONARCAL_AVX2
#endif

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/random.h"
#include "core/math/vector_versions.h"

namespace sonarcal::sim::row_math {

namespace {

constexpr int kLanes = 64;

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
  static const bool kHasAvx2 = __builtin_cpu_supports("avx2") != 0;
  if (kHasAvx2) {
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

}  // namespace sonarcal::sim::row_math
