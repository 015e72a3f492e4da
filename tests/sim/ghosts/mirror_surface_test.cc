#include "sim/ghosts/mirror_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/rays/ray_caster.h"
#include "tests/sim/meshes.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

// Coddington's equations: a spherical mirror of radius a, met at the angle i, adds 2 / (a cos i) to the
// curvature of a wave in the plane of incidence and 2 cos i / a across it; the other way round from inside.
TEST(MirrorSurface, SphereSpreadsAsCoddingtonSays) {
  constexpr double kRadiusM = 0.8;
  Scene scene;
  AddSphere(scene, {0, 0, 0}, kRadiusM, 400, "mirror");
  const RayCaster caster(scene);
  const MirrorSurface mirrors(caster.scene(), {1});
  for (const double inside : {0.0, 1.0}) {
    for (const double aside : {0.02, 0.2, 0.45}) {
      // Away from the poles, where triangles are thin.
      const Eigen::Vector3d from(inside == 0.0 ? 2.0 : -0.35, 0.013, 0.021);
      const Eigen::Vector3d to = kRadiusM * Eigen::Vector3d(1.0, aside, 0.3 * aside).normalized();
      const RayBundle sent(from, (to - from).normalized());
      FreeRays ray;
      ray.Add(from, sent.direction, 10.0);
      const FanHits hit = caster.FirstIntersections(ray);
      ASSERT_GE(hit.triangle[0], 0);
      const double first_m = hit.range_m[0];
      const Eigen::Vector3d normal = sent.At(first_m).normalized();
      const double cosine = std::abs(sent.direction.dot(normal));
      const RayBundle reflected = mirrors.Reflected(sent, hit.triangle[0], first_m);
      const Eigen::Vector3d expected = sent.direction - 2.0 * sent.direction.dot(normal) * normal;
      EXPECT_LT((reflected.direction - expected).norm(), 2e-4);
      const double sign = inside == 0.0 ? 1.0 : -1.0;
      for (const double second_m : {0.1, 1.5}) {
        const double along = first_m + second_m + sign * 2.0 * first_m * second_m / (kRadiusM * cosine);
        const double across = first_m + second_m + sign * 2.0 * first_m * second_m * cosine / kRadiusM;
        EXPECT_NEAR(reflected.SpreadingM(second_m), std::sqrt(std::abs(along * across)),
                    0.02 * (first_m + second_m))
            << "inside " << inside << ", aside " << aside << ", " << second_m << " m on";
      }
    }
  }
}

TEST(MirrorSurface, AFlatMirrorKeepsTheSpreadingOfTheBundle) {
  Scene scene;
  AddBox(scene, {-1, -1, -1}, {1, 1, 1}, "mirror");
  const MirrorSurface mirrors(scene, {1});
  const RayBundle sent({0.1, 0.2, 0.3}, Eigen::Vector3d(0.4, 0.9, -0.1).normalized());
  for (int triangle = 0; triangle < 12; ++triangle) {
    EXPECT_EQ(mirrors.Reflected(sent, triangle, 1.25).SpreadingM(0.5), 1.75);
  }
}

}  // namespace
}  // namespace sonarcal::sim
