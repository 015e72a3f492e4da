// Weighted sums of arrays.
//
// Loops over arrays in vector instructions. Tests compare them with plain sums.
#pragma once

namespace sonarcal::sim::row_math {

// Adds weight x values[i] to sums[i].
void AddScaled(double weight, const double* values, int count, double* sums);

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

}  // namespace sonarcal::sim::row_math
