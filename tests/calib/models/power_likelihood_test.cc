#include "calib/models/power_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sonarcal::calib {
namespace {

// Density of p about a mean, without its factor that does not depend on the mean.
double NegativeLogDensity(double p, double mean, double looks) {
  return looks * (std::log(mean) + p / mean);
}

// Distribution function by Simpson's rule in ln p: slow, and shares no code.
double Below(double p, double mean, double looks) {
  const auto integrand = [&](double log_x) {
    const double x = std::exp(log_x);
    return std::exp(looks * std::log(looks) - std::lgamma(looks) + looks * log_x - looks * x);
  };
  const double end = std::log(p / mean);
  const double start = end - 60.0 / looks;
  constexpr int kSteps = 20000;
  const double h = (end - start) / kSteps;
  double sum = integrand(start) + integrand(end);
  for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * integrand(start + i * h);
  return sum * h / 3.0;
}

class PowerLikelihoodTest : public ::testing::TestWithParam<double> {};

TEST_P(PowerLikelihoodTest, HalfTheSquareIsTheLogLikelihoodAboveItsBest) {
  const double looks = GetParam();
  for (const double p : {1e-6, 0.3, 0.99999, 1.0, 1.00001, 2.0, 40.0}) {
    for (const double mean : {0.2, 1.0, 1.0001, 7.0}) {
      const double residual = PowerLikelihood({p, Censoring::kNone}, mean, looks).residual;
      EXPECT_NEAR(0.5 * residual * residual,
                  NegativeLogDensity(p, mean, looks) - NegativeLogDensity(p, p, looks), 1e-9 * (1 + p / mean))
          << p << " about " << mean;
      EXPECT_EQ(residual > 0.0, mean > p);
    }
  }
}

TEST_P(PowerLikelihoodTest, ClippedPixelsContributeTheirProbability) {
  const double looks = GetParam();
  for (const double p : {0.01, 0.5, 3.0}) {
    for (const double mean : {0.3, 1.0, 5.0}) {
      const double below = Below(p, mean, looks);
      const double low = PowerLikelihood({p, Censoring::kAtMost}, mean, looks).residual;
      EXPECT_NEAR(std::exp(-0.5 * low * low), below, 1e-7);
      const double high = PowerLikelihood({p, Censoring::kAtLeast}, mean, looks).residual;
      EXPECT_NEAR(std::exp(-0.5 * high * high), 1.0 - below, 1e-7);
    }
  }
}

TEST_P(PowerLikelihoodTest, SlopesEqualCentralDifferences) {
  const double looks = GetParam();
  for (const Censoring censoring : {Censoring::kNone, Censoring::kAtMost, Censoring::kAtLeast}) {
    for (const double p : {1e-4, 0.4, 0.99995, 1.0, 1.00005, 6.0, 30.0}) {
      const auto at = [&](double eta) { return PowerLikelihood({p, censoring}, std::exp(eta), looks); };
      const double h = 1e-6;
      const double difference = (at(h).residual - at(-h).residual) / (2.0 * h);
      EXPECT_NEAR(at(0.0).slope, difference, 1e-6 * (1.0 + std::abs(difference)))
          << p << ", " << static_cast<int>(censoring);
    }
  }
}

// Far out in either tail nothing overflows, and the pull is towards the recorded power.
TEST_P(PowerLikelihoodTest, StaysFiniteInTheTails) {
  for (const Censoring censoring : {Censoring::kNone, Censoring::kAtMost, Censoring::kAtLeast}) {
    for (const double ratio : {1e-280, 1e-30, 1e-9, 1e9}) {
      const LikelihoodTerm term = PowerLikelihood({ratio, censoring}, 1.0, GetParam());
      EXPECT_TRUE(std::isfinite(term.residual));
      EXPECT_TRUE(std::isfinite(term.slope));
    }
  }
}

// Against the same expectation by brute force: the mean square of the scores over the law itself.
TEST_P(PowerLikelihoodTest, InformationIsTheMeanSquareOfTheScore) {
  const double looks = GetParam();
  for (const auto& [lowest, highest] : {std::pair(0.0, 1e9), std::pair(0.5, 1e9), std::pair(3.0, 1e9),
                                        std::pair(0.01, 2.0), std::pair(1e-3, 0.3)}) {
    const auto score = [&](const RecordedPower& recorded) {
      const LikelihoodTerm term = PowerLikelihood(recorded, 1.0, looks);
      return term.residual * term.slope;
    };
    double sum = 0.0;
    constexpr int kSteps = 200000;
    const double low = std::log(1e-12);
    const double high = std::log(100.0);
    const double h = (high - low) / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double x = std::exp(low + (i + 0.5) * h);
      const double density =
          std::exp(looks * std::log(looks) - std::lgamma(looks) + looks * std::log(x) - looks * x);
      RecordedPower recorded{x, Censoring::kNone};
      if (x <= lowest) recorded = {lowest, Censoring::kAtMost};
      if (x >= highest) recorded = {highest, Censoring::kAtLeast};
      sum += h * density * std::pow(score(recorded), 2);
    }
    EXPECT_NEAR(ExpectedInformation(lowest, highest, 1.0, looks), sum, 1e-3 * looks)
        << lowest << " to " << highest;
  }
}

// Powers and display ends of nothing and without end, against the limits that they have.
TEST_P(PowerLikelihoodTest, HasItsLimitsAtTheEndsOfTheDomain) {
  const double looks = GetParam();
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  for (const double mean : {kLeast, 1e-300, 1.0, 1e300}) {
    for (const Censoring censoring : {Censoring::kNone, Censoring::kAtMost, Censoring::kAtLeast}) {
      for (const double power : {0.0, kLeast, 1e300, kEnd}) {
        const LikelihoodTerm term = PowerLikelihood({power, censoring}, mean, looks);
        EXPECT_TRUE(std::isfinite(term.residual) && std::isfinite(term.slope))
            << power << " about " << mean << ", " << static_cast<int>(censoring);
      }
    }
    EXPECT_EQ(PowerLikelihood({kEnd, Censoring::kAtMost}, mean, looks).residual, 0.0);
    EXPECT_NEAR(PowerLikelihood({0.0, Censoring::kAtLeast}, mean, looks).slope, 0.0, 1e-100);
    EXPECT_EQ(PowerLikelihood({0.0, Censoring::kAtMost}, mean, looks).slope, 0.0)
        << "no mean makes nothing likelier than another";
    EXPECT_EQ(ExpectedInformation(0.0, kEnd, mean, looks), looks);
  }
  EXPECT_NEAR(ExpectedInformation(1e300, kEnd, 1.0, looks), 0.0, 1e-12) << "all clipped at the bottom";
  EXPECT_EQ(ExpectedInformation(1.0, 2.0, kLeast, looks), 0.0) << "the ratio to the mean has no end";
  EXPECT_NEAR(ExpectedInformation(0.0, 1e-300, 1.0, looks), 0.0, 1e-12) << "all clipped at the top";
}

// Beyond the range of numbers. Below, F(x) = (L x)^L / Gamma(L + 1) falls as x^L and counts as 1e-290. Above,
// 1 - F(x) = exp(-L x).
TEST(PowerLikelihoodTailTest, TermsOfBothTailsInClosedForm) {
  const double lowest = std::sqrt(2.0 * 290.0 * std::log(10.0));
  EXPECT_NEAR(PowerLikelihood({0.0, Censoring::kAtMost}, 1.0, 1.4).residual, lowest, 1e-12);
  const LikelihoodTerm below = PowerLikelihood({1e-200, Censoring::kAtMost}, 1.0, 4.0);
  EXPECT_NEAR(below.residual, lowest, 1e-12);
  EXPECT_NEAR(below.slope, 4.0 / lowest, 1e-12);
  for (const double looks : {1.0, 1.4, 4.0}) {
    const LikelihoodTerm above = PowerLikelihood({2e4, Censoring::kAtLeast}, 2.0, looks);
    EXPECT_NEAR(above.residual, std::sqrt(2e4 * looks), 1e-9);
    EXPECT_NEAR(above.slope, -std::sqrt(5e3 * looks), 1e-9);
  }
}

TEST(PowerLikelihoodTailTest, InformationDependsOnRatiosToTheMean) {
  for (const double looks : {1.0, 1.4}) {
    EXPECT_NEAR(ExpectedInformation(3.5, 21.0, 7.0, looks), ExpectedInformation(0.5, 3.0, 1.0, looks), 1e-12);
    EXPECT_GT(ExpectedInformation(0.5, 9.0, 1.0, looks) - ExpectedInformation(0.5, 3.0, 1.0, looks), 0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(Looks, PowerLikelihoodTest, ::testing::Values(1.0, 1.4, 2.0, 4.0));

}  // namespace
}  // namespace sonarcal::calib
