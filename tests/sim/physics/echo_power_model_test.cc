#include "sim/physics/echo_power_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/physics/fine_rows.h"

namespace sonarcal::sim {
namespace {

constexpr double kAbsorptionDbPerM = 0.3;

SonarModel EchoSonar() {
  SonarModel sonar;
  sonar.axes = {1.0, 3.0, 8, {-0.1, 0.0, 0.1}};
  sonar.elevation_beam_width_deg = 14.0;
  return sonar;
}

ParameterSet Parameters() {
  ParameterSet parameters;
  parameters.source_level_db = 190.0;
  parameters.receiver.gain_db = 7.0;
  parameters.beam.elevation_pattern = ElevationPattern::kGaussian;
  parameters.materials["sand"].gsab = {.a = 0.0, .b_deg = 1.0, .c = 0.02, .d = 2.0, .e = 0.0, .f_deg = 1.0};
  return parameters;
}

// 10^((SL + G - 40 log10 R - 2 alpha R) / 10) C cos^2 R^2 dOmega / cos el(phi), half a width off the axis.
TEST(EchoPowerModelTest, EchoOfACosineLawInClosedForm) {
  const SonarModel sonar = EchoSonar();
  const EchoPowerModel model({sonar, kAbsorptionDbPerM}, Parameters(), {"sand"});
  const double elevation_power = model.elevation().Power(RadFromDeg(7.0));
  EXPECT_NEAR(elevation_power, 0.5, 1e-12);
  const double range_m = 2.5;
  const EchoPath path = model.StraightBack(range_m, RadFromDeg(60.0), 1e-4, elevation_power);
  const double expected = std::pow(10.0, (197.0 - 2.0 * kAbsorptionDbPerM * range_m) / 10.0) /
                          std::pow(range_m, 4) * 0.02 * 0.25 * range_m * range_m * 1e-4 / 0.5 * 0.5;
  EXPECT_NEAR(model.Power(path, model.Backscatter(0, RadFromDeg(60.0))) / expected, 1.0, 1e-12);
  EXPECT_NEAR(model.level() * EchoPowerModel::UnitPower(path) * 0.02 * 0.25 / expected, 1.0, 1e-12);
}

TEST(EchoPowerModelTest, InfiniteLossIsSilent) {
  const EchoPath path{.loss_db = std::numeric_limits<double>::infinity(), .area_m2 = 1.0};
  EXPECT_EQ(EchoPowerModel::UnitPower(path), 0.0);
}

TEST(EchoPowerModelTest, AMaterialWithoutParametersIsRefused) {
  const SonarModel sonar = EchoSonar();
  EXPECT_THROW(EchoPowerModel({sonar, 0.0}, Parameters(), {"mud"}), DataError);
}

// The mean of the middles of the rows that share an echo, by their parts, is the echo's range.
TEST(FineRowsTest, KeepThePowerAndTheRangeOfAnEcho) {
  const PolarAxes axes = EchoSonar().axes;
  const FineRows rows(axes, 4, axes.range_bin_m());
  EXPECT_EQ(rows.count, 32);
  const double step_m = axes.range_bin_m() / 4;
  for (double range_m = 1.0 + 0.5 * step_m; range_m < 3.0 - 0.51 * step_m; range_m += 0.0137) {
    double power = 0.0;
    double moment = 0.0;
    int shares = 0;
    rows.Share(range_m, 5.0, [&](int row, double part) {
      power += part;
      moment += part * (axes.range_min_m + (row + 0.5) * step_m);
      ++shares;
    });
    EXPECT_EQ(shares, 2);
    EXPECT_NEAR(power, 5.0, 1e-12);
    EXPECT_NEAR(moment / power, range_m, 1e-12);
  }
}

TEST(FineRowsTest, OutsideOfTheWindowAnEchoKeepsItsShareOfTheOuterRowAlone) {
  const FineRows rows(EchoSonar().axes, 4, EchoSonar().axes.range_bin_m());
  const double step_m = EchoSonar().axes.range_bin_m() / 4;
  const auto shares = [&](double range_m) {
    std::vector<double> by_row(static_cast<std::size_t>(rows.count), 0.0);
    rows.Share(range_m, 1.0, [&](int row, double part) { by_row.at(row) += part; });
    return by_row;
  };
  EXPECT_NEAR(shares(1.0).front(), 0.5, 1e-12);
  EXPECT_NEAR(shares(3.0).back(), 0.5, 1e-12);
  for (const double range_m : {-5.0, 1.0 - 0.6 * step_m, 3.0 + 0.6 * step_m, 100.0}) {
    for (const double share : shares(range_m)) EXPECT_EQ(share, 0.0) << range_m;
  }
}

// A patch of depth d is an even distribution over d: its variance is d^2 / 12, and sharing between rows adds
// at most step^2 / 4.
TEST(FineRowsTest, APatchIsSpreadOverItsDepth) {
  const FineRows rows(EchoSonar().axes, 4, EchoSonar().axes.range_bin_m());
  const double step_m = EchoSonar().axes.range_bin_m() / 4;
  for (const double depth_m : {0.0, 0.1, 0.4, 0.9}) {
    double power = 0.0;
    double mean_m = 0.0;
    double square_m2 = 0.0;
    rows.Spread(2.03, depth_m, 5.0, [&](int row, double part) {
      const double range_m = 1.0 + (row + 0.5) * step_m;
      power += part;
      mean_m += part / 5.0 * range_m;
      square_m2 += part / 5.0 * range_m * range_m;
    });
    EXPECT_NEAR(power, 5.0, 1e-12);
    EXPECT_NEAR(mean_m, 2.03, 1e-12);
    const double variance_m2 = square_m2 - mean_m * mean_m;
    EXPECT_GT(variance_m2, depth_m * depth_m / 12.0 - 0.75 * step_m * step_m);
    EXPECT_LT(variance_m2, depth_m * depth_m / 12.0 + 0.25 * step_m * step_m);
  }
}

TEST(FineRowsTest, APatchAtTheEndOfTheWindowKeepsItsPower) {
  const FineRows rows(EchoSonar().axes, 4, EchoSonar().axes.range_bin_m());
  const double step_m = EchoSonar().axes.range_bin_m() / 4;
  for (const double range_m : {1.0 + step_m, 3.0 - step_m}) {
    double power = 0.0;
    rows.Spread(range_m, 0.3, 5.0, [&](int row, double part) {
      EXPECT_TRUE(row >= 0 && row < rows.count);
      power += part;
    });
    EXPECT_GT(power, 0.8 * 5.0);  // what lies within half a row of the end loses up to half
  }
}

// 64 parts of 0.75 pulse lengths at most: a deeper patch is cut to 64 x 0.015 m around its middle.
TEST(FineRowsTest, APatchIsSpreadOverSixtyFourPartsAtMost) {
  const FineRows rows(EchoSonar().axes, 8, 0.02);
  const double step_m = EchoSonar().axes.range_bin_m() / 8;
  double nearest_m = 10.0;
  double farthest_m = 0.0;
  rows.Spread(2.0, 1.8, 1.0, [&](int row, double) {
    nearest_m = std::min(nearest_m, 1.0 + (row + 0.5) * step_m);
    farthest_m = std::max(farthest_m, 1.0 + (row + 0.5) * step_m);
  });
  EXPECT_NEAR(nearest_m, 2.0 - 0.48, 1.1 * step_m);
  EXPECT_NEAR(farthest_m, 2.0 + 0.48, 1.1 * step_m);
}

// Half of the parts of a patch at an end lie outside. Reflected, all power stays within half the depth of it.
// The far end must not be at twice the range of the near end. Otherwise a wrong sign at the near end moves a
// part beyond the far end, and the reflection there brings it to the right place.
TEST(FineRowsTest, PartsOutsideAreReflectedButAWholeEchoIsNot) {
  PolarAxes axes = EchoSonar().axes;
  axes.range_min_m = 1.5;
  axes.range_max_m = 2.8;
  const FineRows rows(axes, 8, 0.02);
  const double step_m = axes.range_bin_m() / 8;
  for (const double end_m : {1.5, 2.8}) {
    double power = 0.0;
    rows.Spread(end_m, 0.4, 1.0, [&](int row, double part) {
      power += part;
      EXPECT_LT(std::abs(1.5 + (row + 0.5) * step_m - end_m), 0.2 + step_m);
    });
    EXPECT_GT(power, 0.9);
  }
  for (const double outside_m : {1.4, 2.9}) {
    rows.Spread(outside_m, 0.0, 1.0, [&](int row, double) { ADD_FAILURE() << outside_m << ", row " << row; });
  }
}

}  // namespace
}  // namespace sonarcal::sim
