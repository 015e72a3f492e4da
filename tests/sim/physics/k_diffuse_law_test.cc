#include "sim/physics/k_diffuse_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim/physics/speckle.h"

namespace sonarcal::sim {
namespace {

struct Truth {
  double looks = 0.0;
  double share = 0.0;

  double shape() const { return 2.0 * (1.0 - share) * (1.0 - share) * looks / (1.0 - looks); }
  double MeanOf(double texture) const { return (1.0 - share) * texture + share; }
};

// Shapes of 0.03 to 11.
const std::vector<Truth> kTruths = {{0.1, 0.6}, {0.3, 0.1}, {0.4, 0.5}, {0.6, 0.3}, {0.6, 0.9}, {0.9, 0.2}};

// The slow reference: expectations by the midpoint rule over v = tau^(nu / k). The density of v is then
// v^(k - 1) exp(-nu tau), without a pole, and tau is smooth in v with a k beyond nu.
class Reference {
 public:
  // Texture up to a probability of exp(-`depth`) beyond it.
  explicit Reference(const Truth& truth, double depth = 60.0) {
    constexpr int kSteps = 100000;
    const double nu = truth.shape();
    const double power = nu / std::round(nu + 2.0);
    mean_.reserve(kSteps);
    weight_.reserve(kSteps);
    const double step = std::pow(std::max(depth / nu, 1.0) + 4.0, power) / kSteps;
    const double constant = step / power * std::exp(nu * std::log(nu) - std::lgamma(nu));
    for (int i = 0; i < kSteps; ++i) {
      const double texture = std::pow((i + 0.5) * step, 1.0 / power);
      mean_.push_back(truth.MeanOf(texture));
      weight_.push_back(constant * std::exp((nu - power) * std::log(texture) - nu * texture));
    }
  }

  template <typename Of>
  double Expected(const Of& of) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < mean_.size(); ++i) sum += weight_[i] * of(mean_[i]);
    return sum;
  }

 private:
  std::vector<double> mean_;
  std::vector<double> weight_;
};

TEST(KDiffuseLawTest, IsTheExpectationOverTextureByAnotherQuadrature) {
  for (const Truth& truth : kTruths) {
    const KDiffuseLaw law(truth.looks, truth.share);
    const Reference slow(truth);
    EXPECT_NEAR(slow.Expected([](double) { return 1.0; }), 1.0, 1e-6);
    for (const double x : {1e-3, 0.1, 0.7, 2.0, 9.0, 40.0}) {
      const KDiffuseLaw::Value at = law.At(x);
      EXPECT_NEAR(at.survival, slow.Expected([x](double m) { return std::exp(-x / m); }), 1e-8) << x;
      EXPECT_NEAR(at.cdf, slow.Expected([x](double m) { return -std::expm1(-x / m); }), 1e-8) << x;
      EXPECT_NEAR(at.density, slow.Expected([x](double m) { return std::exp(-x / m) / m; }), 1e-7) << x;
    }
  }
}

TEST(KDiffuseLawTest, HasItsLimitsAtTheEndsOfRatios) {
  const KDiffuseLaw law(0.4, 0.5);
  for (const double least : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(law.At(least).cdf, 0.0);
    EXPECT_EQ(law.At(least).survival, 1.0);
    EXPECT_EQ(law.At(least).density, 0.0);
  }
  for (const double largest :
       {1e300, std::numeric_limits<double>::max(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(law.At(largest).cdf, 1.0);
    EXPECT_NEAR(law.At(largest).survival, 0.0, 1e-300);
    EXPECT_NEAR(law.At(largest).density, 0.0, 1e-300);
  }
}

TEST(KDiffuseLawTest, BothTailsKeepTheirDigits) {
  for (const Truth& truth : kTruths) {
    const KDiffuseLaw law(truth.looks, truth.share);
    const Reference slow(truth, 900.0);
    // The cdf starts as a straight line.
    const double slope = slow.Expected([](double m) { return 1.0 / m; });
    for (const double x : {1e-200, 1e-12, 1e-9}) {
      EXPECT_NEAR(law.At(x).cdf / (x * slope), 1.0, 1e-5);
      EXPECT_NEAR(law.At(x).density / slope, 1.0, 1e-5);
    }
    const auto check = [&](double exponent, double tolerance) {
      // The survival is about exp(-exponent).
      const double x = exponent * exponent / (4.0 * truth.shape()) * (1.0 - truth.share);
      const double survival = slow.Expected([x](double m) { return std::exp(-x / m); });
      const double density = slow.Expected([x](double m) { return std::exp(-x / m) / m; });
      EXPECT_GT(survival, 1e-300);
      EXPECT_NEAR(law.At(x).survival / survival, 1.0, tolerance)
          << truth.looks << " " << truth.share << " " << x;
      EXPECT_NEAR(law.At(x).density / density, 1.0, tolerance)
          << truth.looks << " " << truth.share << " " << x;
    };
    for (const double exponent : {20.0, 50.0, 100.0, 180.0}) check(exponent, 1e-6);
    check(300.0, 1e-3);
    check(600.0, 0.04);
  }
}

TEST(KDiffuseLawTest, IsTheKLawWithoutADiffuseShare) {
  for (const double looks : {0.05, 0.2, 3.0 / 7.0, 0.6, 0.9, 0.97, 0.999}) {
    const KDiffuseLaw none(looks, 0.0);
    const KDiffuseLaw little(looks, 1e-12);
    for (const double x : {1e-3, 0.1, 1.0, 3.0, 20.0, 60.0}) {
      const double survival = KLawSurvival(looks, x);
      EXPECT_NEAR(none.At(x).survival, survival, 1e-9 * survival) << looks << " " << x;
      EXPECT_NEAR(none.At(x).density, KLawDensity(looks, x), 1e-9 * KLawDensity(looks, x))
          << looks << " " << x;
      EXPECT_NEAR(little.At(x).survival, survival, 1e-7);
    }
  }
}

TEST(KDiffuseLawTest, TurnsIntoExponentialPower) {
  for (const double x : {1e-200, 1e-6, 0.1, 1.0, 5.0, 30.0, 300.0}) {
    for (const KDiffuseLaw& law : {KDiffuseLaw(1.0 - 1e-12, 0.3), KDiffuseLaw(1.0 - 1e-12, 0.0),
                                   KDiffuseLaw(0.5, 1.0 - 1e-9), KDiffuseLaw(0.95, 1.0 - 1e-9)}) {
      const KDiffuseLaw::Value at = law.At(x);
      EXPECT_NEAR(at.cdf, -std::expm1(-x), 1e-7);
      EXPECT_NEAR(at.survival, std::exp(-x), 1e-7);
      EXPECT_NEAR(at.density, std::exp(-x), 1e-7);
    }
  }
}

TEST(KDiffuseLawTest, HasMeanOneAndItsVariance) {
  for (const Truth& truth : kTruths) {
    const KDiffuseLaw law(truth.looks, truth.share);
    double mean = 0.0;
    double square = 0.0;
    constexpr double kStep = 1e-2;  // of ln x
    for (double log_x = -25.0; log_x < 12.0; log_x += kStep) {
      const double x = std::exp(log_x);
      const double above = law.At(x).survival;
      mean += kStep * x * above;
      square += kStep * 2.0 * x * x * above;
    }
    EXPECT_NEAR(mean, 1.0, 1e-5) << truth.looks << " " << truth.share;
    EXPECT_NEAR(square - mean * mean, 1.0 / truth.looks, 1e-4) << truth.looks << " " << truth.share;
  }
}

TEST(KDiffuseLawTest, DrawsAgreeWithIt) {
  constexpr int kDraws = 200000;
  std::mt19937_64 random(3);
  for (const Truth& truth : kTruths) {
    const KDiffuseLaw law(truth.looks, truth.share);
    std::gamma_distribution<double> texture(truth.shape(), 1.0 / truth.shape());
    std::exponential_distribution<double> speckle(1.0);
    const std::vector<double> edges = {0.01, 0.1, 0.5, 1.0, 3.0, 10.0};
    std::vector<int> below(edges.size());
    double sum = 0.0;
    double square = 0.0;
    double fourth = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = truth.MeanOf(texture(random)) * speckle(random);
      for (std::size_t k = 0; k < edges.size(); ++k) below[k] += x <= edges[k];
      sum += x / kDraws;
      square += x * x / kDraws;
      fourth += x * x * x * x / kDraws;
    }
    EXPECT_NEAR(sum, 1.0, 5.0 * std::sqrt(1.0 / truth.looks / kDraws));
    // E[x^2] = 2 E[m^2]
    const double second = 2.0 * (1.0 + (1.0 - truth.share) * (1.0 - truth.share) / truth.shape());
    EXPECT_NEAR(second, 1.0 + 1.0 / truth.looks, 1e-12);
    EXPECT_NEAR(square, second, 5.0 * std::sqrt((fourth - square * square) / kDraws)) << truth.looks;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const double share = law.At(edges[k]).cdf;
      EXPECT_NEAR(share, static_cast<double>(below[k]) / kDraws,
                  5.0 * std::sqrt(share * (1.0 - share) / kDraws))
          << truth.looks << " " << truth.share << " " << edges[k];
    }
  }
}

TEST(KDiffuseLawTest, DerivativesAreThoseOfTheCdf) {
  constexpr double kStep = 1e-5;
  const auto moved = [](const Truth& truth, double log_looks, double logit_share) {
    const double odds = truth.share / (1.0 - truth.share) * std::exp(logit_share);
    return KDiffuseLaw(truth.looks * std::exp(log_looks), odds / (1.0 + odds));
  };
  std::vector<Truth> truths = kTruths;
  truths.push_back({0.97, 0.1});  // shapes below and above the largest
  truths.push_back({0.999, 0.4});
  for (const Truth& truth : truths) {
    const KDiffuseLaw law(truth.looks, truth.share);
    const auto difference = [&](double x, double log_looks, double logit_share) {
      return (moved(truth, log_looks, logit_share).At(x).cdf -
              moved(truth, -log_looks, -logit_share).At(x).cdf) /
             (2.0 * kStep);
    };
    for (const double x : {1e-5, 0.05, 0.8, 4.0, 12.0}) {
      const KDiffuseLaw::Value at = law.At(x);
      EXPECT_NEAR(at.density,
                  (law.At(x * (1.0 + kStep)).cdf - law.At(x * (1.0 - kStep)).cdf) / (2.0 * kStep * x), 1e-6);
      EXPECT_NEAR(at.cdf_by_log_looks, difference(x, kStep, 0.0), 1e-7) << truth.looks << " " << x;
      EXPECT_NEAR(at.cdf_by_logit_share, difference(x, 0.0, kStep), 1e-7) << truth.looks << " " << x;
    }
  }
}

TEST(KDiffuseLawTest, IsFiniteAndAProbabilityAtItsExtremes) {
  for (const double looks : {1e-6, 0.05, 0.5, 0.9, 1.0 - 1e-12, std::nextafter(1.0, 0.0)}) {
    for (const double share : {0.0, 1e-12, 0.001, 0.5, 0.99, 0.999}) {
      if (looks < kLeastTexturedLooks && share == 0.0) continue;
      const KDiffuseLaw law(looks, share);
      double last = 0.0;
      for (const double x : {0.0, 1e-300, 1e-6, 0.5, 30.0, 1e4, 1e250, 1e305}) {
        const KDiffuseLaw::Value at = law.At(x);
        EXPECT_GE(at.cdf, last);
        EXPECT_LE(at.cdf, 1.0);
        EXPECT_NEAR(at.cdf + at.survival, 1.0, 1e-9) << looks << " " << share << " " << x;
        EXPECT_GE(at.density, 0.0);
        for (const double value : {at.density, at.cdf_by_log_looks, at.cdf_by_logit_share})
          EXPECT_TRUE(std::isfinite(value)) << looks << " " << share << " " << x;
        last = at.cdf;
      }
    }
  }
}

TEST(KDiffuseLawTest, HasNoStepAtTheLargestShape) {
  const double share = 0.3;
  const double looks = kLargestTextureShape / (kLargestTextureShape + 2.0 * 0.7 * 0.7);
  for (const double x : {0.1, 1.0, 2.0, 9.0}) {
    EXPECT_NEAR(KDiffuseLaw(looks - 1e-9, share).At(x).cdf, KDiffuseLaw(looks + 1e-9, share).At(x).cdf, 1e-8);
  }
}

TEST(KDiffuseLawTest, FunctionsOfLooksAloneRefuseIt) {
  EXPECT_THROW(SpeckleCdf(0.5, 1.0, SpeckleLaw::kKDiffuse), std::logic_error);
  EXPECT_THROW(SpeckleSurvival(0.5, 1.0, SpeckleLaw::kKDiffuse), std::logic_error);
  EXPECT_THROW(SpeckleDensity(0.5, 1.0, SpeckleLaw::kKDiffuse), std::logic_error);
  EXPECT_THROW(KDiffuseLaw(1.0, 0.5), std::logic_error);
  EXPECT_THROW(KDiffuseLaw(0.5, 1.0), std::logic_error);
}

}  // namespace
}  // namespace sonarcal::sim
