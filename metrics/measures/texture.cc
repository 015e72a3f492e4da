#include "metrics/measures/texture.h"

#include <cmath>
#include <numbers>

namespace sonarcal::metrics {
namespace {

constexpr int kNeighbours = 8;

void AddCounts(std::array<std::int64_t, kTexturePatterns>& counts,
               const std::array<std::int64_t, kTexturePatterns>& other) {
  for (int i = 0; i < kTexturePatterns; ++i) counts[i] += other[i];
}

double Total(const std::array<std::int64_t, kTexturePatterns>& counts) {
  double total = 0.0;
  for (const std::int64_t count : counts) total += static_cast<double>(count);
  return total;
}

bool IsInside(const Mask* inside, int row, int col) {
  if (inside == nullptr) return true;
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = col - 1; c <= col + 1; ++c) {
      if ((*inside)(r, c) == 0) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<double> TextureCounts::divergence() const {
  constexpr double kPrior = 0.5;
  const double of_real = Total(real);
  if (of_real == 0.0) return std::nullopt;
  const double real_sum = of_real + kPrior * kTexturePatterns;
  const double simulated_sum = Total(simulated) + kPrior * kTexturePatterns;
  double divergence = 0.0;
  for (int i = 0; i < kTexturePatterns; ++i) {
    const double p = (static_cast<double>(real[i]) + kPrior) / real_sum;
    const double q = (static_cast<double>(simulated[i]) + kPrior) / simulated_sum;
    divergence += p * std::log(p / q);
  }
  return divergence;
}

TextureCounts& TextureCounts::operator+=(const TextureCounts& other) {
  AddCounts(real, other.real);
  AddCounts(simulated, other.simulated);
  return *this;
}

TextureMeasures& TextureMeasures::operator+=(const TextureMeasures& other) {
  whole += other.whole;
  union_region += other.union_region;
  return *this;
}

int BinaryPattern(const Grid<float>& image, int row, int col) {
  const double centre = image(row, col);
  const auto above = [&](int down, int across) { return image(row + down, col + across) - centre; };
  // A diagonal neighbour lies at (sqrt(1/2), sqrt(1/2)). Its interpolated difference from the centre, without
  // a positive factor, is (sqrt(2) - 1) (sum of the two sides) + corner. Zero for equal pixels, exactly.
  const auto diagonal = [&](int down, int across) {
    return (std::numbers::sqrt2 - 1.0) * (above(down, 0) + above(0, across)) + above(down, across);
  };
  const std::array<bool, kNeighbours> bits = {
      above(0, 1) >= 0.0,  diagonal(-1, 1) >= 0.0, above(-1, 0) >= 0.0, diagonal(-1, -1) >= 0.0,
      above(0, -1) >= 0.0, diagonal(1, -1) >= 0.0, above(1, 0) >= 0.0,  diagonal(1, 1) >= 0.0};
  int set = 0;
  int changes = 0;
  for (int p = 0; p < kNeighbours; ++p) {
    set += bits[p] ? 1 : 0;
    changes += bits[p] != bits[(p + 1) % kNeighbours] ? 1 : 0;
  }
  return changes <= 2 ? set : kNeighbours + 1;
}

TextureMeasures MeasureTexture(const Grid<float>& real, const Grid<float>& simulated, const Mask& real_object,
                               const Mask& simulated_object, const Mask* inside) {
  TextureMeasures texture;
  for (int row = 1; row + 1 < real.rows(); ++row) {
    for (int col = 1; col + 1 < real.cols(); ++col) {
      if (!IsInside(inside, row, col)) continue;
      const int of_real = BinaryPattern(real, row, col);
      const int of_simulated = BinaryPattern(simulated, row, col);
      ++texture.whole.real[of_real];
      ++texture.whole.simulated[of_simulated];
      if (real_object(row, col) != 0 || simulated_object(row, col) != 0) {
        ++texture.union_region.real[of_real];
        ++texture.union_region.simulated[of_simulated];
      }
    }
  }
  return texture;
}

}  // namespace sonarcal::metrics
