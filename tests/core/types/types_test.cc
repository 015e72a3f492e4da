#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/image.h"
#include "core/types/pose.h"
#include "core/types/scene.h"
#include "core/types/sonar_settings.h"
#include "core/types/units.h"

namespace sonarcal {
namespace {

TEST(PoseTest, InverseUndoesThePose) {
  const Pose world_from_sonar{RotationFromYawPitchRoll(0.3, -0.2, 0.1), {1.0, -2.0, 3.0}};
  const Eigen::Vector3d point_m(0.4, 5.0, -0.7);
  EXPECT_TRUE((world_from_sonar.Inverse() * (world_from_sonar * point_m)).isApprox(point_m, 1e-12));
}

TEST(PoseTest, YawPitchAndRollOfARotationAreThoseItWasMadeOf) {
  const Eigen::Vector3d angles = YawPitchRollFromRotation(RotationFromYawPitchRoll(2.8, -1.2, 0.4));
  EXPECT_TRUE(angles.isApprox(Eigen::Vector3d(2.8, -1.2, 0.4), 1e-12)) << angles.transpose();
}

// Near +-90 degrees, the tolerance is that of the pitch, which is then rounded to +-90 degrees.
TEST(PoseTest, AnglesOfARotationThatLooksStraightUpOrDownRebuildIt) {
  for (const double sign : {-1.0, 1.0}) {
    for (const double from_vertical_rad : {0.0, 1e-12, 1e-9, 9e-7, 1.1e-6, 1e-4}) {
      const double pitch_rad = sign * (0.5 * std::numbers::pi - from_vertical_rad);
      for (const double yaw_rad : {-2.9, -1.0, 0.0, 0.52, 1.6}) {
        for (const double roll_rad : {-1.3, 0.0, 0.7, 3.0}) {
          const Eigen::Quaterniond rotation = RotationFromYawPitchRoll(yaw_rad, pitch_rad, roll_rad);
          const Eigen::Vector3d angles = YawPitchRollFromRotation(rotation);
          const Eigen::Quaterniond rebuilt = RotationFromYawPitchRoll(angles[0], angles[1], angles[2]);
          EXPECT_LT(rebuilt.angularDistance(rotation), 2e-6)
              << pitch_rad << ' ' << yaw_rad << ' ' << roll_rad << ": " << angles.transpose();
        }
      }
    }
  }
}

TEST(PoseTest, YawOfASonarWithoutRollThatLooksStraightDownIsKept) {
  const double down_rad = -0.5 * std::numbers::pi;
  const Eigen::Vector3d angles = YawPitchRollFromRotation(RotationFromYawPitchRoll(0.52, down_rad, 0.0));
  EXPECT_TRUE(angles.isApprox(Eigen::Vector3d(0.52, down_rad, 0.0), 1e-12)) << angles.transpose();
}

TEST(PoseTest, PositivePitchLooksUpAndPositiveYawLooksLeft) {
  const Eigen::Vector3d up = RotationFromYawPitchRoll(0.0, 0.1, 0.0) * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d left = RotationFromYawPitchRoll(0.1, 0.0, 0.0) * Eigen::Vector3d::UnitY();
  EXPECT_GT(up.z(), 0.0);
  EXPECT_LT(left.x(), 0.0);
}

TEST(PolarAxesTest, EdgesLieMidwayBetweenUnevenCentres) {
  const PolarAxes axes{1.0, 2.0, 10, {0.0, 0.1, 0.3}};
  const std::vector<double> edges = axes.BeamEdgesRad();
  ASSERT_EQ(edges.size(), 4u);
  EXPECT_NEAR(edges[0], -0.05, 1e-15);
  EXPECT_NEAR(edges[1], 0.05, 1e-15);
  EXPECT_NEAR(edges[2], 0.2, 1e-15);
  EXPECT_NEAR(edges[3], 0.4, 1e-15);
}

TEST(PolarAxesTest, BinAtIsTheBinWhoseEdgesHoldTheRange) {
  const PolarAxes axes{0.7, 3.1, 7, {0.0, 0.1}};
  EXPECT_EQ(axes.range_edge_m(0), 0.7);
  EXPECT_NEAR(axes.range_edge_m(7), 3.1, 1e-15);
  for (int i = -5; i < 80; ++i) {
    const double range_m = 0.013 + 0.05 * i;
    int bin = -1;
    while (bin < axes.range_bins && axes.range_edge_m(bin + 1) <= range_m) ++bin;
    EXPECT_EQ(axes.BinAt(range_m), bin) << range_m;
  }
  EXPECT_EQ(axes.BinAt(0.7), 0);
  EXPECT_EQ(axes.BinAt(std::nextafter(0.7, 0.0)), -1);
  for (int bin = 0; bin < 7; ++bin) EXPECT_EQ(axes.BinAt(axes.range_centre_m(bin)), bin);
  EXPECT_EQ(axes.BinAt(-1e300), -1);
  EXPECT_EQ(axes.BinAt(1e300), 7);
}

TEST(PolarAxesTest, BeamAtIsTheBeamWhoseEdgesHoldTheAzimuth) {
  const PolarAxes axes{1.0, 2.0, 10, {-0.4, -0.31, -0.1, 0.05, 0.07, 0.3}};
  const std::vector<double> edges = axes.BeamEdgesRad();
  const auto by_edges = [&](double azimuth_rad) {
    return static_cast<int>(std::upper_bound(edges.begin(), edges.end(), azimuth_rad) - edges.begin()) - 1;
  };
  for (int i = -500; i < 500; ++i) EXPECT_EQ(axes.BeamAt(1e-3 * i), by_edges(1e-3 * i)) << i;
  for (int edge = 0; edge <= 6; ++edge) {
    EXPECT_EQ(axes.BeamEdgeRad(edge), edges[edge]);
    EXPECT_EQ(axes.BeamAt(edges[edge]), edge);
    EXPECT_EQ(axes.BeamAt(std::nextafter(edges[edge], -1.0)), edge - 1);
  }
  for (int beam = 0; beam < 6; ++beam) EXPECT_EQ(axes.BeamAt(axes.beam_azimuth_rad[beam]), beam);
  EXPECT_EQ(axes.field_of_view_rad(), edges.back() - edges.front());
  EXPECT_EQ(axes.OuterEdgeRad(), -edges.front());
}

TEST(PolarAxesTest, NoBinAndNoBeamHoldsNan) {
  const PolarAxes axes{1.0, 2.0, 10, {0.0, 0.1}};
  EXPECT_EQ(axes.BinAt(std::nan("")), -1);
  EXPECT_EQ(axes.BeamAt(std::nan("")), 2);
}

TEST(PolarAxesTest, AxesThatAreNotOrderedAreRefused) {
  EXPECT_THROW((PolarAxes{1.0, 2.0, 10, {0.1, 0.0}}.Validate("x")), DataError);
  EXPECT_THROW((PolarAxes{2.0, 1.0, 10, {0.0, 0.1}}.Validate("x")), DataError);
  EXPECT_THROW((PolarAxes{1.0, 2.0, 0, {0.0, 0.1}}.Validate("x")), DataError);
  EXPECT_NO_THROW((PolarAxes{1.0, 2.0, 1, {0.0, 0.1}}.Validate("x")));
}

TEST(PolarAxesTest, ADifferentWindowIsNamed) {
  std::string why;
  EXPECT_FALSE((PolarAxes{1.0, 2.0, 10, {0.0, 0.1}}.Matches(PolarAxes{1.0, 2.1, 10, {0.0, 0.1}}, &why)));
  EXPECT_NE(why.find("2.1"), std::string::npos) << why;
}

TEST(SceneTest, AppendSharesMaterialsByName) {
  Scene a{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {0}, {"floor"}};
  const Scene b{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}, {0, 2, 1}}, {1, 0}, {"wall", "floor"}};
  a.Append(b);
  EXPECT_EQ(a.material_names, (std::vector<std::string>{"floor", "wall"}));
  EXPECT_EQ(a.triangle_material, (std::vector<std::uint16_t>{0, 0, 1}));
  EXPECT_EQ(a.triangles[1], Eigen::Vector3i(3, 4, 5));
  EXPECT_NO_THROW(a.Validate("a"));
}

TEST(UnitsTest, DecibelsAndPowerAreInverse) {
  EXPECT_NEAR(PowerFromDb(DbFromPower(0.0321)), 0.0321, 1e-15);
  EXPECT_NEAR(DbFromPower(100.0), 20.0, 1e-12);
  for (const double power : {1e-30, 0.3, 1.0, 17.0, 1e20})
    EXPECT_NEAR(DbFromPower(power), 10.0 * std::log10(power), 1e-12 * 300.0);
  EXPECT_NEAR(PowerFromDb(-7.0), std::pow(10.0, -0.7), 1e-15);
  EXPECT_NEAR(AmplitudeFromDb(-7.0), std::pow(10.0, -0.35), 1e-15);
  EXPECT_NEAR(kNeperPerDb * kDbPerNeper, 1.0, 1e-15);
}

TEST(SonarSettings, TheFirstFieldKnownToBothThatDiffersIsNamed) {
  const SonarSettings unknown;
  const SonarSettings known{.gain_db = 18.0,
                            .pulse_length_us = 15.0,
                            .time_varied_gain = true,
                            .compression = Compression::kLogarithm};
  EXPECT_EQ(SettingsMismatch(unknown, unknown), "");
  EXPECT_EQ(SettingsMismatch(unknown, known), "");
  EXPECT_EQ(SettingsMismatch(known, known), "");
  SonarSettings other = known;
  other.pulse_length_us = 15.1;
  EXPECT_EQ(SettingsMismatch(known, other), "") << "within 1 %";
  other.pulse_length_us = 20.0;
  EXPECT_EQ(SettingsMismatch(known, other), "pulse_length_us is 15 and 20");
  other.gain_db = 24.0;
  EXPECT_EQ(SettingsMismatch(known, other), "gain_db is 18 and 24");
  other.time_varied_gain = false;
  EXPECT_EQ(SettingsMismatch(known, other), "time_varied_gain is applied and not applied");
  other.compression = Compression::kPower;
  EXPECT_EQ(SettingsMismatch(known, other), "compression is logarithm and power");
}

}  // namespace
}  // namespace sonarcal
