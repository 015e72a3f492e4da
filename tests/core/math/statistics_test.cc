#include "core/math/statistics.h"

#include <gtest/gtest.h>

#include <random>

namespace sonarcal {
namespace {

std::vector<double> RandomSample(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> tenths(-50, 50);  // few enough values to make ties
  std::vector<double> sample;
  for (int i = 0; i < count; ++i) sample.push_back(0.1 * tenths(random));
  return sample;
}

TEST(StatisticsTest, RankedValueIsThatOfTheSortedSample) {
  for (int count = 1; count < 30; ++count) {
    const std::vector<double> sample = RandomSample(count, static_cast<unsigned>(count));
    std::vector<double> sorted = sample;
    std::sort(sorted.begin(), sorted.end());
    for (int rank = 0; rank < count; ++rank)
      EXPECT_EQ(RankedValue(sample, static_cast<std::size_t>(rank)), sorted[rank]);
  }
}

TEST(StatisticsTest, MedianOfAnEvenCountIsTheMeanOfTheTwoMiddleValues) {
  EXPECT_EQ(Median(std::vector<double>{3.0}), 3.0);
  EXPECT_EQ(Median(std::vector<double>{5.0, 1.0}), 3.0);
  EXPECT_EQ(Median(std::vector<float>{9.0F, 1.0F, 4.0F}), 4.0);
  EXPECT_EQ(Median(std::vector<double>{9.0, 1.0, 5.0, 2.0}), 3.5);
  EXPECT_EQ(Median(std::vector<double>{2.0, 2.0, 2.0, 7.0}), 2.0);
  for (int count = 1; count < 30; ++count) {
    const std::vector<double> sample = RandomSample(count, static_cast<unsigned>(100 + count));
    EXPECT_DOUBLE_EQ(Median(sample), Quantile(sample, 0.5)) << count;
  }
}

TEST(StatisticsTest, UpperMedianIsAValueOfTheSample) {
  EXPECT_EQ(UpperMedian(std::vector<double>{3.0}), 3.0);
  EXPECT_EQ(UpperMedian(std::vector<double>{5.0, 1.0}), 5.0);
  EXPECT_EQ(UpperMedian(std::vector<float>{9.0F, 1.0F, 4.0F}), 4.0F);
  EXPECT_EQ(UpperMedian(std::vector<double>{9.0, 1.0, 5.0, 2.0}), 5.0);
}

// On 0, 10 .. 100 the place is the value over ten.
TEST(StatisticsTest, QuantilesRoundDownUpOrLieBetween) {
  std::vector<double> sample;
  for (int i = 10; i >= 0; --i) sample.push_back(10.0 * i);
  for (const double share : {0.0, 0.1, 0.234, 0.5, 0.99, 1.0}) {
    EXPECT_NEAR(Quantile(sample, share), 100.0 * share, 1e-12) << share;
    EXPECT_EQ(LowerQuantile(sample, share), 10.0 * std::floor(10.0 * share)) << share;
    EXPECT_EQ(UpperQuantile(sample, share), 10.0 * std::max(0.0, std::ceil(11.0 * share) - 1.0)) << share;
  }
}

// The definition of a nearest-rank quantile, by counting.
TEST(StatisticsTest, UpperQuantileIsTheSmallestValueThatTheShareDoesNotExceed) {
  const std::vector<double> sample = RandomSample(37, 3);
  for (const double share : {0.05, 0.3, 0.5, 0.95, 0.999}) {
    const double value = UpperQuantile(sample, share);
    const auto at_most = [&](double limit) {
      return static_cast<double>(
          std::count_if(sample.begin(), sample.end(), [&](double v) { return v <= limit; }));
    };
    EXPECT_GE(at_most(value), share * 37.0) << share;
    EXPECT_LT(at_most(std::nextafter(value, -1e9)), share * 37.0) << share;
  }
}

// A normal sample: the median absolute deviation times kSigmaPerMad is its standard deviation.
TEST(StatisticsTest, MedianAbsoluteDeviationGivesTheSpreadOfANormalLaw) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(3.0, 2.0);
  std::vector<double> off;
  for (int i = 0; i < 100001; ++i) off.push_back(std::abs(normal(random) - 3.0));
  EXPECT_NEAR(kSigmaPerMad * Median(off), 2.0, 0.02);
}

TEST(StatisticsTest, EmptySamplesAndSharesBeyondOneAreRefused) {
  const std::vector<double> none;
  EXPECT_THROW(Median(none), std::logic_error);
  EXPECT_THROW(UpperMedian(none), std::logic_error);
  EXPECT_THROW(Quantile(none, 0.5), std::logic_error);
  EXPECT_THROW(LowerQuantile(none, 0.5), std::logic_error);
  EXPECT_THROW(UpperQuantile(none, 0.5), std::logic_error);
  EXPECT_THROW(RankedValue(std::vector<double>{1.0}, 1), std::logic_error);
  EXPECT_THROW(Quantile({1.0, 2.0}, 1.1), std::logic_error);
}

}  // namespace
}  // namespace sonarcal
