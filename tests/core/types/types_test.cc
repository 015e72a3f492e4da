#include <gtest/gtest.h>

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

TEST(PoseTest, YawPitchRollComeBack) {
  const Eigen::Vector3d angles = YawPitchRollFromRotation(RotationFromYawPitchRoll(2.8, -1.2, 0.4));
  EXPECT_TRUE(angles.isApprox(Eigen::Vector3d(2.8, -1.2, 0.4), 1e-12)) << angles.transpose();
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
}

TEST(SonarSettings, TheFirstFieldThatBothTellAndThatDiffersIsNamed) {
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
