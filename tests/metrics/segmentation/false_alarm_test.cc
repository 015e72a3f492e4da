#include "metrics/segmentation/false_alarm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sonarcal::metrics {
namespace {

// The closed form of Rohling 1983, factor by factor.
double OrderedStatisticChance(int count, int rank, double ratio) {
  double chance = 1.0;
  for (int i = 0; i < rank; ++i) chance *= (count - i) / (count - i + ratio);
  return chance;
}

TEST(FalseAlarmTest, OneLookIsAnExponential) {
  EXPECT_NEAR(GammaTailDecades(1.0, 3.0 * std::log(10.0)), 3.0, 1e-12);
  EXPECT_EQ(GammaTailDecades(1.0, 0.0), 0.0);
  EXPECT_EQ(GammaTailDecades(1.0, -1.0), 0.0);
}

TEST(FalseAlarmTest, TwoLooksHaveAClosedForm) {
  // Gamma of shape 2, mean 1: P(x > r) = (1 + 2 r) exp(-2 r).
  for (const double ratio : {0.1, 1.0, 4.0, 12.0}) {
    EXPECT_NEAR(GammaTailDecades(2.0, ratio), -std::log10((1.0 + 2.0 * ratio) * std::exp(-2.0 * ratio)),
                1e-10)
        << ratio;
  }
}

TEST(FalseAlarmTest, AnUnlikelyRatioStaysFinite) {
  EXPECT_EQ(GammaTailDecades(2.0, 1e30), kMaxDecades);
  EXPECT_EQ(GammaTailDecades(1.0, 1e30), kMaxDecades);
  EXPECT_EQ(CellAveragingDecades(3.0, 1e4, 1e30), kMaxDecades);
}

TEST(FalseAlarmTest, CellAveragingOfOneLookIsFinnAndJohnsons) {
  for (const double ratio : {0.5, 5.0, 20.0}) {
    EXPECT_NEAR(CellAveragingDecades(1.0, 16.0, ratio), 16.0 * std::log10(1.0 + ratio / 16.0), 1e-12);
    // The general form beside it.
    EXPECT_NEAR(CellAveragingDecades(1.0 + 1e-9, 16.0, ratio), 16.0 * std::log10(1.0 + ratio / 16.0), 1e-6);
  }
}

TEST(FalseAlarmTest, CellAveragingWithManyTrainingCellsKnowsTheMean) {
  for (const double ratio : {1.5, 3.0, 6.0}) {
    EXPECT_NEAR(CellAveragingDecades(3.0, 1e6, ratio), GammaTailDecades(3.0, ratio), 1e-3);
  }
}

TEST(FalseAlarmTest, AQuantileIsTheInverseOfTheTail) {
  for (const double looks : {0.5, 1.0, 2.0, 2.5, 30.0}) {
    for (const double chance : {0.01, 0.5, 0.9, 0.999}) {
      EXPECT_NEAR(std::pow(10.0, -GammaTailDecades(looks, GammaQuantile(looks, chance))), 1.0 - chance, 1e-9);
    }
  }
}

TEST(FalseAlarmTest, OrderedStatisticOfOneLookIsRohlings) {
  for (const double ratio : {0.3, 2.0, 9.0, 40.0}) {
    EXPECT_NEAR(OrderedStatisticLaw(1.0, 1.0, 32, 24).Decades(ratio),
                -std::log10(OrderedStatisticChance(32, 24, ratio)), 1e-10);
  }
}

TEST(FalseAlarmTest, TheQuadratureOfTheOrderedStatisticAgreesWithTheClosedForm) {
  const OrderedStatisticLaw by_quadrature(1.0 + 1e-9, 1.0, 200, 150);
  for (const double ratio : {0.3, 1.0, 2.0, 4.0, 9.0}) {
    const double exact = -std::log10(OrderedStatisticChance(200, 150, ratio));
    EXPECT_NEAR(by_quadrature.Decades(ratio), exact, 1e-3 * (1.0 + exact)) << ratio;
  }
}

// The end ranks, whose distribution ends at 0 or 1 with a density above 0, and a narrow one.
TEST(FalseAlarmTest, TheQuadratureHoldsForAnyRank) {
  for (const auto& [count, rank] :
       {std::pair{5, 1}, std::pair{5, 5}, std::pair{40, 2}, std::pair{20000, 15000}}) {
    const OrderedStatisticLaw by_quadrature(1.0 + 1e-9, 1.0, count, rank);
    for (const double ratio : {0.3, 1.0, 2.0, 4.0}) {
      const double exact = -std::log10(OrderedStatisticChance(count, rank, ratio));
      EXPECT_NEAR(by_quadrature.Decades(ratio), exact, 1e-3 * (1.0 + exact))
          << rank << " of " << count << ", " << ratio;
    }
  }
}

// Two looks, distributed as 1 - (1 + 2 x) exp(-2 x): the chance integrated over the rank-th smallest x.
TEST(FalseAlarmTest, OrderedStatisticOfTwoLooksIsItsIntegral) {
  constexpr int kCount = 24, kRank = 18;
  const auto tail = [](double x) { return (1.0 + 2.0 * x) * std::exp(-2.0 * x); };
  const OrderedStatisticLaw law(2.0, 2.0, kCount, kRank);
  for (const double ratio : {0.5, 1.5, 3.0, 6.0}) {
    double chance = 0.0, total = 0.0;
    for (double x = 0.0005; x < 12.0; x += 0.001) {
      const double density = std::pow(1.0 - tail(x), kRank - 1) * std::pow(tail(x), kCount - kRank) * 4.0 *
                             x * std::exp(-2.0 * x);
      total += density;
      chance += density * tail(ratio * x);
    }
    const double exact = -std::log10(chance / total);
    EXPECT_NEAR(law.Decades(ratio), exact, 1e-3 * (1.0 + exact)) << ratio;
  }
}

// Threads compute laws at the same time, and std::lgamma writes its sign to a global variable.
TEST(FalseAlarmTest, NoLawWritesTheSignOfTheGammaFunction) {
  constexpr int kUnwritten = 7;
  signgam = kUnwritten;
  EXPECT_GT(GammaTailDecades(1.35, 4.0), 0.0);
  EXPECT_GT(CellAveragingDecades(1.35, 20.0, 4.0), 0.0);
  EXPECT_GT(OrderedStatisticLaw(1.0, 1.0, 20, 15).Decades(4.0), 0.0);
  EXPECT_GT(OrderedStatisticLaw(1.35, 1.35, 20, 15).Decades(4.0), 0.0);
  EXPECT_EQ(signgam, kUnwritten);
}

TEST(FalseAlarmTest, ARatioOfZeroIsNoAlarm) {
  EXPECT_EQ(CellAveragingDecades(3.0, 16.0, 0.0), 0.0);
  EXPECT_EQ(OrderedStatisticLaw(1.0, 1.0, 8, 6).Decades(0.0), 0.0);
  EXPECT_EQ(OrderedStatisticLaw(2.0, 1.0, 8, 6).Decades(0.0), 0.0);
  EXPECT_EQ(OrderedStatisticLaw(2.0, 1.0, 8, 6).Decades(-1.0), 0.0);
}

TEST(FalseAlarmTest, ImpossibleRanksAndChancesAreRefused) {
  EXPECT_THROW(OrderedStatisticLaw(1.0, 1.0, 8, 0), std::logic_error);
  EXPECT_THROW(OrderedStatisticLaw(1.0, 1.0, 8, 9), std::logic_error);
  EXPECT_NO_THROW(OrderedStatisticLaw(1.0, 1.0, 8, 8));
  EXPECT_THROW(GammaQuantile(1.0, 0.0), std::logic_error);
  EXPECT_THROW(GammaQuantile(1.0, 1.0), std::logic_error);
  EXPECT_THROW(LogQuantileLaw(1.0, 0.5, 0.5), std::logic_error);
}

// Beyond its ends a table is constant.
TEST(FalseAlarmTest, ATableEndsAtTheEighthPowerOfE) {
  const DecadesTable table([](double ratio) { return 20.0 + std::log(ratio); });
  EXPECT_NEAR(table(std::exp(-8.0)), 12.0, 1e-12);
  EXPECT_NEAR(table(std::exp(-9.0)), 12.0, 1e-12);
  EXPECT_NEAR(table(std::exp(7.999)), 27.999, 1e-9);
  EXPECT_NEAR(table(std::exp(9.0)), 28.0, 1e-12);
  EXPECT_NEAR(table(std::exp(-0.313)), 19.687, 1e-9);
}

TEST(FalseAlarmTest, ATableIsItsFunction) {
  for (const double looks : {0.7, 3.0, 49.0}) {
    const DecadesTable table([&](double ratio) { return GammaTailDecades(looks, ratio); });
    for (const double ratio : {0.01, 0.3, 0.97, 1.31, 2.07, 5.03, 11.1}) {
      const double exact = GammaTailDecades(looks, ratio);
      EXPECT_NEAR(table(ratio), exact, 1e-3 * (1.0 + exact)) << looks << ", " << ratio;
    }
    EXPECT_EQ(table(0.0), 0.0);
  }
}

// Means of grey on a logarithmic display: against draws of the whole test.
TEST(FalseAlarmTest, LogLawsHoldForLogarithmsOfAnySlope) {
  constexpr int kDraws = 4000000;
  std::mt19937_64 random(11);
  for (const double looks : {1.0, 4.0}) {
    std::gamma_distribution<double> power(looks, 1.0 / looks);
    std::vector<double> grey(kDraws);
    for (double& value : grey) value = 40.0 + 7.3 * std::log(power(random));
    double sum = 0.0, squares = 0.0;
    for (const double value : grey) sum += value;
    const double mean = sum / kDraws;
    for (const double value : grey) squares += (value - mean) * (value - mean);
    const double spread = std::sqrt(squares / kDraws);
    std::sort(grey.begin(), grey.end());
    const double median = grey[kDraws / 2];
    const double quartile = grey[kDraws / 4];
    const LogMeanLaw mean_law(looks);
    const LogQuantileLaw law(looks, 0.25, 0.5);
    for (const double decades : {1.0, 2.0, 3.0}) {
      const double at = grey[static_cast<std::size_t>(kDraws * (1.0 - std::pow(10.0, -decades)))];
      EXPECT_NEAR(mean_law.Decades((at - mean) / spread), decades, 0.02) << looks;
      EXPECT_NEAR(law.Decades((at - median) / (median - quartile)), decades, 0.02) << looks;
    }
  }
}

}  // namespace
}  // namespace sonarcal::metrics
