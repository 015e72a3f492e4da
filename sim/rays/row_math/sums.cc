#include "sim/rays/row_math/sums.h"

#include <cstring>

#include "core/math/vector_versions.h"

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

SONARCAL_VECTOR_VERSIONS
void AddScaled(double weight, const double* __restrict values, int count, double* __restrict sums) {
  for (int i = 0; i < count; ++i) sums[i] += weight * values[i];
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

}  // namespace sonarcal::sim::row_math
