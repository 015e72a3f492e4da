// Random numbers that depend only on (seed, stream, index), so a noisy image does not depend on the number of
// threads. Philox 4x32-10 and 2x32-10 (Salmon et al., SC 2011) are counter-based generators that pass
// BigCrush.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace sonarcal {

namespace philox {
inline constexpr int kRounds = 10;
inline constexpr std::uint32_t kMultiplier0 = 0xD2511F53;
inline constexpr std::uint32_t kMultiplier1 = 0xCD9E8D57;
inline constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
inline constexpr std::uint32_t kWeyl1 = 0xBB67AE85;
inline constexpr std::uint32_t kMultiplierOfTwo = 0xD256D193;
}  // namespace philox

inline std::array<std::uint32_t, 4> Philox(std::array<std::uint32_t, 4> counter,
                                           std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < philox::kRounds; ++round) {
    const std::uint64_t p0 = std::uint64_t{philox::kMultiplier0} * counter[0];
    const std::uint64_t p1 = std::uint64_t{philox::kMultiplier1} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += philox::kWeyl0;
    key[1] += philox::kWeyl1;
  }
  return counter;
}

inline std::array<std::uint32_t, 2> Philox2(std::array<std::uint32_t, 2> counter, std::uint32_t key) {
  for (int round = 0; round < philox::kRounds; ++round) {
    const std::uint64_t product = std::uint64_t{philox::kMultiplierOfTwo} * counter[0];
    counter = {static_cast<std::uint32_t>(product >> 32) ^ key ^ counter[1],
               static_cast<std::uint32_t>(product)};
    key += philox::kWeyl0;
  }
  return counter;
}

// Two independent standard normal numbers of a ray (Box-Muller), from two 32-bit words. Resolution 2^-32 in
// probability, magnitude up to 6.7. sim/rays/row_math/errors.h computes the same numbers in bulk.
inline std::pair<double, double> NormalPairOfRay(std::uint64_t seed, std::uint32_t ray) {
  const auto [first, second] =
      Philox2({ray, static_cast<std::uint32_t>(seed >> 32)}, static_cast<std::uint32_t>(seed));
  const double radius = std::sqrt(-2.0 * std::log((first + 0.5) * 0x1p-32));
  const double angle = second * (2.0 * std::numbers::pi * 0x1p-32);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed, std::uint32_t stream = 0)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}, stream_(stream) {}

  // Two independent numbers, uniform in (0, 1).
  std::pair<double, double> Uniform2(std::uint64_t index) const {
    const auto bits = Philox(
        {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), stream_, 0}, key_);
    return {ToUnit(bits[0], bits[1]), ToUnit(bits[2], bits[3])};
  }

  // Two independent standard normal numbers (Box-Muller).
  std::pair<double, double> Normal2(std::uint64_t index) const {
    const auto [u, v] = Uniform2(index);
    const double radius = std::sqrt(-2.0 * std::log(u));
    return {radius * std::cos(2.0 * std::numbers::pi * v), radius * std::sin(2.0 * std::numbers::pi * v)};
  }

 private:
  static double ToUnit(std::uint32_t high, std::uint32_t low) {
    const std::uint64_t bits = (std::uint64_t{high} << 32 | low) >> 11;  // 53 bits
    return (static_cast<double>(bits) + 0.5) * 0x1p-53;
  }

  std::array<std::uint32_t, 2> key_;
  std::uint32_t stream_;
};

}  // namespace sonarcal
