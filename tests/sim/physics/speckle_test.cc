#include "sim/physics/speckle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/math/random.h"
#include "core/types/units.h"
#include "sim/physics/frozen_speckle.h"
#include "sim/physics/k_diffuse_law.h"

namespace sonarcal::sim {
namespace {

const std::vector<DisplayParameters<double>> kDisplays = {
    {.db_min = 0.0, .db_max = 60.0},
    {.db_min = 0.0, .db_max = 60.0, .law = DisplayLaw::kSoftLog, .soft_db = -1.8},
    {.db_min = 0.0, .db_max = 60.0, .law = DisplayLaw::kSoftAmplitude, .soft_db = -1.8},
    {.db_min = 0.0, .db_max = 30.0, .law = DisplayLaw::kPower, .exponent = 0.5}};

TEST(SpeckleTest, CumulativeFunctionsHaveTheirClosedForms) {
  for (const double x : {1e-6, 0.1, 1.0, 3.0, 20.0}) {
    EXPECT_NEAR(SpeckleCdf(1.0, x), 1.0 - std::exp(-x), 1e-12);
    EXPECT_NEAR(SpeckleCdf(2.0, x), 1.0 - std::exp(-2.0 * x) * (1.0 + 2.0 * x), 1e-12);
    EXPECT_NEAR(SpeckleCdf(1.0 + 1e-9, x), SpeckleCdf(1.0, x), 1e-7);
    EXPECT_NEAR(SpeckleCdf(1.0, x, SpeckleLaw::kWeighted), SpeckleCdf(1.0, x), 1e-12);
    EXPECT_NEAR(SpeckleCdf(2.0, x, SpeckleLaw::kWeighted), SpeckleCdf(2.0, x), 1e-12);
    EXPECT_NEAR(SpeckleCdf(2.0 - 1e-7, x, SpeckleLaw::kWeighted), SpeckleCdf(2.0, x), 1e-4);
  }
  EXPECT_EQ(SpeckleCdf(1.4, 0.0), 0.0);
  EXPECT_EQ(SpeckleCdf(1.4, -1.0), 0.0);
}

TEST(SpeckleTest, TwoLooksHaveTheirClosedFormsUnderEveryLaw) {
  for (const SpeckleLaw law : {SpeckleLaw::kGamma, SpeckleLaw::kWeighted, SpeckleLaw::kK}) {
    for (const double x : {1e-3, 0.1, 1.0, 3.0, 20.0}) {
      EXPECT_NEAR(SpeckleSurvival(2.0, x, law), std::exp(-2.0 * x) * (1.0 + 2.0 * x), 1e-12);
      EXPECT_NEAR(SpeckleDensity(2.0, x, law), 4.0 * x * std::exp(-2.0 * x), 1e-12);
    }
  }
}

TEST(SpeckleTest, TheKLawIsAGammaLawFromOneLookOn) {
  for (const double looks : {1.0, 1.5, 1.9}) {
    for (const double x : {0.1, 1.0, 3.0}) {
      EXPECT_EQ(SpeckleCdf(looks, x, SpeckleLaw::kK), SpeckleCdf(looks, x));
      EXPECT_EQ(SpeckleSurvival(looks, x, SpeckleLaw::kK), SpeckleSurvival(looks, x));
      EXPECT_EQ(SpeckleDensity(looks, x, SpeckleLaw::kK), SpeckleDensity(looks, x));
    }
  }
}

TEST(SpeckleTest, InfiniteAndNegativeRatiosAreTheEnds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const SpeckleLaw law : {SpeckleLaw::kGamma, SpeckleLaw::kWeighted, SpeckleLaw::kK}) {
    for (const double looks : {1.0, 1.3, 3.0}) {
      EXPECT_EQ(SpeckleCdf(looks, kInfinity, law), 1.0);
      EXPECT_EQ(SpeckleSurvival(looks, kInfinity, law), 0.0);
      EXPECT_EQ(SpeckleDensity(looks, kInfinity, law), 0.0);
      EXPECT_EQ(SpeckleCdf(looks, -1.0, law), 0.0);
      EXPECT_EQ(SpeckleSurvival(looks, -1.0, law), 1.0);
      EXPECT_EQ(SpeckleDensity(looks, -1.0, law), 0.0);
    }
  }
}

// Gamma of half a look: the square of a normal variable.
TEST(SpeckleTest, HalfALookIsASquaredNormalVariable) {
  for (const double x : {0.01, 0.5, 3.0}) {
    EXPECT_NEAR(SpeckleSurvival(0.5, x), std::erfc(std::sqrt(0.5 * x)), 1e-12);
    EXPECT_NEAR(SpeckleCdf(0.5, x), std::erf(std::sqrt(0.5 * x)), 1e-12);
    EXPECT_NEAR(SpeckleDensity(0.5, x), std::exp(-0.5 * x) / std::sqrt(2.0 * std::numbers::pi * x), 1e-12);
  }
}

TEST(SpeckleTest, SurvivalKeepsItsDigitsInTheTail) {
  for (const SpeckleLaw law : {SpeckleLaw::kGamma, SpeckleLaw::kWeighted}) {
    for (const double looks : {1.0, 1.35, 3.0}) {
      for (const double x : {0.0, 0.05, 0.8, 4.0}) {
        EXPECT_NEAR(SpeckleSurvival(looks, x, law), 1.0 - SpeckleCdf(looks, x, law), 1e-12);
      }
      // Far out, the logarithm falls by density / survival.
      const double step = std::log(SpeckleSurvival(looks, 60.0, law) / SpeckleSurvival(looks, 60.002, law));
      EXPECT_NEAR(step / 0.002, SpeckleDensity(looks, 60.001, law) / SpeckleSurvival(looks, 60.001, law),
                  1e-6);
    }
  }
}

// Texture of shape nu = 1/2 and 3/2, for which the Bessel functions are elementary.
TEST(SpeckleTest, KLawHasItsClosedForms) {
  for (const double x : {1e-9, 1e-3, 0.1, 1.0, 3.0, 20.0}) {
    const double half = 2.0 * std::sqrt(0.5 * x);
    EXPECT_NEAR(SpeckleSurvival(0.2, x, SpeckleLaw::kK), std::exp(-half), 1e-12);
    EXPECT_NEAR(SpeckleDensity(0.2, x, SpeckleLaw::kK) * half, std::exp(-half), 1e-12);
    const double three = 2.0 * std::sqrt(1.5 * x);
    EXPECT_NEAR(SpeckleSurvival(3.0 / 7.0, x, SpeckleLaw::kK), (1.0 + three) * std::exp(-three), 1e-12);
    EXPECT_NEAR(SpeckleDensity(3.0 / 7.0, x, SpeckleLaw::kK), 3.0 * std::exp(-three), 1e-12);
  }
}

// By numbers: the exponential law of a mean that is Gamma distributed, over the logarithm of the mean.
TEST(SpeckleTest, KLawIsOneLookOfAGammaDistributedMean) {
  for (const double looks : {0.25, 0.6, 0.9}) {
    const double shape = 2.0 * looks / (1.0 - looks);
    for (const double x : {1e-4, 0.3, 2.0, 9.0}) {
      double survival = 0.0;
      double density = 0.0;
      constexpr double kStep = 2e-3;
      for (double log_mean = -40.0; log_mean < 8.0; log_mean += kStep) {
        const double mean = std::exp(log_mean);
        const double weight =
            kStep * std::exp(shape * (std::log(shape) + log_mean - mean) - std::lgamma(shape));
        survival += weight * std::exp(-x / mean);
        density += weight * std::exp(-x / mean) / mean;
      }
      EXPECT_NEAR(SpeckleSurvival(looks, x, SpeckleLaw::kK), survival, 1e-9);
      EXPECT_NEAR(SpeckleCdf(looks, x, SpeckleLaw::kK), 1.0 - survival, 1e-9);
      EXPECT_NEAR(SpeckleDensity(looks, x, SpeckleLaw::kK), density, 1e-8 * density + 1e-9);
    }
  }
}

// Where the Bessel function overflows: 1 - x E[1 / mean] holds, and E[1 / mean] is shape / (shape - 1).
// Where it underflows, nothing is left; just before, the closed form of shape 1/2 holds.
TEST(SpeckleTest, KLawHoldsWhereItsBesselFunctionIsOutOfRange) {
  constexpr double kShape = 49.0;
  constexpr double kLooks = kShape / (kShape + 2.0);
  for (const double x : {1e-12, 1e-13}) {
    EXPECT_NEAR((1.0 - SpeckleSurvival(kLooks, x, SpeckleLaw::kK)) / x, kShape / (kShape - 1.0), 2e-3);
    EXPECT_NEAR(SpeckleDensity(kLooks, x, SpeckleLaw::kK), kShape / (kShape - 1.0), 1e-9);
  }
  const auto ratio_at = [](double argument) { return argument * argument / 2.0; };
  EXPECT_NEAR(std::log(SpeckleSurvival(0.2, ratio_at(690.0), SpeckleLaw::kK)), -690.0, 1e-9);
  EXPECT_NEAR(std::log(SpeckleDensity(0.2, ratio_at(690.0), SpeckleLaw::kK)), -690.0 - std::log(690.0), 1e-9);
  for (const double argument : {760.0, 1300.0}) {
    EXPECT_EQ(SpeckleSurvival(0.2, ratio_at(argument), SpeckleLaw::kK), 0.0);
    EXPECT_EQ(SpeckleDensity(0.2, ratio_at(argument), SpeckleLaw::kK), 0.0);
  }
}

// By numbers: the sum of two exponential variables, over steps of the second.
TEST(SpeckleTest, WeightedLooksHaveTheirLawBetweenOneAndTwo) {
  for (const double looks : {1.0 + 1e-10, 1.0 + 1e-6, 1.01, 1.5, 1.99, 2.0 - 1e-9}) {
    const double w = LooksAsWeights(looks).second;
    for (const double x : {0.01, 0.6, 4.0}) {
      double cdf = 0.0;
      double survival = 0.0;
      double density = 0.0;
      constexpr int kSteps = 20000;
      for (int i = 0; i < kSteps; ++i) {  // midpoints of the second variable, from 0 to x
        const double width = x / kSteps;
        const double second = (i + 0.5) * width;
        // Mean density of the second variable within the step: it is narrow for small w.
        const double rate = (1.0 + w) / std::max(w, 1e-12);
        const double share = std::exp(-rate * (second - 0.5 * width)) * -std::expm1(-rate * width);
        cdf += share * -std::expm1(-(1.0 + w) * (x - second));
        density += share * (1.0 + w) * std::exp(-(1.0 + w) * (x - second));
        survival += share * std::exp(-(1.0 + w) * (x - second));
      }
      survival += std::exp(-(1.0 + w) / std::max(w, 1e-12) * x);
      const double tolerance = 2e-4 * x + 1e-9;
      EXPECT_NEAR(SpeckleCdf(looks, x, SpeckleLaw::kWeighted), cdf, tolerance) << looks << ' ' << x;
      EXPECT_NEAR(SpeckleSurvival(looks, x, SpeckleLaw::kWeighted), survival, tolerance) << looks << ' ' << x;
      EXPECT_NEAR(SpeckleDensity(looks, x, SpeckleLaw::kWeighted), density, tolerance) << looks << ' ' << x;
    }
  }
}

TEST(SpeckleTest, KLawHasMeanOneItsVarianceAndNoStepAtOneLook) {
  for (const double looks : {0.3, 0.7, 0.95, 0.97, 0.999}) {
    double mean = 0.0;
    double square = 0.0;
    // Over ln x.
    constexpr double kStep = 2e-2;
    for (double log_x = -20.0; log_x < 6.0; log_x += kStep) {
      const double x = std::exp(log_x);
      const double above = SpeckleSurvival(looks, x, SpeckleLaw::kK);
      mean += kStep * x * above;
      square += kStep * 2.0 * x * x * above;
    }
    EXPECT_NEAR(mean, 1.0, 1e-4) << looks;
    EXPECT_NEAR(square - mean * mean, 1.0 / looks, 1e-3) << looks;
  }
  for (const double x : {1e-200, 1e-6, 0.5, 30.0, 1e4, 1e250}) {
    EXPECT_NEAR(SpeckleCdf(1.0 - 1e-9, x, SpeckleLaw::kK), SpeckleCdf(1.0, x), 1e-7);
    for (const double looks : {0.05, 0.961, 0.962, 0.99}) {
      EXPECT_GE(SpeckleCdf(looks, x, SpeckleLaw::kK), 0.0);
      EXPECT_LE(SpeckleCdf(looks, x, SpeckleLaw::kK), 1.0);
      EXPECT_TRUE(std::isfinite(SpeckleDensity(looks, x, SpeckleLaw::kK)));
    }
  }
  // Both sides of the largest shape, 50.
  EXPECT_NEAR(SpeckleCdf(50.0 / 52.0 - 1e-9, 2.0, SpeckleLaw::kK),
              SpeckleCdf(50.0 / 52.0 + 1e-9, 2.0, SpeckleLaw::kK), 1e-8);
}

TEST(SpeckleTest, DensityIsTheDerivative) {
  for (const SpeckleLaw law : {SpeckleLaw::kGamma, SpeckleLaw::kWeighted, SpeckleLaw::kK}) {
    for (const double looks : {0.4, 1.0, 1.35, 3.0}) {
      if (looks < 1.0 && law == SpeckleLaw::kWeighted) continue;
      for (const double x : {0.05, 0.8, 4.0}) {
        const double difference =
            (SpeckleCdf(looks, x + 1e-5, law) - SpeckleCdf(looks, x - 1e-5, law)) / 2e-5;
        EXPECT_NEAR(SpeckleDensity(looks, x, law), difference, 1e-6);
      }
    }
  }
}

// Threads compute laws at the same time, and std::lgamma writes its sign to a global variable.
TEST(SpeckleTest, NoLawWritesTheSignOfTheGammaFunction) {
  constexpr int kUnwritten = 7;
  signgam = kUnwritten;
  for (const SpeckleLaw law : {SpeckleLaw::kGamma, SpeckleLaw::kWeighted, SpeckleLaw::kK}) {
    for (const double looks : {0.4, 1.35, 3.0}) {
      if (looks < 1.0 && law == SpeckleLaw::kWeighted) continue;
      EXPECT_GT(SpeckleDensity(looks, 0.8, law), 0.0);
      EXPECT_GT(SpeckleCdf(looks, 0.8, law), 0.0);
    }
  }
  EXPECT_GT(KDiffuseLaw(0.4, 0.3).At(0.8).density, 0.0);
  EXPECT_GT(FrozenPowerCdf(1.35, 2.0, 3.0), 0.0);
  EXPECT_EQ(signgam, kUnwritten);
}

TEST(SpeckleTest, BothLawsHaveMeanOneAndVarianceOneOverLooks) {
  for (const SpeckleLaw law : {SpeckleLaw::kGamma, SpeckleLaw::kWeighted}) {
    for (const double looks : {1.0, 1.35, 1.8, 3.0}) {
      double mean = 0.0;
      double square = 0.0;
      constexpr double kStep = 1e-3;
      for (double x = 0.5 * kStep; x < 50.0; x += kStep) {
        const double above = 1.0 - SpeckleCdf(looks, x, law);
        mean += kStep * above;
        square += kStep * 2.0 * x * above;
      }
      EXPECT_NEAR(mean, 1.0, 1e-5);
      EXPECT_NEAR(square - mean * mean, 1.0 / looks, 1e-4);
    }
  }
}

TEST(SpeckleTest, OneLookOnALogarithmHasTheKnownMeanAndSpread) {
  // A display so wide that neither clip matters: 100 dB either side.
  const DisplayParameters<double> display{.db_min = -100.0, .db_max = 100.0};
  EXPECT_NEAR(200.0 * MeanRule(display)(1.0, 1.0) - 100.0, -2.507, 2e-3);
  EXPECT_NEAR(200.0 * MeanRule(display)(3.0, 1.0) - 100.0, MeanLogSpeckleDb(3.0), 1e-3);
  double square = 0.0;  // E[v^2] = integral of 2 v (1 - F)
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double v = (i + 0.5) / kSteps;
    square += 2.0 * v * (1.0 - DisplayedCdf(display, 1.0, 1.0, v)) / kSteps;
  }
  const double mean = MeanRule(display)(1.0, 1.0);
  EXPECT_NEAR(200.0 * std::sqrt(square - mean * mean), 5.570, 2e-3);
}

TEST(SpeckleTest, MeanOfASquareLawIsTheMeanPower) {
  const DisplayParameters<double> display{
      .db_min = 0.0, .db_max = 30.0, .law = DisplayLaw::kPower, .exponent = 2.0};
  for (const double looks : {1.0, 2.5}) EXPECT_NEAR(MeanRule(display)(looks, 20.0), 0.02, 1e-5);
}

TEST(SpeckleTest, DrawsAgreeWithTheLawThroughEachDisplay) {
  constexpr int kDraws = 200000;
  const CounterRandom random(7);
  for (const DisplayParameters<double>& display : kDisplays) {
    for (const double level_db : {-3.0, 12.0, 28.0}) {
      const double power = PowerFromDb(level_db);
      double sum = 0.0;
      double square = 0.0;
      int zeros = 0;
      for (int i = 0; i < kDraws; ++i) {
        const auto [u, unused] = random.Uniform2(i);
        const double v = std::clamp(DisplayValue(display, -power * std::log(u)), 0.0, 1.0);
        sum += v;
        square += v * v;
        zeros += v == 0.0;
      }
      const double mean = sum / kDraws;
      const double sigma = std::sqrt((square / kDraws - mean * mean) / kDraws);
      EXPECT_NEAR(MeanRule(display)(1.0, power), mean, 5.0 * sigma + 1e-5);
      const double zero_share = DisplayedCdf(display, 1.0, power, 0.0);
      EXPECT_NEAR(zero_share, static_cast<double>(zeros) / kDraws,
                  5.0 * std::sqrt(zero_share * (1.0 - zero_share) / kDraws) + 1e-12);
    }
  }
}

TEST(SpeckleTest, WeightedLooksAreThoseThatAreDrawn) {
  constexpr int kDraws = 200000;
  const double w = LooksAsWeights(1.35).second;
  const CounterRandom random(11);
  for (const double x : {0.1, 0.7, 2.0}) {
    int below = 0;
    for (int i = 0; i < kDraws; ++i) {
      const auto [u, v] = random.Uniform2(i);
      below += (-std::log(u) - w * std::log(v)) / (1.0 + w) <= x;
    }
    const double share = SpeckleCdf(1.35, x, SpeckleLaw::kWeighted);
    EXPECT_NEAR(share, static_cast<double>(below) / kDraws, 5.0 * std::sqrt(share * (1.0 - share) / kDraws));
  }
}

TEST(SpeckleTest, TableFollowsTheMeanAtEveryLevel) {
  for (const DisplayParameters<double>& display : kDisplays) {
    const MeanDisplayTable table(display, 1.4);
    const MeanRule mean(display);
    for (double level_db = -190.0; level_db < 190.0; level_db += 3.37)
      EXPECT_NEAR(table(PowerFromDb(level_db)), mean(1.4, PowerFromDb(level_db)), 2e-5) << level_db;
    EXPECT_NEAR(table(0.0), std::clamp(DisplayValue(display, 0.0), 0.0, 1.0), 1e-6);
  }
}

// Softened at the lowest displayed level or above it, power shows far below that level.
TEST(SpeckleTest, TableFollowsTheMeanOfSoftDisplaysDownToBlack) {
  for (const DisplayLaw law : {DisplayLaw::kSoftLog, DisplayLaw::kSoftAmplitude}) {
    for (const double soft_above_db : {-0.1, 0.0, 2.33, 200.0}) {
      for (const double span_db : {20.0, 60.0}) {
        const DisplayParameters<double> display{
            .db_min = 30.0, .db_max = 30.0 + span_db, .law = law, .soft_db = 30.0 + soft_above_db};
        const MeanDisplayTable table(display, 1.4);
        const MeanRule mean(display);
        for (double level_db = -120.0; level_db < 170.0; level_db += 3.37)
          EXPECT_NEAR(table(PowerFromDb(level_db)), mean(1.4, PowerFromDb(level_db)), 2e-5)
              << soft_above_db << ' ' << level_db;
        EXPECT_NEAR(table(0.0), std::clamp(DisplayValue(display, 0.0), 0.0, 1.0), 2e-6) << soft_above_db;
      }
    }
  }
}

TEST(SpeckleTest, TableShowsInfinitePowerAsFullScale) {
  for (const DisplayParameters<double>& display : kDisplays) {
    const MeanDisplayTable table(display, 1.4);
    EXPECT_EQ(table(std::numeric_limits<double>::infinity()), table(1e300));
    EXPECT_NEAR(table(1e300), 1.0, 1e-4);
    // From the last entries of the table to beyond them.
    for (double above_db = 49.5; above_db < 50.5; above_db += 0.03)
      EXPECT_NEAR(table(PowerFromDb(display.db_max + above_db)), 1.0, 1e-4);
  }
}

// By numbers: over the logarithm of x.
TEST(SpeckleTest, MeanOfEachDisplayIsTheIntegralOverTheLaw) {
  std::vector<DisplayParameters<double>> displays = kDisplays;
  displays.push_back({.db_min = 0.0, .db_max = 60.0, .law = DisplayLaw::kSoftLog, .soft_db = 7.3});
  displays.push_back({.db_min = 0.0, .db_max = 60.0, .law = DisplayLaw::kSoftAmplitude, .soft_db = 7.3});
  for (const DisplayParameters<double>& display : displays) {
    const MeanRule rule(display);
    for (const double looks : {1.0, 2.5, 9.0}) {
      for (const double level_db : {-120.0, -70.0, -40.0, -20.0, -5.0, 10.0, 27.0, 58.0, 75.0}) {
        double mean = 0.0;
        constexpr double kStep = 1e-3;
        for (double log_x = -30.0; log_x < 5.0; log_x += kStep) {
          const double x = std::exp(log_x);
          const double value = DisplayValue(display, PowerFromDb(level_db) * x);
          mean += kStep * x * SpeckleDensity(looks, x) * std::clamp(value, 0.0, 1.0);
        }
        EXPECT_NEAR(rule(looks, PowerFromDb(level_db)), mean, 1e-5) << level_db;
      }
    }
  }
}

// Levels below silence are not looked up, however far a power law would show them.
TEST(SpeckleTest, TableOfATinyExponentIsSmall) {
  const DisplayParameters<double> display{
      .db_min = 0.0, .db_max = 30.0, .law = DisplayLaw::kPower, .exponent = 3e-10};
  EXPECT_NEAR(MeanDisplayTable(display, 1.4)(1.0), 1.0, 1e-6);
}

// Without clipping, E[x^e] = Gamma(L + e) / (Gamma(L) L^e), for e = exponent / 2; also below the levels of
// the table.
TEST(SpeckleTest, TableOfAPowerLawHoldsAtAllDarkLevels) {
  constexpr double kLooks = 1.4;
  for (const double exponent : {0.5, 1.0, 2.0}) {
    const DisplayParameters<double> display{
        .db_min = 0.0, .db_max = 30.0, .law = DisplayLaw::kPower, .exponent = exponent};
    const double e = exponent / 2.0;
    const double of_looks = std::exp(std::lgamma(kLooks + e) - std::lgamma(kLooks)) / std::pow(kLooks, e);
    const MeanDisplayTable table(display, kLooks);
    for (const double shown_below_db : {50.0, 70.0, 90.0, 130.0}) {
      const double value = of_looks * std::pow(10.0, -0.05 * shown_below_db);
      EXPECT_NEAR(table(PowerFromDb(30.0 - shown_below_db / exponent)), value, 1e-3 * value + 1e-9)
          << exponent << ' ' << shown_below_db;
    }
  }
}

// The error is what the header promises, and a quarter of the steps would not do.
TEST(SpeckleTest, StepsForTheMeanKeepTheirErrorAndAreNotMany) {
  const auto largest_error = [](const DisplayParameters<double>& display, double looks, int steps) {
    const MeanRule few(display, steps);
    const MeanRule many(display, 8192);
    double largest = 0.0;
    for (double level_db = display.db_min - 30.0; level_db < display.db_max + 30.0; level_db += 0.7) {
      const double power = PowerFromDb(level_db);
      largest = std::max(largest, std::abs(few(looks, power) - many(looks, power)));
    }
    return largest;
  };
  for (const double span_db : {30.0, 60.0, 100.0}) {
    const DisplayParameters<double> display{.db_min = -20.0, .db_max = span_db - 20.0};
    for (const double looks : {0.5, 1.0, 3.0, 9.0}) {
      const int steps = MeanRule::StepsFor(display, looks);
      EXPECT_LT(largest_error(display, looks, steps), 2e-6) << span_db << ' ' << looks;
      if (looks < 1.0) continue;
      EXPECT_GT(largest_error(display, looks, steps / 4), 2e-6) << span_db << ' ' << looks;
    }
  }
  EXPECT_EQ(MeanRule::StepsFor({.db_min = 0.0, .db_max = 0.1}, 1.0), 32);
  EXPECT_EQ(MeanRule::StepsFor({.db_min = 0.0, .db_max = 5000.0}, 1.0), MeanRule::kSteps);
  for (std::size_t i = 1; i < kDisplays.size(); ++i)
    EXPECT_EQ(MeanRule::StepsFor(kDisplays[i], 1.0), MeanRule::kSteps);
}

}  // namespace
}  // namespace sonarcal::sim
