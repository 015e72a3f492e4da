#include "sim/rays/ray_caster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/types/error.h"
#include "tests/sim/meshes.h"

namespace sonarcal::sim {
namespace {

using testing::AddBox;
using testing::AddQuad;
using testing::AddTriangle;

// A suite of its own, so that no other test runs in its process before it.
TEST(FloatingPointMode, IsThatOfTheCallerAfterATreeIsBuilt) {
  Scene scene;
  AddQuad(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, "wall");
  const RayCaster caster(scene);
  volatile double smallest_normal = std::numeric_limits<double>::min();
  double half = 0.0;
  tbb::parallel_for(0, 1, [&](int) { half = 0.5 * smallest_normal; });
  EXPECT_GT(half, 0.0) << "denormal numbers are flushed to zero";
}

SonarModel WideSonar() {
  SonarModel sonar{.name = "test sonar",
                   .frequency_hz = 900e3,
                   .axes = {0.0, 50.0, 100, {}},
                   .azimuth_beam_width_deg = 1.0,
                   .elevation_beam_width_deg = 60.0,
                   .sound_speed_m_per_s = 1466.0};
  for (int beam = 0; beam < 40; ++beam)
    sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(3.0 * (beam - 19.5)));
  return sonar;
}

// 120 x 60 degrees; 37 columns leave a last packet of rays that is not full.
RayFan WideFan() {
  return RayFan(WideSonar(), {.sampling = Sampling::kFrustum, .cols = 37, .rows = 23});
}

struct Hit {
  double range_m = std::numeric_limits<double>::infinity();
  int triangle = -1;
  bool doubtful = false;  // float arithmetic may well decide otherwise
};

// Moeller and Trumbore's intersection, in double, over every triangle.
Hit BruteForce(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  Hit hit;
  double nearest_doubt = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Eigen::Vector3d a = scene.vertices_m[scene.triangles[i][0]].cast<double>();
    const Eigen::Vector3d e1 = scene.vertices_m[scene.triangles[i][1]].cast<double>() - a;
    const Eigen::Vector3d e2 = scene.vertices_m[scene.triangles[i][2]].cast<double>() - a;
    const Eigen::Vector3d p = direction.cross(e2);
    const double determinant = e1.dot(p);
    if (determinant == 0.0) continue;
    const Eigen::Vector3d s = origin - a;
    const double u = s.dot(p) / determinant;
    const Eigen::Vector3d q = s.cross(e1);
    const double v = direction.dot(q) / determinant;
    const double t = e2.dot(q) / determinant;
    const double inside = std::min({u, v, 1.0 - u - v});
    const double cosine = std::abs(determinant) / e1.cross(e2).norm();
    if (inside < -1e-4 || t < -1e-4) continue;
    // On an edge, edge-on, or at the sonar itself.
    if (inside < 1e-4 || cosine < 0.02 || t < 1e-4) nearest_doubt = std::min(nearest_doubt, t);
    if (inside >= 0.0 && t > 0.0 && t < hit.range_m) {
      if (hit.range_m - t < 1e-4) nearest_doubt = std::min(nearest_doubt, t);
      hit.range_m = t;
      hit.triangle = static_cast<int>(i);
    } else if (inside >= 0.0 && t - hit.range_m < 1e-4) {
      nearest_doubt = std::min(nearest_doubt, hit.range_m);
    }
  }
  hit.doubtful = std::isfinite(nearest_doubt) && nearest_doubt <= hit.range_m + 1e-4;
  return hit;
}

TEST(RayCaster, EqualsBruteForceOverRandomTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-4.0, 4.0);
  std::uniform_real_distribution<double> extent(-1.5, 1.5);
  const auto point = [&](auto& distribution) {
    return Eigen::Vector3d(distribution(random), distribution(random), distribution(random));
  };
  Scene scene;
  for (int i = 0; i < 120; ++i) {
    const Eigen::Vector3d a = point(place);
    AddTriangle(scene, a, a + point(extent), a + point(extent), "any");
  }
  const RayCaster caster(scene);
  const RayFan fan = WideFan();
  int hits = 0;
  int misses = 0;
  int doubtful = 0;
  for (int i = 0; i < 12; ++i) {
    const Pose pose{Eigen::Quaterniond::UnitRandom(), point(place)};
    const FanHits cast = caster.Cast(fan, pose, 1e3);
    for (int row = 0; row < fan.rows(); ++row) {
      for (int col = 0; col < fan.cols(); ++col) {
        const Hit expected =
            BruteForce(scene, pose.position_m, pose.rotation * fan.Direction(row, col).cast<double>());
        doubtful += expected.doubtful ? 1 : 0;
        if (expected.doubtful) continue;
        const std::size_t ray = static_cast<std::size_t>(row) * fan.cols() + col;
        ASSERT_EQ(cast.triangle[ray], expected.triangle) << "pose " << i << ", ray " << ray;
        if (expected.triangle < 0) {
          ++misses;
          EXPECT_TRUE(std::isinf(cast.range_m[ray]));
        } else {
          ++hits;
          // Coordinates below 10 m in float: 1e-6 m along the normal, over a cosine of at least 0.02.
          ASSERT_NEAR(cast.range_m[ray], expected.range_m, 1e-4) << "pose " << i << ", ray " << ray;
        }
      }
    }
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 1000);
  EXPECT_LT(doubtful, (hits + misses) / 100);
}

TEST(RayCaster, EveryCastRayIsCountedMissesIncluded) {
  Scene scene;
  AddQuad(scene, {-9, 5, -9}, {18, 0, 0}, {0, 0, 18}, "wall");
  const RayCaster caster(scene);
  const RayFan fan = WideFan();
  EXPECT_EQ(caster.rays_cast(), 0);
  caster.Cast(fan, Pose{}, 10.0);
  EXPECT_EQ(caster.rays_cast(), 37 * 23);
  caster.Cast(fan, Pose{}, 1.0);  // misses count too
  EXPECT_EQ(caster.rays_cast(), 2 * 37 * 23);
}

TEST(RayCaster, NothingIsMetBeyondTheLimit) {
  Scene scene;
  AddQuad(scene, {-90, 5, -90}, {180, 0, 0}, {0, 0, 180}, "wall");
  const RayCaster caster(scene);
  const RayFan fan = WideFan();
  const double limit_m = 6.0;
  const FanHits hits = caster.Cast(fan, Pose{}, limit_m);
  int within = 0;
  for (int ray = 0; ray < fan.size(); ++ray) {
    const double range_m = 5.0 / fan.Direction(ray / fan.cols(), ray % fan.cols()).y();
    ASSERT_GT(std::abs(range_m - limit_m), 1e-5);
    EXPECT_EQ(hits.triangle[ray] >= 0, range_m < limit_m);
    within += range_m < limit_m ? 1 : 0;
  }
  EXPECT_GT(within, 50);
  EXPECT_LT(within, fan.size() - 50);
}

TEST(RayCaster, SurfacesBehindTheSonarAreNotSeen) {
  Scene scene;
  AddQuad(scene, {-90, -5, -90}, {180, 0, 0}, {0, 0, 180}, "wall");
  const RayCaster caster(scene);
  EXPECT_THAT(caster.Cast(WideFan(), Pose{}, 1e3).triangle, ::testing::Each(-1));
  const Pose turned{RotationFromYawPitchRoll(kPi, 0.0, 0.0), Eigen::Vector3d::Zero()};
  EXPECT_THAT(caster.Cast(WideFan(), turned, 1e3).triangle, ::testing::Each(::testing::Ge(0)));
}

// From inside a closed box every ray meets a face, and edges let nothing through.
TEST(RayCaster, SonarInsideABox) {
  const Eigen::Vector3d low(-3, -4, -1);
  const Eigen::Vector3d high(5, 2, 2);
  Scene scene;
  AddBox(scene, low, high, "tank");
  const RayCaster caster(scene);
  const RayFan fan = WideFan();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.1, 0.9);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d at =
        low + (high - low).cwiseProduct(Eigen::Vector3d(unit(random), unit(random), unit(random)));
    const Pose pose{Eigen::Quaterniond::UnitRandom(), at};
    const FanHits hits = caster.Cast(fan, pose, 1e3);
    for (int ray = 0; ray < fan.size(); ++ray) {
      const Eigen::Vector3d direction =
          pose.rotation * fan.Direction(ray / fan.cols(), ray % fan.cols()).cast<double>();
      double range_m = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        range_m =
            std::min(range_m, ((direction[axis] > 0.0 ? high : low)[axis] - at[axis]) / direction[axis]);
      }
      ASSERT_NEAR(hits.range_m[ray], range_m, 1e-5);
    }
  }
}

TEST(RayCaster, KeepsNormalsAndMaterialsOfTriangles) {
  Scene scene;
  AddQuad(scene, {0, 0, 0}, {2, 0, 0}, {0, 3, 0}, "floor");
  AddTriangle(scene, {0, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}, "speck");  // tiny, yet a unit normal
  const RayCaster caster(scene);
  EXPECT_EQ(caster.TriangleNormal(1), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(caster.TriangleNormal(2), Eigen::Vector3f(1, 0, 0));
  EXPECT_THAT(caster.material_names(), ::testing::ElementsAre("floor", "speck"));
  EXPECT_EQ(caster.TriangleMaterial(1), 0);
  EXPECT_EQ(caster.TriangleMaterial(2), 1);
}

TEST(RayCaster, RefusesABrokenScene) {
  EXPECT_THROW(RayCaster(Scene{}), DataError);
  Scene scene;
  AddQuad(scene, {0, 0, 0}, {2, 0, 0}, {0, 3, 0}, "floor");
  scene.triangles[1][2] = 99;
  EXPECT_THROW(RayCaster{scene}, DataError);
}

}  // namespace
}  // namespace sonarcal::sim
