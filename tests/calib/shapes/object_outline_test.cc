#include "calib/shapes/object_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "calib/shapes/object_vertices.h"
#include "core/types/error.h"
#include "tests/calib/small_body.h"

namespace sonarcal::calib {
namespace {

using testing::CoarseSonar;

OutlineForm FormOf(const Scene& scene, const std::string& name) {
  return OutlineForms(scene, CoarseSonar().axes, {name}).front();
}

// Returns the scene with the outline of a part at these values.
Scene Reshaped(Scene scene, const OutlineForm& form, const std::vector<double>& values) {
  DivideForOutline(form, scene);
  const ObjectOutline outline(scene, form);
  outline.Reshape(values, scene);
  scene.Validate("scene");
  return scene;
}

Scene Cylinder() {
  return sim::MakeTurnedSolid({{-0.3, 0.1}, {0.3, 0.1}}, sim::kUndivided, "body");
}

Scene Sphere(double radius_m) {
  std::vector<sim::ProfilePoint> profile;
  for (int i = 0; i <= 24; ++i) {
    const double angle = kPi * (1.0 - i / 24.0);
    profile.push_back({radius_m * std::cos(angle), i % 24 == 0 ? 0.0 : radius_m * std::sin(angle)});
  }
  return sim::MakeRevolution(profile, 48, false, "body");
}

// True if each edge belongs to two triangles, once in each direction. Vertices of one place count as one.
bool IsClosed(const Scene& scene) {
  std::map<std::array<float, 3>, int> places;
  const auto place = [&](int vertex) {
    const Eigen::Vector3f& v = scene.vertices_m[vertex];
    return places.try_emplace({v.x(), v.y(), v.z()}, static_cast<int>(places.size())).first->second;
  };
  std::map<std::pair<int, int>, int> edges;
  for (const Eigen::Vector3i& t : scene.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int a = place(t(i));
      const int b = place(t((i + 1) % 3));
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
}

TEST(ObjectOutline, ABodyOfRevolutionHasRadiiAtStationsAlongItsAxis) {
  const OutlineForm form = FormOf(Cylinder(), "body");
  EXPECT_TRUE(form.revolution);
  // 0.6 m over four beams of 0.5 degrees at 1.4 m, 49 mm.
  EXPECT_EQ(form.count, 13);
  EXPECT_NEAR(form.half_size_m, 0.1, 0.001);
  EXPECT_EQ(form.NameOf(7), "radius_07_m");
}

TEST(ObjectOutline, ADiscAndAStripHaveBumpsOfABoundedNumberOfTriangles) {
  const Scene disc = sim::MakeTurnedSolid({{-1e-6, 0.1}, {1e-6, 0.1}}, sim::kUndivided, "body");
  const Scene strip = sim::MakeBox({0.0, 0.0, 0.0}, {1.0, 1e-3, 1e-7}, sim::kUndivided, "body");
  for (const Scene& scene : {disc, strip}) {
    const OutlineForm form = FormOf(scene, "body");
    EXPECT_FALSE(form.revolution);
    Scene divided = scene;
    DivideForOutline(form, divided);
    EXPECT_LT(divided.triangles.size(), 100'000U);
    EXPECT_NEAR(SurfaceAreaM2(divided), SurfaceAreaM2(scene), 1e-5 * SurfaceAreaM2(scene));
  }
}

TEST(ObjectOutline, EqualValuesWidenACylinderAndKeepItsLength) {
  const OutlineForm form = FormOf(Cylinder(), "body");
  const Scene wide = Reshaped(Cylinder(), form, std::vector<double>(form.count, 0.01));
  EXPECT_TRUE(IsClosed(wide));
  double most = 0.0;
  for (const Eigen::Vector3f& v : wide.vertices_m) {
    EXPECT_LE(std::abs(v.x()), 0.3 + 1e-6);
    most = std::max(most, double{std::hypot(v.y(), v.z())});
  }
  EXPECT_NEAR(most, 0.11, 1e-5);
  EXPECT_NEAR(SurfaceAreaM2(wide),
              SurfaceAreaM2(sim::MakeTurnedSolid({{-0.3, 0.11}, {0.3, 0.11}}, sim::kUndivided, "body")),
              0.02 * SurfaceAreaM2(wide));
}

TEST(ObjectOutline, OneValueChangesTheRadiusNearItsStationOnly) {
  const OutlineForm form = FormOf(Cylinder(), "body");
  std::vector<double> values(form.count, 0.0);
  values[3] = 0.02;
  const Scene bulged = Reshaped(Cylinder(), form, values);
  const double station = form.start_m + 3 * form.spacing_m;
  double most = 0.0;
  for (const Eigen::Vector3f& v : bulged.vertices_m) {
    const Eigen::Vector3d body = form.mesh_from_body.Inverse() * Eigen::Vector3d(v.cast<double>());
    const double radius = std::hypot(body.y(), body.z());
    most = std::max(most, radius);
    if (std::abs(body.x() - station) > 2.0 * form.spacing_m) {
      EXPECT_LE(radius, 0.1 + 1e-6);
    }
  }
  EXPECT_NEAR(most, 0.12, 0.002);
}

TEST(ObjectOutline, ARadiusStaysPositive) {
  const OutlineForm form = FormOf(Cylinder(), "body");
  Scene divided = Cylinder();
  DivideForOutline(form, divided);
  Scene thin = divided;
  ObjectOutline(thin, form).Reshape(std::vector<double>(form.count, -1.0), thin);
  for (std::size_t i = 0; i < thin.vertices_m.size(); ++i) {
    const Eigen::Vector3f& before = divided.vertices_m[i];
    const Eigen::Vector3f& after = thin.vertices_m[i];
    EXPECT_GE(after.y() * before.y() + after.z() * before.z(), 0.0F);
  }
}

TEST(ObjectOutline, EqualBumpsWidenASphere) {
  const OutlineForm form = FormOf(Sphere(0.2), "body");
  EXPECT_FALSE(form.revolution);
  EXPECT_EQ(form.count, kMaxOutlineValues);
  EXPECT_EQ(form.NameOf(3), "bump_03_m");
  const Scene wide = Reshaped(Sphere(0.2), form, std::vector<double>(form.count, 0.01));
  EXPECT_TRUE(IsClosed(wide));
  for (const Eigen::Vector3f& v : wide.vertices_m) EXPECT_NEAR(v.norm(), 0.21, 0.002);
}

TEST(ObjectOutline, ABumpIsLocalAndOpensNoCrack) {
  // Each face of this hook has vertices of its own.
  const Scene hook = testing::MakeHook();
  const OutlineForm form = FormOf(hook, "body");
  EXPECT_FALSE(form.revolution);
  std::vector<double> values(form.count, 0.0);
  values[2] = 0.01;
  Scene divided = hook;
  DivideForOutline(form, divided);
  EXPECT_NEAR(SurfaceAreaM2(divided), SurfaceAreaM2(hook), 1e-5);
  const Scene bumped = Reshaped(hook, form, values);
  EXPECT_EQ(IsClosed(divided), IsClosed(bumped));
  int moved = 0;
  for (std::size_t i = 0; i < bumped.vertices_m.size(); ++i) {
    const double by = (bumped.vertices_m[i] - divided.vertices_m[i]).norm();
    EXPECT_LE(by, 0.0101);
    moved += by > 0.002 ? 1 : 0;
  }
  EXPECT_GT(moved, 0);
  EXPECT_LT(moved, static_cast<int>(bumped.vertices_m.size()) / 2);
}

// In coordinates of a map, floats are half a metre apart.
TEST(ObjectOutline, DivisionEndsFarFromTheOrigin) {
  Scene scene = sim::MakeBox({0.0, 4.6e6, 0.0}, {2.0, 4.6e6 + 2.0, 2.0}, sim::kUndivided, "box");
  DivideObject(scene, "box", 0.2);
  EXPECT_LT(scene.vertices_m.size(), 3000U);
}

TEST(ObjectOutline, DivisionKeepsTheVerticesOfEachPartConsecutive) {
  Scene scene = Cylinder();
  const std::size_t first = scene.vertices_m.size();
  scene.Append(sim::MakeBox({1.0, 0.0, 0.0}, {1.1, 0.1, 0.1}, sim::kUndivided, "box"));
  scene.objects = {{"all", 0, scene.vertices_m.size()},
                   {"bomb", 0, first},
                   {"nose", 0, 3},
                   {"crate", first, scene.vertices_m.size() - first}};
  const double area = SurfaceAreaM2(scene);
  DivideObject(scene, "bomb", 0.05);
  scene.Validate("scene");
  EXPECT_NEAR(SurfaceAreaM2(scene), area, 1e-5);
  ASSERT_EQ(scene.objects.size(), 3U) << "a part of the divided part loses its name";
  EXPECT_EQ(scene.objects[0].vertex_count, scene.vertices_m.size());
  EXPECT_GT(scene.objects[1].vertex_count, first);
  EXPECT_EQ(scene.objects[2].first_vertex, scene.objects[1].vertex_count);
  for (const std::size_t vertex : VerticesOfObject(scene, "crate"))
    EXPECT_GE(scene.vertices_m[vertex].x(), 1.0F);
  EXPECT_EQ(MeshOfVertices(scene, VerticesOfObject(scene, "crate")).triangles.size(), 12U);
  for (const Eigen::Vector3i& t : scene.triangles) {
    for (int i = 0; i < 3; ++i) {
      const float edge = (scene.vertices_m[t(i)] - scene.vertices_m[t((i + 1) % 3)]).norm();
      if (scene.vertices_m[t(i)].x() < 0.5F) {
        EXPECT_LE(edge, 0.05F);
      }
    }
  }
}

TEST(ObjectOutline, AnUnknownNameIsRefusedWithTheKnownOnes) {
  try {
    FormOf(Cylinder(), "nose");
    FAIL() << "expected a DataError";
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), "no object 'nose' in the scene, expected one of body");
  }
}

}  // namespace
}  // namespace sonarcal::calib
