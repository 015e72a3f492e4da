#include "metrics/bootstrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/math/statistics.h"

namespace sonarcal::metrics {
namespace {

TEST(BootstrapTest, PercentilesInterpolateBetweenOrderStatistics) {
  std::vector<double> draws;
  for (int i = 100; i >= 0; --i) draws.push_back(i);
  EXPECT_EQ(PercentileInterval95(draws), (Interval{2.5, 97.5}));
  EXPECT_EQ(PercentileInterval95({3.0}), (Interval{3.0, 3.0}));
}

TEST(BootstrapTest, FramesAreDrawnWithReplacementAndEvenly) {
  FrameResampler resampler(5);
  std::vector<int> counts(5);
  for (int draw = 0; draw < 10000; ++draw) {
    for (const int index : resampler.Next()) ++counts.at(index);
  }
  for (const int count : counts) EXPECT_NEAR(count, 10000, 400);  // 4.5 sigma
}

TEST(BootstrapTest, ABlockIsARunOfFramesTheLastFollowedByTheFirst) {
  FrameResampler resampler(7, 3);
  bool wrapped = false;
  for (int draw = 0; draw < 200; ++draw) {
    const std::span<const int> indices = resampler.Next();
    ASSERT_EQ(indices.size(), 7U);
    for (const int i : {0, 1, 3, 4}) {
      EXPECT_EQ(indices[i + 1], (indices[i] + 1) % 7);
      wrapped |= indices[i] == 6;
    }
  }
  EXPECT_TRUE(wrapped);
}

std::vector<double> Autoregressive(int count, double phi, std::mt19937_64& random) {
  std::normal_distribution<double> fresh;
  double value = fresh(random) / std::sqrt(1.0 - phi * phi);
  std::vector<double> series;
  for (int i = 0; i < count; ++i) {
    series.push_back(value);
    value = phi * value + fresh(random);
  }
  return series;
}

// For an autoregression of order one, sum |k| R(k) over sum R(k) is 2 phi / (1 - phi^2), whence the optimum
// (3/2)^(1/3) (2 phi / (1 - phi^2))^(2/3) n^(1/3) of Politis & White (2004, Section 3, as corrected). (Where
// phi is small only the first lag stands out, and estimates fall short of it.)
TEST(BootstrapTest, BlocksAreAsLongAsTheTheoryOfAnAutoregressionAsks) {
  for (const double phi : {0.6, 0.8}) {
    std::mt19937_64 random(12);
    std::vector<double> lengths;
    for (int i = 0; i < 101; ++i) {
      lengths.push_back(PolitisWhiteBlockLength(Autoregressive(800, phi, random)));
    }
    const double optimum = std::cbrt(1.5 * std::pow(2.0 * phi / (1.0 - phi * phi), 2) * 800.0);
    EXPECT_NEAR(Median(lengths), optimum, 0.25 * optimum) << "phi " << phi;
  }
}

// The rule of Politis & White (2004, Sections 3 and 3.2) with the correction of 2009, as written there.
int BlockLengthAsPublished(const std::vector<double>& series) {
  const int count = static_cast<int>(series.size());
  const double n = count;
  double mean = 0.0;
  for (const double value : series) mean += value / n;
  const auto r = [&](int k) {
    double sum = 0.0;
    for (int t = 0; t < count - std::abs(k); ++t)
      sum += (series[t] - mean) * (series[t + std::abs(k)] - mean);
    return sum / n;
  };
  // m: the smallest lag that is followed by quiet ones only.
  const int quiet = std::max(5, static_cast<int>(std::ceil(std::sqrt(std::log10(n)))));
  const int last = std::min(count - 1, static_cast<int>(std::ceil(std::sqrt(n))) + quiet);
  const auto is_quiet = [&](int k) {
    return k > last || std::abs(r(k) / r(0)) <= 2.0 * std::sqrt(std::log10(n) / n);
  };
  int m = 0;
  const auto quiet_after = [&] {
    for (int k = 1; k <= quiet; ++k) {
      if (!is_quiet(m + k)) return false;
    }
    return true;
  };
  while (!quiet_after()) ++m;
  const int window = std::min(2 * m, last);
  double g_hat = 0.0;
  double g_of_0 = 0.0;
  for (int k = -window; k <= window; ++k) {
    const double t = window == 0 ? 0.0 : std::abs(static_cast<double>(k) / window);
    const double lambda = t <= 0.5 ? 1.0 : 2.0 * (1.0 - t);
    g_hat += lambda * std::abs(k) * r(k);
    g_of_0 += lambda * r(k);
  }
  const double d = 4.0 / 3.0 * g_of_0 * g_of_0;
  const double length = std::pow(2.0 * g_hat * g_hat / d, 1.0 / 3.0) * std::pow(n, 1.0 / 3.0);
  const double longest = std::ceil(std::min(3.0 * std::sqrt(n), n / 3.0));
  return static_cast<int>(std::max(1.0, std::min(std::ceil(length), longest)));
}

TEST(BootstrapTest, BlockLengthsAreThoseOfThePublishedRule) {
  std::mt19937_64 random(8);
  std::vector<int> lengths;
  for (const double phi : {-0.6, 0.0, 0.3, 0.7, 0.9, 0.98}) {
    for (const int count : {3, 4, 5, 6, 7, 9, 12, 17, 25, 40, 64, 150, 400}) {
      for (int i = 0; i < 10; ++i) {
        const std::vector<double> series = Autoregressive(count, phi, random);
        lengths.push_back(PolitisWhiteBlockLength(series));
        EXPECT_EQ(lengths.back(), BlockLengthAsPublished(series)) << "phi " << phi << ", " << count;
      }
    }
  }
  for (const int count : {30, 400}) {  // as correlated as can be
    std::vector<double> ramp;
    for (int i = 0; i < count; ++i) ramp.push_back(i);
    EXPECT_EQ(PolitisWhiteBlockLength(ramp), BlockLengthAsPublished(ramp)) << count;
  }
  EXPECT_EQ(*std::ranges::min_element(lengths), 1);
  EXPECT_GE(*std::ranges::max_element(lengths), 30);
}

TEST(BootstrapTest, RoundingIsNoCorrelation) {
  for (const double value : {0.1, 1e9 / 3.0, 1e-9 / 7.0}) {
    for (const int count : {7, 49, 200}) {
      EXPECT_EQ(PolitisWhiteBlockLength(std::vector<double>(count, value)), 1) << value << ", " << count;
    }
  }
}

TEST(BootstrapTest, SeriesWithoutCorrelationNeedNoBlocks) {
  std::mt19937_64 random(2);
  int alone = 0;
  for (int i = 0; i < 100; ++i) alone += PolitisWhiteBlockLength(Autoregressive(200, 0.0, random)) <= 2;
  EXPECT_GE(alone, 75);  // a chance correlation among the first lags is taken for one now and then
  EXPECT_EQ(PolitisWhiteBlockLength(std::vector<double>(50, 0.3)), 1);
  EXPECT_EQ(PolitisWhiteBlockLength(std::vector<double>{1.0, 2.0}), 1);
}

TEST(BootstrapTest, BlocksAreNeverLongerThanAThirdOfTheSeries) {
  std::vector<double> ramp;
  for (int i = 0; i < 30; ++i) ramp.push_back(i);
  EXPECT_LE(PolitisWhiteBlockLength(ramp), 10);
  EXPECT_GE(PolitisWhiteBlockLength(ramp), 5);
}

// How many of 200 intervals of the mean hold the true one.
int IntervalsThatHold(double phi, bool in_blocks) {
  std::mt19937_64 random(21);
  int held = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<double> series = Autoregressive(200, phi, random);
    FrameResampler resampler(200, in_blocks ? PolitisWhiteBlockLength(series) : 1);
    std::vector<double> means;
    for (int draw = 0; draw < 400; ++draw) {
      double sum = 0.0;
      for (const int i : resampler.Next()) sum += series[i];
      means.push_back(sum / 200.0);
    }
    const Interval ci = PercentileInterval95(means);
    held += ci.lo <= 0.0 && 0.0 <= ci.hi;
  }
  return held;
}

// The count scatters by 3 (one standard deviation). The interval of blocks is a little narrow at any length,
// as Politis & White found too.
TEST(BootstrapTest, IntervalsOfAnAutoregressionHoldTheTruthAsOftenAsTheySay) {
  EXPECT_GE(IntervalsThatHold(0.0, true), 180);
  EXPECT_GE(IntervalsThatHold(0.5, true), 174);
  EXPECT_LE(IntervalsThatHold(0.5, false), 160) << "frames drawn one by one would not do";
}

}  // namespace
}  // namespace sonarcal::metrics
