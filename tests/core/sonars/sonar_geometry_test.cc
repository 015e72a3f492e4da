#include "core/sonars/sonar_geometry.h"

#include <gtest/gtest.h>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal {
namespace {

PolarAxes Declared() {
  PolarAxes axes{.range_min_m = 1.0, .range_max_m = 5.0, .range_bins = 8, .beam_azimuth_rad = {}};
  for (const double azimuth_deg : {-20.0, -10.0, 0.0, 10.0, 20.0})
    axes.beam_azimuth_rad.push_back(RadFromDeg(azimuth_deg));
  return axes;
}

TEST(SonarGeometry, TheDeclaredOneChangesNothing) {
  EXPECT_TRUE(Corrected(Declared(), {}).Matches(Declared()));
  const Pose pose = {Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())), {1.0, 2.0, 3.0}};
  EXPECT_TRUE(IsSamePose(Tilted(pose, {}), pose));
}

TEST(SonarGeometry, AxesAreOffsetPlusScaleTimesDeclared) {
  const PolarAxes axes = Corrected(Declared(), {.range_offset_m = -0.02,
                                                .range_scale = 0.99,
                                                .azimuth_offset_deg = 0.5,
                                                .azimuth_scale = 1.02,
                                                .azimuth_cubic = 0.01});
  for (const int bin : {0, 3, 7}) {
    EXPECT_NEAR(axes.range_centre_m(bin), -0.02 + 0.99 * Declared().range_centre_m(bin), 1e-12);
  }
  EXPECT_NEAR(DegFromRad(axes.beam_azimuth_rad[2]), 0.5, 1e-12);
  EXPECT_NEAR(DegFromRad(axes.beam_azimuth_rad[4]), 0.5 + 20.0 * (1.02 + 0.01), 1e-12);
  EXPECT_NEAR(DegFromRad(axes.beam_azimuth_rad[1]), 0.5 - 10.0 * (1.02 + 0.01 / 4.0), 1e-12);
}

TEST(SonarGeometry, APositiveTiltLooksUpAndKeepsThePosition) {
  const Pose tilted = Tilted({}, {.tilt_deg = 30.0});
  const Eigen::Vector3d ahead = tilted.rotation * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(ahead.z(), 0.5, 1e-12);
  EXPECT_NEAR(ahead.x(), 0.0, 1e-12);
  EXPECT_TRUE(tilted.position_m.isZero());
}

TEST(SonarGeometry, BeamsOutOfOrderAreRefused) {
  EXPECT_THROW(Corrected(Declared(), {.azimuth_scale = -1.0}), DataError);
  EXPECT_THROW(Corrected(Declared(), {.range_offset_m = -2.0}), DataError);
}

}  // namespace
}  // namespace sonarcal
