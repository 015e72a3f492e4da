#include "core/math/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sonarcal {
namespace {

using Counter = std::array<std::uint32_t, 4>;

// Known answers of the authors' own library, Random123 (kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, FourWordsEqualTheKnownAnswersOfRandom123) {
  EXPECT_EQ(Philox({0, 0, 0, 0}, {0, 0}), (Counter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(Philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Counter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(Philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Counter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// Likewise, philox2x32 with 10 rounds.
TEST(Philox2, TwoWordsEqualTheKnownAnswersOfRandom123) {
  using Words = std::array<std::uint32_t, 2>;
  EXPECT_EQ(Philox2({0, 0}, 0), (Words{0xff1dae59, 0x6cd10df2}));
  EXPECT_EQ(Philox2({0xffffffff, 0xffffffff}, 0xffffffff), (Words{0x2c3f628b, 0xab4fd7ad}));
  EXPECT_EQ(Philox2({0x243f6a88, 0x85a308d3}, 0x13198a2e), (Words{0xdd7ce038, 0xf62a4c12}));
}

TEST(CounterRandom, EverythingOfItsKeyMatters) {
  const auto at = [](std::uint64_t seed, std::uint32_t stream, std::uint64_t index) {
    return CounterRandom(seed, stream).Uniform2(index);
  };
  const auto base = at(1, 0, 7);
  EXPECT_EQ(at(1, 0, 7), base);
  EXPECT_NE(at(2, 0, 7), base);
  EXPECT_NE(at(1 + (std::uint64_t{1} << 32), 0, 7), base);
  EXPECT_NE(at(1, 1, 7), base);
  EXPECT_NE(at(1, 0, 8), base);
  EXPECT_NE(at(1, 0, 7 + (std::uint64_t{1} << 32)), base);
}

// Largest distance between a sample's distribution and `cdf`; the probability to exceed c / sqrt(n) is about
// 2 exp(-2 c^2): 1e-6 at c = 2.69.
template <typename Cdf>
double KolmogorovDistance(std::vector<double> sample, const Cdf& cdf) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double p = cdf(sample[i]);
    distance = std::max({distance, static_cast<double>(i + 1) / n - p, p - static_cast<double>(i) / n});
  }
  return distance;
}

constexpr int kCount = 100'000;
constexpr double kCritical = 2.69;

// `pair(i)`, i = 0 .. kCount - 1: two independent standard normal numbers each.
template <typename Pair>
void ExpectNormalPairs(const Pair& pair) {
  std::vector<double> first;
  std::vector<double> second;
  double product = 0.0;
  double product_of_squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const auto [x, y] = pair(i);
    first.push_back(x);
    second.push_back(y);
    product += x * y;
    product_of_squares += (x * x - 1.0) * (y * y - 1.0);
  }
  const auto normal_cdf = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  EXPECT_LT(KolmogorovDistance(first, normal_cdf), kCritical / std::sqrt(kCount));
  EXPECT_LT(KolmogorovDistance(second, normal_cdf), kCritical / std::sqrt(kCount));
  // Standard errors of the two sums: sqrt(n), and sqrt(n) times the variance 2 of a squared normal.
  EXPECT_LT(std::abs(product), 4.9 * std::sqrt(kCount));
  EXPECT_LT(std::abs(product_of_squares), 4.9 * 2.0 * std::sqrt(kCount));
}

TEST(CounterRandom, DrawsFollowTheUniformAndTheNormalLaw) {
  const CounterRandom random(42);
  std::vector<double> uniform;
  for (int i = 0; i < kCount; ++i) {
    const auto [u, v] = random.Uniform2(i);
    ASSERT_GT(std::min(u, v), 0.0);
    ASSERT_LT(std::max(u, v), 1.0);
    uniform.push_back(u);
  }
  EXPECT_LT(KolmogorovDistance(uniform, [](double u) { return u; }), kCritical / std::sqrt(kCount));
  ExpectNormalPairs([&](int i) { return random.Normal2(i); });
}

TEST(NormalPairOfRay, IsNormalOverRaysAndSeeds) {
  ExpectNormalPairs([](int ray) { return NormalPairOfRay(42, ray); });
  ExpectNormalPairs([](int seed) { return NormalPairOfRay(seed, 7); });
  ExpectNormalPairs([](int seed) { return NormalPairOfRay(static_cast<std::uint64_t>(seed) << 32, 7); });
}

}  // namespace
}  // namespace sonarcal
