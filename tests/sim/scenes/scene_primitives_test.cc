#include "sim/scenes/scene_primitives.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "tests/support/mesh_checks.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;
using testing::Bounds;
using testing::EulerCharacteristic;
using testing::IsClosed;
using testing::SignedVolumeM3;

// Area of a regular polygon over that of its circumscribed circle.
double PolygonShare(int sides) {
  return sides / (2.0 * kPi) * std::sin(2.0 * kPi / sides);
}

TEST(ScenePrimitivesTest, APatchFacesAlongTheProductOfItsSides) {
  const Scene patch = MakePatch({1, 2, 3}, {2, 0, 0}, {0, 1, 0}, 0.5, "floor");
  EXPECT_EQ(patch.triangles.size(), 2u * 4u * 2u);
  EXPECT_EQ(patch.vertices_m.size(), 5u * 3u);
  EXPECT_EQ(patch.material_names, std::vector<std::string>{"floor"});
  double area_m2 = 0.0;
  for (const Eigen::Vector3i& triangle : patch.triangles) {
    const auto [a, b, c] = testing::Corners(patch, triangle);
    const Vector3d normal = 0.5 * (b - a).cross(c - a);
    EXPECT_GT(normal.z(), 0.0);
    area_m2 += normal.norm();
  }
  EXPECT_NEAR(area_m2, 2.0, 1e-6);
}

TEST(ScenePrimitivesTest, ABoxIsClosedWhateverItsDivision) {
  for (const double max_edge_m : {kUndivided, 0.7, 0.3}) {
    const Scene box = MakeBox({-1, 0, 2}, {0.5, 1, 2.5}, max_edge_m, "box");
    EXPECT_TRUE(IsClosed(box)) << max_edge_m;
    EXPECT_EQ(EulerCharacteristic(box), 2) << max_edge_m;
    EXPECT_NEAR(SignedVolumeM3(box), 0.75, 1e-6) << max_edge_m;
    EXPECT_TRUE(Bounds(box).isApprox({Vector3d(-1, 0, 2), Vector3d(0.5, 1, 2.5)}));
  }
  EXPECT_EQ(MakeBox({0, 0, 0}, {1, 1, 1}, kUndivided, "box").triangles.size(), 12u);
  EXPECT_EQ(MakeBox({0, 0, 0}, {1, 2, 3}, 0.1, "box").triangles.size(), 4u * (200 + 600 + 300));
}

TEST(ScenePrimitivesTest, ACylinderHoldsTheVolumeOfItsPrism) {
  const Vector3d axis_m(0.3, -0.4, 1.2);
  const double max_edge_m = 0.1;
  const Scene cylinder = MakeCylinder({1, 1, 1}, axis_m, 0.5, max_edge_m, "pipe");
  EXPECT_TRUE(IsClosed(cylinder));
  EXPECT_EQ(EulerCharacteristic(cylinder), 2);
  const double exact_m3 = kPi * 0.25 * axis_m.norm() * PolygonShare(SectorsFor(0.5, max_edge_m, 3));
  EXPECT_NEAR(SignedVolumeM3(cylinder), exact_m3, 1e-5);
  for (const Eigen::Vector3f& vertex_m : cylinder.vertices_m) {
    const Vector3d from_base_m = vertex_m.cast<double>() - Vector3d::Ones();
    EXPECT_LE(from_base_m.cross(axis_m.normalized()).norm(), 0.5 + 1e-6);
  }
}

TEST(ScenePrimitivesTest, ACylinderMayPointAgainstTheXAxis) {
  const Scene cylinder = MakeCylinder({0, 0, 0}, {-2, 0, 0}, 0.5, kUndivided, "pipe");
  EXPECT_GT(SignedVolumeM3(cylinder), 0.0);
  EXPECT_NEAR(Bounds(cylinder).min().x(), -2.0, 1e-6);
  EXPECT_NEAR(Bounds(cylinder).max().x(), 0.0, 1e-6);
}

TEST(ScenePrimitivesTest, ATubeIsARing) {
  const double max_edge_m = 0.05;
  const Scene tube = MakeTube({0, 0, 0}, {0, 0, 0.4}, 0.2, 0.3, max_edge_m, "flange");
  EXPECT_TRUE(IsClosed(tube));
  EXPECT_EQ(EulerCharacteristic(tube), 0);
  const double exact_m3 = kPi * (0.09 - 0.04) * 0.4 * PolygonShare(SectorsFor(0.3, max_edge_m, 3));
  EXPECT_NEAR(SignedVolumeM3(tube), exact_m3, 1e-6);
}

TEST(ScenePrimitivesTest, ASphereByRevolutionConvergesToItsVolume) {
  double last_error_m3 = 1.0;
  for (const int rings : {8, 16, 32}) {
    std::vector<ProfilePoint> profile = {{-1.0, 0.0}};
    for (int i = 1; i < rings; ++i) {
      profile.push_back({-std::cos(kPi * i / rings), std::sin(kPi * i / rings)});
    }
    profile.push_back({1.0, 0.0});
    const Scene sphere = MakeRevolution(profile, 2 * rings, false, "sphere");
    EXPECT_TRUE(IsClosed(sphere));
    EXPECT_EQ(EulerCharacteristic(sphere), 2);
    const double error_m3 = 4.0 / 3.0 * kPi - SignedVolumeM3(sphere);
    EXPECT_GT(error_m3, 0.0);                           // inscribed
    EXPECT_LT(error_m3, last_error_m3 / 3.0) << rings;  // second order
    last_error_m3 = error_m3;
  }
}

TEST(ScenePrimitivesTest, NoQuadrilateralSideIsLongerThanAllowed) {
  const double max_edge_m = 0.11;
  const Scene tube = MakeTube({0, 0, 0}, {0, 0, 0.5}, 0.2, 0.4, max_edge_m, "flange");
  for (const Eigen::Vector3i& triangle : tube.triangles) {
    const auto [a, b, c] = testing::Corners(tube, triangle);
    const double longest_m = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
    EXPECT_LE(longest_m, std::sqrt(2.0) * max_edge_m);
  }
}

TEST(ScenePrimitivesTest, DegenerateShapesAreRefused) {
  EXPECT_THROW(MakeBox({0, 0, 0}, {1, 0, 1}, kUndivided, "box"), DataError);
  EXPECT_THROW(MakeBox({0, 0, 0}, {1, 1, 1}, 0.0, "box"), DataError);
  EXPECT_THROW(MakeBox({0, 0, 0}, {1, 1, 1}, 1e-5, "box"), DataError);
  EXPECT_THROW(MakeBox({0, 0, 0}, {1, 1, 1}, 1e-300, "box"), DataError);
  EXPECT_THROW(MakePatch({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, kUndivided, "floor"), DataError);
  EXPECT_THROW(MakeCylinder({0, 0, 0}, {0, 0, 0}, 1.0, kUndivided, "pipe"), DataError);
  EXPECT_THROW(MakeCylinder({0, 0, 0}, {0, 0, 1}, -1.0, kUndivided, "pipe"), DataError);
  EXPECT_THROW(MakeTube({0, 0, 0}, {0, 0, 1}, 0.3, 0.3, kUndivided, "flange"), DataError);
  EXPECT_THROW(MakeRevolution({{0.0, 0.1}, {1.0, 1.0}, {2.0, 0.0}}, 8, false, "body"), DataError);
  EXPECT_THROW(MakeRevolution({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, 8, false, "body"), DataError);
}

}  // namespace
}  // namespace sonarcal::sim
