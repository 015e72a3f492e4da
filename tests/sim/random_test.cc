#include "sim/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sonarcal {
namespace {

using Counter = std::array<std::uint32_t, 4>;

// Known answers of the authors' own library, Random123 (kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(Philox({0, 0, 0, 0}, {0, 0}), (Counter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(Philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Counter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(Philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Counter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
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
  const double n = static_cast<double>(sample.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double p = cdf(sample[i]);
    distance = std::max({distance, static_cast<double>(i + 1) / n - p, p - static_cast<double>(i) / n});
  }
  return distance;
}

TEST(CounterRandom, UniformAndNormal) {
  constexpr int kCount = 100'000;
  const CounterRandom random(42);
  std::vector<double> uniform;
  std::vector<double> first;
  std::vector<double> second;
  double product = 0.0;
  double product_of_squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const auto [u, v] = random.Uniform2(i);
    ASSERT_GT(std::min(u, v), 0.0);
    ASSERT_LT(std::max(u, v), 1.0);
    uniform.push_back(u);
    const auto [x, y] = random.Normal2(i);
    first.push_back(x);
    second.push_back(y);
    product += x * y;
    product_of_squares += (x * x - 1.0) * (y * y - 1.0);
  }
  const double critical = 2.69 / std::sqrt(kCount);
  const auto normal_cdf = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  EXPECT_LT(KolmogorovDistance(uniform, [](double u) { return u; }), critical);
  EXPECT_LT(KolmogorovDistance(first, normal_cdf), critical);
  EXPECT_LT(KolmogorovDistance(second, normal_cdf), critical);
  // Standard errors of the two sums: sqrt(n), and sqrt(n) times the variance 2 of a squared normal.
  EXPECT_LT(std::abs(product), 4.9 * std::sqrt(kCount));
  EXPECT_LT(std::abs(product_of_squares), 4.9 * 2.0 * std::sqrt(kCount));
}

}  // namespace
}  // namespace sonarcal
