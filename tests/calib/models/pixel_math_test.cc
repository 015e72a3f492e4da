// The loops over many pixels against the formulas one at a time.
#include "calib/models/pixel_math.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "calib/models/power_likelihood.h"
#include "sim/physics/display.h"

namespace sonarcal::calib {
namespace {

TEST(PixelMathTest, LikelihoodIsThatOfOnePixel) {
  std::vector<double> power;
  std::vector<double> mean;
  for (const double about : {1e-12, 1.0, 3e15}) {
    for (const double x : {1e-250, 1e-9, 0.01, 0.5, 0.999, 1.0 - 2e-4, 1.0 - 5e-5, 1.0 - 1e-9, 1.0,
                           1.0 + 1e-9, 1.00005, 1.0002, 1.01, 2.0, 30.0, 1e6}) {
      power.push_back(x * about);
      mean.push_back(about);
    }
  }
  const auto count = static_cast<int>(power.size());
  for (const double looks : {1.0, 3.5, 32.0}) {
    std::vector<double> residual(power.size());
    std::vector<double> slope(power.size());
    pixel_math::Likelihood(power.data(), mean.data(), count, looks, residual.data(), slope.data());
    for (std::size_t i = 0; i < power.size(); ++i) {
      const LikelihoodTerm one = PowerLikelihood({power[i], Censoring::kNone}, mean[i], looks);
      EXPECT_NEAR(residual[i], one.residual, 1e-9 * std::abs(one.residual) + 1e-12) << power[i] / mean[i];
      EXPECT_NEAR(slope[i], one.slope, 1e-7 * std::abs(one.slope)) << power[i] / mean[i];
    }
  }
}

TEST(PixelMathTest, InformationIsThatOfOnePixel) {
  const double lowest = 2.0;
  const double highest = 5e6;
  std::vector<double> mean;
  for (double value = 0.3; value < 1e9; value *= 1.37) mean.push_back(value);
  std::vector<double> information(mean.size());
  pixel_math::SingleLookInformation(lowest, highest, mean.data(), static_cast<int>(mean.size()),
                                    information.data());
  for (std::size_t i = 0; i < mean.size(); ++i)
    EXPECT_NEAR(information[i], ExpectedInformation(lowest, highest, mean[i], 1.0), 1e-7) << mean[i];
}

// Powers from nothing to without end: ends of displays, denormals, and what over- and underflows.
std::vector<double> EveryPower() {
  std::vector<double> powers = {0.0,
                                std::numeric_limits<double>::denorm_min(),
                                1e-310,
                                std::numeric_limits<double>::min(),
                                1e-30,
                                1e-17,
                                1e-9,
                                0.3,
                                1.0,
                                2.0,
                                40.0,
                                5e6,
                                1e12,
                                1e30,
                                std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::infinity()};
  for (const DisplayLaw law :
       {DisplayLaw::kLog, DisplayLaw::kSoftLog, DisplayLaw::kSoftAmplitude, DisplayLaw::kPower}) {
    // Below, at and above the display's lower end.
    for (const double soft_db : {80.0, 100.0, 100.1, 130.0}) {
      const DisplayParameters<double> display{
          .db_min = 100.0, .db_max = 160.0, .law = law, .soft_db = soft_db};
      for (const double value : {0.0, 0.5 / 255.0, 0.2, 1.0})
        powers.push_back(sim::PowerFromDisplay(display, value));
    }
  }
  return powers;
}

std::vector<double> EveryMean() {
  std::vector<double> means;
  for (const double power : EveryPower()) {
    if (power > 0.0 && std::isfinite(power)) means.push_back(power);
  }
  return means;
}

TEST(PixelMathTest, LikelihoodOverItsWholeDomain) {
  const std::vector<double> means = EveryMean();
  for (const double power : EveryPower()) {
    const std::vector<double> powers(means.size(), power);
    for (const double looks : {1.0, 3.5, 32.0}) {
      std::vector<double> residual(means.size());
      std::vector<double> slope(means.size());
      pixel_math::Likelihood(powers.data(), means.data(), static_cast<int>(means.size()), looks,
                             residual.data(), slope.data());
      for (std::size_t i = 0; i < means.size(); ++i) {
        const LikelihoodTerm one = PowerLikelihood({power, Censoring::kNone}, means[i], looks);
        ASSERT_TRUE(std::isfinite(one.residual) && std::isfinite(one.slope)) << power << ", " << means[i];
        EXPECT_NEAR(residual[i], one.residual, 1e-9 * std::abs(one.residual) + 1e-12)
            << power << ", " << means[i];
        EXPECT_NEAR(slope[i], one.slope, 1e-7 * std::abs(one.slope)) << power << ", " << means[i];
      }
    }
  }
}

TEST(PixelMathTest, InformationOverItsWholeDomain) {
  const std::vector<double> means = EveryMean();
  std::vector<double> information(means.size());
  for (const double lowest : EveryPower()) {
    for (const double highest : EveryPower()) {
      if (!(lowest < highest)) continue;
      pixel_math::SingleLookInformation(lowest, highest, means.data(), static_cast<int>(means.size()),
                                        information.data());
      for (std::size_t i = 0; i < means.size(); ++i) {
        const double one = ExpectedInformation(lowest, highest, means[i], 1.0);
        ASSERT_TRUE(one >= 0.0 && one <= 1.0 + 1e-7) << lowest << " to " << highest << ", " << means[i];
        EXPECT_NEAR(information[i], one, 1e-7) << lowest << " to " << highest << ", " << means[i];
      }
    }
  }
}

TEST(PixelMathTest, ADisplayWithoutEndsKeepsTheInformationOfOneLook) {
  const std::vector<double> means = EveryMean();
  std::vector<double> information(means.size());
  pixel_math::SingleLookInformation(0.0, std::numeric_limits<double>::infinity(), means.data(),
                                    static_cast<int>(means.size()), information.data());
  for (const double one : information) EXPECT_EQ(one, 1.0);
}

TEST(PixelMathTest, CurvesAreSummedAsForOnePixel) {
  constexpr int kMaterials = 3;
  const std::size_t nodes = sim::CoarseIncidenceDeg().size();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.1, 1.0);
  sim::PixelEchoes echoes{.materials = kMaterials, .start = {0}, .entries = {}};
  for (int pixel = 0; pixel < 40; ++pixel) {
    // None at all, of the last material only, of all.
    const std::size_t first = pixel % 3 == 1 ? 2 * nodes : 0;
    const std::size_t last = pixel % 3 == 0 ? 0 : kMaterials * nodes;
    for (std::size_t node = first; node < last; node += 7)
      echoes.entries.push_back({static_cast<std::uint32_t>(node), static_cast<float>(uniform(random))});
    echoes.start.push_back(static_cast<std::uint32_t>(echoes.entries.size()));
  }
  std::vector<double> curves(kMaterials * nodes * sim::kCurveStride);
  for (double& value : curves) value = uniform(random);
  const std::vector<std::uint32_t> pixels = {3, 4, 5, 6, 17, 38, 39};
  std::vector<double> sums(pixels.size() * kMaterials * sim::kCurveStride, -1.0);
  pixel_math::SumCurves(echoes, pixels, curves, sums.data());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    std::vector<double> one(kMaterials * sim::kCurveStride, 0.0);
    sim::AddCurves(echoes, pixels[i], curves, one);
    for (std::size_t k = 0; k < one.size(); ++k)
      EXPECT_NEAR(sums[i * one.size() + k], one[k], 1e-12 * one[k]) << pixels[i] << ", " << k;
  }
}

TEST(PixelMathTest, OuterProductsAreThoseOfMatrices) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (const int n : {1, 3, 4, 5, 12, 13}) {
    for (const int count : {0, 1, 7, 8, 9, 31}) {
      std::srand(n + count);
      const RowMajor rows = RowMajor::Random(count, n);
      const Eigen::VectorXd weight = Eigen::VectorXd::Random(count).cwiseAbs();
      const Eigen::VectorXd along = Eigen::VectorXd::Random(count);
      std::vector<double> padded(rows.data(), rows.data() + rows.size());
      padded.resize(padded.size() + pixel_math::kRowPadding, 1e30);
      RowMajor sum = RowMajor::Ones(n, n);
      Eigen::VectorXd projection = Eigen::VectorXd::Ones(n);
      pixel_math::AddOuterProducts(padded.data(), weight.data(), along.data(), count, n, sum.data(),
                                   projection.data());
      const Eigen::MatrixXd expected =
          Eigen::MatrixXd::Ones(n, n) + rows.transpose() * weight.asDiagonal() * rows;
      const Eigen::MatrixXd off = Eigen::MatrixXd(sum) - expected;
      EXPECT_LT(Eigen::MatrixXd(off.triangularView<Eigen::Lower>()).norm(), 1e-12 * (1 + count)) << n;
      EXPECT_LT((projection - Eigen::VectorXd::Ones(n) - rows.transpose() * along).norm(),
                1e-12 * (1 + count));
    }
  }
}

}  // namespace
}  // namespace sonarcal::calib
