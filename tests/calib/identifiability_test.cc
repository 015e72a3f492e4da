#include "calib/identifiability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include <boost/math/distributions/students_t.hpp>

namespace sonarcal::calib {
namespace {

// A straight line y = a + b x through noisy points, one block a point.
NormalEquations Line(const std::vector<double>& x, const std::vector<double>& residual) {
  NormalEquations equations;
  equations.information = Eigen::MatrixXd::Zero(2, 2);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector2d row(1.0, x[i]);
    equations.blocks.push_back({{0, 1}, row * row.transpose(), residual[i] * row});
    equations.information += row * row.transpose();
    equations.residual_square += residual[i] * residual[i];
    ++equations.residual_count;
  }
  return equations;
}

TEST(JackknifeCovarianceTest, IsTheDeleteOneJackknifeOfAStraightLine) {
  // By hand: fits without one point each, and the spread of their solutions about the full one.
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0.0, 0.5);
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 12; ++i) {
    x.push_back(0.3 * i);
    y.push_back(1.0 + 2.0 * x.back() + noise(generator));
  }
  const auto solve = [&](int without) {
    Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (int i = 0; i < 12; ++i) {
      if (i == without) continue;
      const Eigen::Vector2d row(1.0, x[i]);
      a += row * row.transpose();
      b += y[i] * row;
    }
    return Eigen::Vector2d(a.inverse() * b);
  };
  const Eigen::Vector2d full = solve(-1);
  std::vector<double> residual;
  for (int i = 0; i < 12; ++i) residual.push_back(full(0) + full(1) * x[i] - y[i]);
  Eigen::Matrix2d by_hand = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d change = solve(i) - full;
    by_hand += change * change.transpose();
  }
  by_hand *= 11.0 / 12.0;
  EXPECT_TRUE(JackknifeCovariance(Line(x, residual)).isApprox(by_hand, 1e-9));
}

// Blocks that depend on few of the parameters each, against the whole matrices without one block each.
TEST(JackknifeCovarianceTest, IsThatOfWholeMatricesIfBlocksDependOnFewParameters) {
  constexpr int kCount = 5;
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  NormalEquations equations;
  equations.information = Eigen::MatrixXd::Zero(kCount, kCount);
  equations.prior = Eigen::VectorXd::Constant(kCount, 0.3);
  std::vector<Eigen::MatrixXd> whole;
  std::vector<Eigen::VectorXd> scores;
  const std::vector<std::vector<int>> columns = {{0, 1, 2},       {0, 3}, {1, 3, 4},
                                                 {0, 1, 2, 3, 4}, {2, 4}, {0, 1}};
  for (const std::vector<int>& of : columns) {
    const auto m = static_cast<Eigen::Index>(of.size());
    const Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(7, m, draw);
    const Eigen::VectorXd residual = Eigen::VectorXd::NullaryExpr(7, draw);
    equations.blocks.push_back({of, rows.transpose() * rows, rows.transpose() * residual});
    whole.emplace_back(Eigen::MatrixXd::Zero(kCount, kCount));
    whole.back()(of, of) = equations.blocks.back().information;
    scores.emplace_back(Eigen::VectorXd::Zero(kCount));
    scores.back()(of) = equations.blocks.back().score;
    equations.information += whole.back();
  }
  const Eigen::MatrixXd prior = equations.prior.asDiagonal();
  const Eigen::MatrixXd inverse = (equations.information + prior).inverse();
  Eigen::MatrixXd by_hand = Eigen::MatrixXd::Zero(kCount, kCount);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kCount);
  Eigen::VectorXd square = sum;
  for (std::size_t b = 0; b < whole.size(); ++b) {
    const Eigen::VectorXd change = (equations.information + prior - whole[b]).inverse() * scores[b];
    by_hand += change * change.transpose();
    const Eigen::VectorXd share = (inverse * whole[b] * inverse).diagonal();
    sum += share;
    square += share.cwiseAbs2();
  }
  const auto count = static_cast<double>(whole.size());
  by_hand *= (count - 1.0) / count;
  by_hand += inverse * prior * inverse;
  EXPECT_TRUE(JackknifeCovariance(equations).isApprox(by_hand, 1e-9));
  const Eigen::VectorXd factors = StudentFactors(equations);
  for (int i = 0; i < kCount; ++i) {
    const double freedom = sum(i) * sum(i) / square(i);
    ASSERT_GT(freedom, 2.0);
    const double quantile = boost::math::quantile(boost::math::students_t(freedom), 0.975);
    EXPECT_NEAR(factors(i), quantile / 1.959964, 0.05) << freedom << " degrees of freedom";
  }
}

TEST(StudentFactorTest, IsTheQuantileOfStudentsLawOverTheNormalOne) {
  for (const double freedom : {3.0, 5.0, 11.0, 40.0}) {
    const double quantile = boost::math::quantile(boost::math::students_t(freedom), 0.975);
    EXPECT_NEAR(StudentFactor(freedom), quantile / 1.959964, 0.02) << freedom << " degrees of freedom";
  }
  EXPECT_NEAR(StudentFactor(1e6), 1.0, 1e-5);
  EXPECT_FALSE(std::isfinite(StudentFactor(1.9)));
}

TEST(WidenedCovarianceTest, AFactorThatIsNotFiniteLeavesThoseOfTheOtherParameters) {
  const Eigen::Matrix2d covariance{{4.0, 1.0}, {1.0, 9.0}};
  EXPECT_TRUE(WidenedCovariance(covariance, Eigen::Vector2d(1.5, 2.0))
                  .isApprox(Eigen::Matrix2d{{9.0, 3.0}, {3.0, 36.0}}));
  const double none = StudentFactor(1.0);
  EXPECT_TRUE(WidenedCovariance(covariance, Eigen::Vector2d(1.5, none))
                  .isApprox(Eigen::Matrix2d{{9.0, 1.5}, {1.5, 9.0}}));
}

TEST(AddBlockTest, SumsBlocksOfDifferentParameters) {
  NormalEquations::Block block{{0, 2}, Eigen::Matrix2d{{1.0, 2.0}, {2.0, 3.0}}, Eigen::Vector2d(4.0, 5.0)};
  AddBlock({{1, 2}, Eigen::Matrix2d{{10.0, 20.0}, {20.0, 30.0}}, Eigen::Vector2d(40.0, 50.0)}, block);
  EXPECT_THAT(block.columns, ::testing::ElementsAre(0, 1, 2));
  const Eigen::Matrix3d sum{{1.0, 0.0, 2.0}, {0.0, 10.0, 20.0}, {2.0, 20.0, 33.0}};
  EXPECT_TRUE(block.information.isApprox(sum)) << block.information;
  EXPECT_TRUE(block.score.isApprox(Eigen::Vector3d(4.0, 40.0, 55.0))) << block.score;
}

TEST(JackknifeCovarianceTest, WidensWhatComesFromBlocksAndNotThePrior) {
  NormalEquations equations = Line({0.0, 1.0, 2.0, 3.0}, {0.1, -0.2, 0.1, 0.3});
  const Eigen::MatrixXd independent = JackknifeCovariance(equations);
  equations.variance_factor = 1.25;
  EXPECT_TRUE(JackknifeCovariance(equations).isApprox(1.25 * independent, 1e-12));
  equations.prior = Eigen::Vector2d(1e9, 1e9);
  EXPECT_TRUE(JackknifeCovariance(equations).isApprox(
      Eigen::MatrixXd(Eigen::Vector2d(1e-9, 1e-9).asDiagonal()), 1e-6));
}

TEST(JackknifeCovarianceTest, AddsTheMovesThatNumericalErrorsOfTheScoreMake) {
  NormalEquations equations = Line({0.0, 1.0, 2.0, 3.0}, {0.1, -0.2, 0.1, 0.3});
  equations.prior = Eigen::Vector2d(0.0, 4.0);
  const Eigen::MatrixXd exact = JackknifeCovariance(equations);
  equations.numerical = {Eigen::Vector2d(0.5, -1.0), Eigen::Vector2d(0.2, 0.7)};
  // By hand: sums of 1, x and x^2 are 4, 6 and 14, the last with the prior 18; the determinant is 36.
  Eigen::Matrix2d inverse;
  inverse << 18.0, -6.0, -6.0, 4.0;
  inverse /= 36.0;
  Eigen::Matrix2d added = Eigen::Matrix2d::Zero();
  for (const Eigen::VectorXd& score : equations.numerical) {
    const Eigen::Vector2d move = inverse * score;
    added += move * move.transpose();
  }
  EXPECT_TRUE((JackknifeCovariance(equations) - exact).isApprox(added, 1e-9));
}

TEST(LeastDeterminedTest, NamesTheDirectionThatTheDataDoNotSee) {
  // All points at one x: only a + b x is seen.
  const NormalEquations equations = Line({1.0, 1.0, 1.0, 1.0}, {0.1, -0.1, 0.1, -0.1});
  const auto open = LeastDetermined(equations, Eigen::Vector2d(1.0, 1.0), {"a", "b"});
  ASSERT_TRUE(open.has_value());
  EXPECT_THAT(open->description, ::testing::HasSubstr("a"));
  EXPECT_THAT(open->description, ::testing::HasSubstr("b"));
  EXPECT_THAT(open->description, ::testing::HasSubstr("opposite"));
}

TEST(LeastDeterminedTest, IsSilentWhereAllIsSeen) {
  const NormalEquations equations = Line({0.0, 1.0, 2.0, 3.0}, {0.01, -0.01, 0.01, -0.01});
  EXPECT_FALSE(LeastDetermined(equations, Eigen::Vector2d(1.0, 1.0), {"a", "b"}).has_value());
}

// Two coordinates of which only the sum was seen, with this sigma, and a third that was seen itself.
Eigen::MatrixXd OnlyTheSumIsSeen(double step, double sigma) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(3, 3);
  information /= step * step;
  const Eigen::Vector3d sum(1.0, 1.0, 0.0);
  information += sum * sum.transpose() / (sigma * sigma);
  information(2, 2) += 1.0 / (sigma * sigma);
  return information.inverse();
}

TEST(OpenDirectionsTest, OfTwoAmplitudesSeenAsAProductOnlyTheProductIsKnown) {
  constexpr double kStep = 2.3;
  const auto words =
      OpenDirections(OnlyTheSumIsSeen(kStep, 0.05),
                     {{"gain", kStep, true}, {"amplitude", kStep, true}, {"width", kStep, true}});
  ASSERT_EQ(words.size(), 1U);
  EXPECT_THAT(words[0], ::testing::HasSubstr("gain"));
  EXPECT_THAT(words[0], ::testing::HasSubstr("amplitude"));
  EXPECT_THAT(words[0], ::testing::HasSubstr(" with the opposite of "));
  EXPECT_THAT(words[0], ::testing::HasSubstr("only 10 log10(gain^1.00 amplitude^1.00) is known"));
  // 0.05 neper of power.
  EXPECT_THAT(words[0], ::testing::HasSubstr("to 0.22 dB"));
  EXPECT_THAT(words[0], ::testing::Not(::testing::HasSubstr("width")));
}

TEST(OpenDirectionsTest, OfTwoLevelsSeenAsASumOnlyTheSumIsKnown) {
  const auto words = OpenDirections(OnlyTheSumIsSeen(20.0, 0.5),
                                    {{"level", 20.0, false}, {"gain", 20.0, false}, {"noise", 20.0, false}});
  ASSERT_EQ(words.size(), 1U);
  EXPECT_THAT(words[0], ::testing::HasSubstr("only 1.00 level + 1.00 gain is known, to 0.5"));
}

TEST(OpenDirectionsTest, NamesFourOfManyThatMoveTogether) {
  constexpr double kStep = 20.0;
  const Eigen::MatrixXd information =
      Eigen::MatrixXd::Identity(6, 6) / (kStep * kStep) + Eigen::MatrixXd::Identity(6, 6) * 4.0;
  Eigen::VectorXd open(6);
  open << 6.0, 5.0, -4.0, 3.0, 2.5, 2.2;
  open.normalize();
  const Eigen::MatrixXd covariance = (information - 4.0 * open * open.transpose()).inverse();
  std::vector<NamedCoordinate> coordinates;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) coordinates.push_back({name, kStep, false});
  EXPECT_THAT(OpenDirections(covariance, coordinates),
              ::testing::ElementsAre("a with b with the opposite of c with d and 2 more"));
}

TEST(OpenDirectionsTest, IsSilentWhereAllIsSeen) {
  const Eigen::MatrixXd covariance = 0.01 * Eigen::MatrixXd::Identity(2, 2);
  EXPECT_TRUE(OpenDirections(covariance, {{"a", 1.0, true}, {"b", 1.0, true}}).empty());
}

TEST(HoldParameterTest, DropsItsRowAndColumn) {
  const NormalEquations held = HoldParameter(Line({0.0, 1.0, 2.0}, {0.1, 0.2, 0.3}), 0);
  ASSERT_EQ(held.information.rows(), 1);
  EXPECT_DOUBLE_EQ(held.information(0, 0), 5.0);  // 0 + 1 + 4
  EXPECT_DOUBLE_EQ(held.blocks[2].score(0), 0.6);
}

}  // namespace
}  // namespace sonarcal::calib
