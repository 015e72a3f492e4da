#include "sim/physics/patch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sonarcal::sim {
namespace {

// A ray of 1e-4 sr, 5 m away, on a surface at 60 degrees: 25 m^2 1e-4 / 0.5.
TEST(PatchTest, AreaIsTheCrossSectionOverTheCosine) {
  EXPECT_NEAR(PatchAreaM2(5.0, 1e-4, 0.5), 5e-3, 1e-15);
  EXPECT_NEAR(PatchAreaM2(2.0, 1e-4, 1.0), 4e-4, 1e-15);
}

TEST(PatchTest, DepthIsTheHeightTimesTheTangent) {
  for (const double incidence_rad : {0.2, 0.7, 1.3}) {
    EXPECT_NEAR(PatchDepthM(5.0, 0.01, std::cos(incidence_rad)), 0.05 * std::tan(incidence_rad), 1e-12);
  }
  EXPECT_EQ(PatchDepthM(5.0, 0.01, 1.0), 0.0);
  EXPECT_EQ(PatchDepthM(5.0, 0.01, 1.0 + 1e-9), 0.0) << "a cosine beyond 1 by rounding";
}

TEST(PatchTest, NoSurfaceIsSteeperThanTheSmallestCosine) {
  EXPECT_NEAR(PatchAreaM2(3.0, 1e-4, 0.001), 9e-4 / 0.02, 1e-12);
  EXPECT_NEAR(LargestTangent(), std::tan(std::acos(0.02)), 1e-9);
  EXPECT_NEAR(PatchDepthM(3.0, 0.01, 0.001), 0.03 * LargestTangent(), 1e-9);
}

}  // namespace
}  // namespace sonarcal::sim
