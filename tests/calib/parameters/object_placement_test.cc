#include "calib/parameters/object_placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

// Two triangles that share an edge: one of material "a", one of material "b".
Scene SharedEdge() {
  Scene scene;
  scene.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  scene.triangles = {{0, 1, 2}, {1, 3, 2}};
  scene.material_names = {"a", "b"};
  scene.triangle_material = {0, 1};
  return scene;
}

TEST(PlaceableObject, AMaterialMovesWithoutTheMaterialsThatShareItsVertices) {
  Scene scene = SharedEdge();
  const PlaceableObject object(scene, "b");
  EXPECT_EQ(scene.vertices_m.size(), 6U);
  scene.Validate("scene");
  ObjectPlacement placement;
  placement.step(2) = 0.5;
  object.Place(placement, scene);
  for (const int vertex : scene.triangles[0]) EXPECT_EQ(scene.vertices_m[vertex].z(), 0.0F);
  for (const int vertex : scene.triangles[1]) EXPECT_EQ(scene.vertices_m[vertex].z(), 0.5F);
}

TEST(PlaceableObject, ItTurnsAndGrowsAboutTheCentreOfItsBox) {
  Scene scene = SharedEdge();
  scene.objects = {{.name = "plate", .first_vertex = 0, .vertex_count = 4}};
  const PlaceableObject object(scene, "plate");
  ObjectPlacement placement;
  placement.step << 1.0, 0.0, 0.0, 0.0, 0.0, 90.0;
  placement.scale = {2.0, 1.0, 1.0};
  object.Place(placement, scene);
  // (0, 0) is (-1/2, -1/2) from the centre, (-1, -1/2) after the scale, (1/2, -1) after the turn.
  EXPECT_TRUE(scene.vertices_m[0].isApprox(Eigen::Vector3f(2.0F, -0.5F, 0.0F), 1e-5F))
      << scene.vertices_m[0].transpose();
}

TEST(PlaceableObject, AnUnknownNameIsRefusedWithTheKnownOnes) {
  Scene scene = SharedEdge();
  scene.objects = {{.name = "plate", .first_vertex = 0, .vertex_count = 4}};
  try {
    const PlaceableObject object(scene, "mockup");
    FAIL() << "expected a DataError";
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), "no object 'mockup' in the scene, expected one of a, b, plate");
  }
}

}  // namespace
}  // namespace sonarcal::calib
