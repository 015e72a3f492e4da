#include "core/math/distribution.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace sonarcal {
namespace {

using Shares = std::vector<double>;

using Distance = double (*)(std::span<const double>, std::span<const double>);
constexpr Distance kDistances[] = {HistogramL1Half, WassersteinLevels, KolmogorovSmirnov, Hellinger,
                                   UpperTailAndersonDarling};

Shares RandomShares(std::mt19937_64& random, int levels) {
  std::exponential_distribution<double> draw;
  Shares shares;
  double sum = 0.0;
  for (int i = 0; i < levels; ++i) sum += shares.emplace_back(draw(random));
  for (double& share : shares) share /= sum;
  return shares;
}

TEST(DistributionTest, EqualOnesAreAtNoDistanceAndSwappingChangesNothing) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20; ++i) {
    const Shares p = RandomShares(random, 16);
    const Shares q = RandomShares(random, 16);
    for (const Distance distance : kDistances) {
      EXPECT_NEAR(distance(p, p), 0.0, 1e-7);  // Hellinger: the root of a rounding
      EXPECT_DOUBLE_EQ(distance(p, q), distance(q, p));
      EXPECT_GT(distance(p, q), 0.0);
    }
  }
}

TEST(DistributionTest, DistancesEqualThoseByHand) {
  const Shares p = {0.5, 0.5, 0.0, 0.0};
  const Shares q = {0.25, 0.25, 0.25, 0.25};  // F - G = .25, .5, .25, 0
  EXPECT_DOUBLE_EQ(HistogramL1Half(p, q), 0.5);
  EXPECT_DOUBLE_EQ(WassersteinLevels(p, q), 1.0);
  EXPECT_DOUBLE_EQ(KolmogorovSmirnov(p, q), 0.5);
  EXPECT_DOUBLE_EQ(Hellinger(p, q), std::sqrt(1.0 - 2.0 * std::sqrt(0.125)));
  // H = .375, .75, .875, 1 in steps of .375, .375, .125, .125.
  EXPECT_DOUBLE_EQ(UpperTailAndersonDarling(p, q),
                   0.0625 / 0.625 * 0.375 + 0.25 / 0.25 * 0.375 + 0.0625 / 0.125 * 0.125);
}

TEST(DistributionTest, OnesThatShareNoLevelAreAtTheirLargestDistance) {
  Shares low(2000, 0.0), high(2000, 0.0);
  for (int i = 0; i < 1000; ++i) low[i] = high[i + 1000] = 1e-3;
  EXPECT_NEAR(HistogramL1Half(low, high), 1.0, 1e-12);
  EXPECT_NEAR(WassersteinLevels(low, high), 1000.0, 1e-9);
  EXPECT_NEAR(KolmogorovSmirnov(low, high), 1.0, 1e-12);
  EXPECT_NEAR(Hellinger(low, high), 1.0, 1e-12);
  // In the limit of fine levels: (2 H)^2 / (1 - H) up to H = 1/2, then (2 - 2 H)^2 / (1 - H).
  EXPECT_NEAR(UpperTailAndersonDarling(low, high), 4.0 * std::numbers::ln2 - 2.0, 2e-3);
}

// At the first level (1 - 0)^2 / (1/2) times 1/2, then the integral of 1 - G over G.
TEST(DistributionTest, UpperTailIsLargestBetweenOneLevelAndManyFineOnesAboveIt) {
  constexpr int kFine = 4000;
  Shares one(kFine + 1, 0.0), many(kFine + 1, 1.0 / kFine);
  one[0] = 1.0;
  many[0] = 0.0;
  EXPECT_NEAR(UpperTailAndersonDarling(one, many), 1.5, 1e-3);
  std::mt19937_64 random(5);
  for (int i = 0; i < 200; ++i) {
    EXPECT_LT(UpperTailAndersonDarling(RandomShares(random, 2), RandomShares(random, 2)), 1.5);
    EXPECT_LT(UpperTailAndersonDarling(RandomShares(random, 12), RandomShares(random, 12)), 1.5);
  }
}

// The slow, obvious way: every pair of sorted pixels, and the pooled distribution pixel by pixel.
TEST(DistributionTest, AgreeWithTheirDefinitionsOnPixels) {
  constexpr int kLevels = 32, kPixels = 500;
  std::mt19937_64 random(8);
  std::binomial_distribution<int> real(kLevels - 1, 0.4), simulated(kLevels - 1, 0.5);
  std::vector<int> a, b;
  Shares p(kLevels), q(kLevels);
  for (int i = 0; i < kPixels; ++i) {
    a.push_back(real(random));
    b.push_back(simulated(random));
    p[a.back()] += 1.0 / kPixels;
    q[b.back()] += 1.0 / kPixels;
  }
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double moved = 0.0;
  for (int i = 0; i < kPixels; ++i) moved += std::abs(a[i] - b[i]);
  EXPECT_NEAR(WassersteinLevels(p, q), moved / kPixels, 1e-9);

  const auto share_up_to = [](const std::vector<int>& values, int level) {
    const auto below = std::count_if(values.begin(), values.end(), [&](int v) { return v <= level; });
    return static_cast<double>(below) / kPixels;
  };
  std::vector<int> pooled = a;
  pooled.insert(pooled.end(), b.begin(), b.end());
  double largest = 0.0, upper_tail = 0.0;
  for (const int level : pooled) {
    const double f = share_up_to(a, level), g = share_up_to(b, level);
    largest = std::max(largest, std::abs(f - g));
    const double above = 1.0 - 0.5 * (f + g);
    if (above > 1e-9) upper_tail += (f - g) * (f - g) / above / (2.0 * kPixels);
  }
  EXPECT_NEAR(KolmogorovSmirnov(p, q), largest, 1e-9);
  EXPECT_NEAR(UpperTailAndersonDarling(p, q), upper_tail, 1e-9);
}

TEST(DistributionTest, TheUpperTailWeighsMoreThanTheLower) {
  // The same twentieth moved by one level, at the top and at the bottom.
  const Shares even(20, 0.05);
  Shares top = even, bottom = even;
  top[18] += 0.05;
  top[19] = 0.0;
  bottom[1] += 0.05;
  bottom[0] = 0.0;
  EXPECT_NEAR(KolmogorovSmirnov(even, top), KolmogorovSmirnov(even, bottom), 1e-12);
  EXPECT_GT(UpperTailAndersonDarling(even, top), 5.0 * UpperTailAndersonDarling(even, bottom));
}

}  // namespace
}  // namespace sonarcal
