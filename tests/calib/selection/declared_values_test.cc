#include "calib/selection/declared_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace sonarcal::calib {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// One heading that all poses share cannot be told from the azimuth of the beams: the frames know the sum well
// and the priors know each of them badly. Moving either explains a sum of ten standard errors.
TEST(DeclaredValues, OneOfTwoOriginsThatExplainTheSameRemains) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Constant(400.0);
  information.diagonal() += Eigen::Vector2d(1.0, 4.0);
  DeclaredValues values{{"poses", "sonar"}, {}, information.inverse()};
  values.moved = values.covariance * Eigen::Vector2d::Constant(400.0 * 0.5);
  for (int i = 0; i < 2; ++i)
    ASSERT_LT(std::abs(values.moved(i)), 2.0 * std::sqrt(values.covariance(i, i))) << "each alone is trusted";
  EXPECT_THAT(ContradictedOrigins(values), ElementsAre("poses"));
}

TEST(DeclaredValues, ValuesOfOneOriginAreTrustedTogether) {
  DeclaredValues values{{"a", "b", "b", "b", "c", "c"}, {}, Eigen::MatrixXd::Identity(6, 6)};
  values.moved = (Eigen::VectorXd(6) << 1.9, 0.1, 8.0, 0.0, 1.9, -1.9).finished();
  EXPECT_THAT(ContradictedOrigins(values), ElementsAre("b", "c")) << "7.2 exceeds 2 + 2 * sqrt(4)";
  values.moved(2) = 2.2;
  values.moved(5) = 0.0;
  EXPECT_THAT(ContradictedOrigins(values), IsEmpty());
  EXPECT_THAT(ContradictedOrigins({}), IsEmpty());
}

// Setting values to what is declared must agree with solving the normal equations without them.
TEST(DeclaredValues, AnOriginThatIsTrustedChangesTheOthersAsALeastSquaresProblemWouldSay) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const std::vector<std::string> origins = {"a", "a", "b", "c", "c", "c"};
  int differ = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd slopes =
        Eigen::MatrixXd::NullaryExpr(9, 6, [&](auto, auto) { return normal(random); });
    const Eigen::VectorXd seen = Eigen::VectorXd::NullaryExpr(9, [&](auto) { return 2.0 * normal(random); });
    std::vector<std::string> left = {"a", "b", "c"};
    std::vector<std::string> first;
    while (!left.empty()) {
      std::vector<int> free;
      for (int i = 0; i < 6; ++i) {
        if (std::ranges::find(left, origins[i]) != left.end()) free.push_back(i);
      }
      const Eigen::MatrixXd of = slopes(Eigen::all, free);
      const Eigen::MatrixXd covariance = (of.transpose() * of).inverse();
      const Eigen::VectorXd moved = covariance * of.transpose() * seen;
      std::vector<double> excess;
      for (const std::string& origin : left) {
        std::vector<int> mine;
        for (std::size_t i = 0; i < free.size(); ++i) {
          if (origins[free[i]] == origin) mine.push_back(static_cast<int>(i));
        }
        const Eigen::MatrixXd block = covariance(mine, mine);
        const Eigen::VectorXd step = moved(mine);
        const auto count = static_cast<double>(mine.size());
        excess.push_back((step.dot(block.inverse() * step) - count) / std::sqrt(2.0 * count));
      }
      const auto least = std::ranges::min_element(excess);
      if (*least > 2.0) break;
      left.erase(left.begin() + (least - excess.begin()));
    }
    const Eigen::MatrixXd covariance = (slopes.transpose() * slopes).inverse();
    EXPECT_EQ(ContradictedOrigins({origins, covariance * slopes.transpose() * seen, covariance}), left);
    differ += left.empty() || left.size() == 3 ? 0 : 1;
  }
  EXPECT_GT(differ, 50) << "the trials must tell the origins apart";
}

TEST(DeclaredValues, AReportNamesOriginsAndTurnsAngles) {
  FitReport report;
  const auto add = [&](const char* name, double value, std::optional<double> sigma, double initial) {
    report.parameters.push_back(
        {.name = name, .unit = {}, .value = value, .sigma = sigma, .initial = initial});
  };
  add("pose.0.yaw_deg", 179.0, 0.5, -180.0);
  add("materials.floor.gsab.A", 0.2, 0.1, 0.0);
  add("geometry.range_scale", 1.01, 0.002, 1.0);
  add("object.wreck.bow.x_m", 0.1, 0.05, 0.0);
  add("object.wreck.bow.y_m", 0.1, std::nullopt, 0.0);
  report.correlation_names = {"pose.0.yaw_deg", "materials.floor.gsab.A", "geometry.range_scale",
                              "object.wreck.bow.x_m"};
  report.correlation = Eigen::MatrixXd::Identity(4, 4);
  report.correlation(0, 2) = report.correlation(2, 0) = 0.5;
  const DeclaredValues values = DeclaredPlacement(report);
  EXPECT_THAT(values.origins, ElementsAre("poses", "geometry of the sonar", "object wreck.bow"));
  EXPECT_NEAR(values.moved(0), -1.0, 1e-9);
  EXPECT_NEAR(values.moved(1), 0.01, 1e-9);
  EXPECT_NEAR(values.covariance(0, 1), 0.5 * 0.5 * 0.002, 1e-12);
  EXPECT_NEAR(values.covariance(2, 2), 0.0025, 1e-12);
}

}  // namespace
}  // namespace sonarcal::calib
