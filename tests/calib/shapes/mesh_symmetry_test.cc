#include "calib/shapes/mesh_symmetry.h"

#include <gtest/gtest.h>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/scenes/scene_primitives.h"
#include "sim/scenes/scenes.h"
#include "tests/calib/small_body.h"

namespace sonarcal::calib {
namespace {

Scene Moved(Scene scene, const Pose& pose) {
  for (Eigen::Vector3f& vertex : scene.vertices_m)
    vertex = Eigen::Vector3d(pose * vertex.cast<double>()).cast<float>();
  return scene;
}

TEST(MeshSymmetryTest, ABodyOfRevolutionIsFoundInAnyFrame) {
  const Scene body = sim::MakeBody({.max_edge_m = 0.03});
  const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized())),
                  {3.0, -1.0, 0.5}};
  for (const bool moved : {false, true}) {
    const MeshSymmetry symmetry = FindSymmetry(moved ? Moved(body, pose) : body);
    EXPECT_EQ(symmetry.revolution, Revolution::kAxis);
    EXPECT_TRUE(symmetry.half_turn[0]);
    EXPECT_FALSE(symmetry.half_turn[1]);  // a nose and a tail
    EXPECT_FALSE(symmetry.reflection[0]);
    EXPECT_TRUE(symmetry.reflection[1]);
    EXPECT_TRUE(symmetry.reflection[2]);
    const Eigen::Vector3d axis = symmetry.mesh_from_body.rotation * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d expected =
        moved ? Eigen::Vector3d(pose.rotation * Eigen::Vector3d::UnitX()) : Eigen::Vector3d::UnitX();
    EXPECT_NEAR(std::abs(axis.dot(expected)), 1.0, 1e-4);
  }
}

TEST(MeshSymmetryTest, ACylinderCanBeReversed) {
  const MeshSymmetry symmetry = FindSymmetry(sim::MakeCylinder({0, 0, 0}, {0, 0, 0.8}, 0.1, 0.02, "body"));
  EXPECT_EQ(symmetry.revolution, Revolution::kAxis);
  EXPECT_TRUE(symmetry.half_turn[1] && symmetry.half_turn[2]);
  EXPECT_NEAR((symmetry.mesh_from_body.position_m - Eigen::Vector3d(0, 0, 0.4)).norm(), 0.0, 1e-3);
}

// Equal moments do not make a body of revolution.
TEST(MeshSymmetryTest, ABoxIsNoBodyOfRevolution) {
  for (const Eigen::Vector3d& size :
       {Eigen::Vector3d(0.6, 0.2, 0.2), Eigen::Vector3d(0.3, 0.3, 0.3), Eigen::Vector3d(0.6, 0.3, 0.1)}) {
    const MeshSymmetry symmetry = FindSymmetry(sim::MakeBox({0, 0, 0}, size, sim::kUndivided, "body"));
    EXPECT_EQ(symmetry.revolution, Revolution::kNone);
  }
  const MeshSymmetry box = FindSymmetry(sim::MakeBox({0, 0, 0}, {0.6, 0.3, 0.1}, sim::kUndivided, "body"));
  EXPECT_TRUE(box.half_turn[0] && box.half_turn[1] && box.half_turn[2]);
  EXPECT_NEAR(box.extent_m, 0.6, 1e-4);
  EXPECT_NEAR(box.radius_m, Eigen::Vector3d(0.3, 0.15, 0.05).norm(), 1e-4);
}

TEST(MeshSymmetryTest, AHookHasOnePlaneOfSymmetry) {
  const MeshSymmetry symmetry = FindSymmetry(testing::MakeHook());
  EXPECT_EQ(symmetry.revolution, Revolution::kNone);
  EXPECT_FALSE(symmetry.half_turn[0] || symmetry.half_turn[1] || symmetry.half_turn[2]);
  EXPECT_EQ(symmetry.reflection[0] + symmetry.reflection[1] + symmetry.reflection[2], 1);
}

TEST(MeshSymmetryTest, AMeshWithoutAreaIsRefused) {
  EXPECT_THROW(FindSymmetry(Scene{}), DataError);
}

}  // namespace
}  // namespace sonarcal::calib
