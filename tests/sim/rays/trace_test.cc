#include "sim/rays/trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/types/error.h"
#include "tests/sim/meshes.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal::sim {
namespace {

using testing::AddBox;
using testing::AddQuad;
using testing::AddSphere;
using testing::WithThreads;

SonarModel TestSonar(double range_min_m, double range_max_m) {
  SonarModel sonar{.name = "test sonar",
                   .frequency_hz = 900e3,
                   .axes = {range_min_m, range_max_m, 100, {}},
                   .azimuth_beam_width_deg = 1.0,
                   .elevation_beam_width_deg = 30.0,
                   .sound_speed_m_per_s = 1466.0};
  for (int beam = 0; beam < 45; ++beam) sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(beam - 22.0));
  return sonar;
}

RayFan TestFan(const SonarModel& sonar, Sampling sampling = Sampling::kFrustum) {
  return RayFan(sonar, {.sampling = sampling, .cols = 90, .rows = 60});
}

Pose RandomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  return {turn.normalized(), {place(random), place(random), place(random)}};
}

// A plane that the sonar sees whole, from any pose: range, incidence and angles of every ray.
TEST(Trace, TiltedPlaneInClosedForm) {
  std::mt19937 random(3);
  for (const Sampling sampling : {Sampling::kFrustum, Sampling::kBeams}) {
    const SonarModel sonar = TestSonar(0.1, 60.0);
    const RayFan fan = TestFan(sonar, sampling);
    for (int i = 0; i < 5; ++i) {
      const Pose pose = RandomPose(random);
      // In the sonar frame: through (0, 4, 0), with this normal.
      const Eigen::Vector3d normal = Eigen::Vector3d(0.3 * i, -1.0, 0.5 - 0.2 * i).normalized();
      const Eigen::Vector3d u = normal.unitOrthogonal();
      Scene scene;
      AddQuad(scene, pose * Eigen::Vector3d(Eigen::Vector3d(0, 4, 0) - 100.0 * (u + normal.cross(u))),
              pose.rotation * (200.0 * u), pose.rotation * (200.0 * normal.cross(u)), "plane");
      const RayCaster caster(scene);
      const EchoList echoes = Trace(caster, fan, pose, sonar.axes);
      ASSERT_EQ(echoes.size(), static_cast<std::size_t>(fan.size()));
      for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
        ASSERT_EQ(echoes.ray[echo], echo);
        const int row = static_cast<int>(echo) / fan.cols();
        const int col = static_cast<int>(echo) % fan.cols();
        const Eigen::Vector3d direction = fan.Direction(row, col).cast<double>();
        const double cosine = std::abs(direction.dot(normal));
        // Vertices 200 m away in float: 1e-5 m, and so much over the cosine along the ray.
        EXPECT_NEAR(echoes.range_m[echo], 4.0 * std::abs(normal.y()) / cosine, 2e-5 / cosine);
        EXPECT_NEAR(echoes.incidence_rad[echo], std::acos(cosine), 1e-6);
        EXPECT_NEAR(echoes.azimuth_rad[echo], std::atan2(direction.x(), direction.y()), 2e-7);
        EXPECT_NEAR(echoes.elevation_rad[echo], std::asin(direction.z()), 2e-7);
        EXPECT_EQ(echoes.solid_angle_sr[echo], static_cast<float>(fan.SolidAngleSr(row, col)));
        EXPECT_EQ(echoes.Beam(echo), fan.BeamOfColumn(col));
      }
      EXPECT_EQ(echoes.rays_per_beam, fan.rays_per_beam());
    }
  }
}

TEST(Trace, EveryEchoHasTheMaterialThatItsRayMeets) {
  const SonarModel sonar = TestSonar(0.1, 60.0);
  const RayFan fan = TestFan(sonar);
  Scene scene;
  AddQuad(scene, {-50, 4, -50}, {50, 0, 0}, {0, 0, 100}, "left");
  AddQuad(scene, {0, 4, -50}, {50, 0, 0}, {0, 0, 100}, "right");
  const EchoList echoes = Trace(RayCaster(scene), fan, Pose{}, sonar.axes);
  ASSERT_EQ(echoes.size(), static_cast<std::size_t>(fan.size()));
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    EXPECT_EQ(echoes.material_names[echoes.material[echo]], echoes.azimuth_rad[echo] < 0 ? "left" : "right");
  }
}

// What the differences of Eq. 8 say of points known exactly: the angle between a ray and the normal of the
// triangle of its hit and of those `step` columns to the right and rows down.
//
// Points err by about 4 x 2^-24 of range, differences are at least step x 0.0087 rad x range long: the normal
// errs by up to 2 sqrt(2) x 4 x 6e-8 / 0.0087 / step, 1e-4 rad, over the cosine of incidence.
TEST(DepthNormals, EqualGeometricOnAPlane) {
  const SonarModel sonar = TestSonar(0.1, 60.0);
  const RayFan fan = TestFan(sonar);
  std::mt19937 random(5);
  for (const int step : {1, 2, 3}) {
    const Pose pose = RandomPose(random);
    const Eigen::Vector3d normal = Eigen::Vector3d(0.4, -1.0, 0.3).normalized();
    const Eigen::Vector3d u = normal.unitOrthogonal();
    Scene scene;
    AddQuad(scene, pose * Eigen::Vector3d(Eigen::Vector3d(0, 3, 0) - 20.0 * (u + normal.cross(u))),
            pose.rotation * (40.0 * u), pose.rotation * (40.0 * normal.cross(u)), "plane");
    const RayCaster caster(scene);
    const EchoList geometric = Trace(caster, fan, pose, sonar.axes);
    const EchoList depth =
        Trace(caster, fan, pose, sonar.axes, {.normals = NormalSource::kDepth, .step = step});
    ASSERT_EQ(depth.size(), static_cast<std::size_t>(fan.size()));
    for (std::size_t echo = 0; echo < depth.size(); ++echo) {
      ASSERT_NEAR(depth.incidence_rad[echo], geometric.incidence_rad[echo],
                  1e-4 / step / std::cos(geometric.incidence_rad[echo]));
    }
  }
}

// Three points of a sphere span a plane whose normal leans from the sphere's, at each of them, by
// asin(circumradius of the triangle / radius of the sphere), exactly. The mesh adds the sagitta s of its
// facets, twice over the shortest side.
TEST(DepthNormals, LeanByTheCircumradiusOnASphere) {
  const Eigen::Vector3d centre(0.2, 3.0, -0.1);
  const double radius = 0.8;
  const int rings = 240;
  Scene scene;
  AddSphere(scene, centre, radius, rings, "ball");
  const double facet = kPi * radius / rings;
  const double sagitta = 2.0 * facet * facet / (8.0 * radius);  // of a facet's diagonal
  const SonarModel sonar = TestSonar(0.1, 10.0);
  const RayFan fan = TestFan(sonar);
  const auto on_sphere = [&](int row, int col) -> Eigen::Vector3d {
    const Eigen::Vector3d d = fan.Direction(row, col).cast<double>().normalized();
    const double along = d.dot(centre);
    return d * (along - std::sqrt(along * along - centre.squaredNorm() + radius * radius));
  };
  const RayCaster caster(scene);
  for (const int step : {2, 3}) {
    const EchoList echoes =
        Trace(caster, fan, Pose{}, sonar.axes, {.normals = NormalSource::kDepth, .step = step});
    int checked = 0;
    double leaned = 0.0;
    for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
      const int row = static_cast<int>(echoes.ray[echo]) / fan.cols();
      const int col = static_cast<int>(echoes.ray[echo]) % fan.cols();
      const Eigen::Vector3d p = on_sphere(row, col);
      const double incidence = std::acos(std::abs(p.normalized().dot((p - centre) / radius)));
      if (!(incidence < RadFromDeg(55.0)) || row + step >= fan.rows() || col + step >= fan.cols()) continue;
      const Eigen::Vector3d a = on_sphere(row, col + step) - p;
      const Eigen::Vector3d b = on_sphere(row + step, col) - p;
      if (!a.allFinite() || !b.allFinite()) continue;
      const double circumradius = a.norm() * b.norm() * (a - b).norm() / (2.0 * a.cross(b).norm());
      const double lean = std::asin(circumradius / radius);
      const double facets =
          2.0 * std::sqrt(2.0) * sagitta / std::min(a.norm(), b.norm()) / std::cos(incidence);
      ASSERT_NEAR(echoes.incidence_rad[echo], incidence, lean + facets);
      const Eigen::Vector3d normal = a.cross(b).normalized();
      ASSERT_NEAR(echoes.incidence_rad[echo], std::acos(std::abs(p.normalized().dot(normal))), facets);
      leaned = std::max(leaned, std::abs(std::acos(std::abs(p.normalized().dot(normal))) - incidence));
      ++checked;
    }
    EXPECT_GT(checked, 300);
    EXPECT_GT(leaned, RadFromDeg(0.5));  // so the second check tells a step of 2 from one of 3
  }
}

// Two plates that face the sonar, one before the other: all normals are theirs, although differences run
// across the jump. A plate narrower than a step has no partner on either side and takes the mesh's normal.
TEST(DepthNormals, NeverReachAcrossAJump) {
  const SonarModel sonar = TestSonar(0.1, 30.0);
  const RayFan fan = TestFan(sonar);
  Scene scene;
  AddQuad(scene, {-50, 4, -50}, {100, 0, 0}, {0, 0, 100}, "far");
  AddQuad(scene, {-0.2, 2, -0.2}, {0.4, 0, 0}, {0, 0, 0.3}, "near");
  AddQuad(scene, {0.5, 2, -50}, {0.02, 0, 0}, {0, 0, 100}, "strip");
  const RayCaster caster(scene);
  const EchoList echoes =
      Trace(caster, fan, Pose{}, sonar.axes, {.normals = NormalSource::kDepth, .step = 3});
  ASSERT_EQ(echoes.size(), static_cast<std::size_t>(fan.size()));
  std::array<int, 3> seen{};
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const auto direction =
        fan.Direction(static_cast<int>(echo) / fan.cols(), static_cast<int>(echo) % fan.cols());
    EXPECT_NEAR(echoes.incidence_rad[echo], std::acos(double{direction.y()}), 1e-4) << "ray " << echo;
    ++seen[echoes.material[echo]];
  }
  EXPECT_THAT(seen, ::testing::Each(::testing::Gt(20)));
}

// A single plate with nothing behind it: its right and lower rims have no partner there.
TEST(DepthNormals, UseTheOtherSideAtAMiss) {
  const SonarModel sonar = TestSonar(0.1, 30.0);
  const RayFan fan = TestFan(sonar);
  Scene scene;
  AddQuad(scene, {-0.3, 2, -0.3}, {0.6, 0.3, 0}, {0, 0.3, 0.6}, "plate");
  const RayCaster caster(scene);
  const EchoList geometric = Trace(caster, fan, Pose{}, sonar.axes);
  const EchoList depth = Trace(caster, fan, Pose{}, sonar.axes, {.normals = NormalSource::kDepth, .step = 2});
  ASSERT_GT(depth.size(), 300U);
  for (std::size_t echo = 0; echo < depth.size(); ++echo) {
    EXPECT_NEAR(depth.incidence_rad[echo], geometric.incidence_rad[echo], 1e-4);
  }
}

TEST(Trace, KeepsTheRangeWindow) {
  Scene scene;
  AddQuad(scene, {-90, 4, -90}, {180, 0, 0}, {0, 0, 180}, "wall");
  const RayCaster caster(scene);
  const SonarModel sonar = TestSonar(4.1, 4.3);
  const RayFan fan = TestFan(sonar);
  std::vector<std::uint32_t> expected;
  for (int ray = 0; ray < fan.size(); ++ray) {
    const double range_m = 4.0 / fan.Direction(ray / fan.cols(), ray % fan.cols()).y();
    if (range_m >= 4.1 && range_m < 4.3) expected.push_back(static_cast<std::uint32_t>(ray));
  }
  EXPECT_EQ(Trace(caster, fan, Pose{}, sonar.axes).ray, expected);
  ASSERT_GT(expected.size(), 500U);
  ASSERT_LT(expected.size(), static_cast<std::size_t>(fan.size()) - 500U);
}

TEST(Trace, ASurfaceNearerThanTheWindowShadowsAndGivesNoEcho) {
  Scene scene;
  AddQuad(scene, {-90, 4, -90}, {180, 0, 0}, {0, 0, 180}, "wall");
  AddQuad(scene, {0, 0.5, -9}, {9, 0, 0}, {0, 0, 18}, "screen");
  const SonarModel sonar = TestSonar(1.0, 30.0);
  const RayFan fan = TestFan(sonar);
  const EchoList echoes = Trace(RayCaster(scene), fan, Pose{}, sonar.axes);
  EXPECT_EQ(echoes.size(), static_cast<std::size_t>(fan.size()) / 2);  // the left half
  EXPECT_THAT(echoes.azimuth_rad, ::testing::Each(::testing::Lt(0.0F)));
}

// A sonar whose head touches a wall: no echo of range 0, whose loss would be infinite.
TEST(Trace, NoEchoFromRangeZero) {
  Scene scene;
  AddQuad(scene, {-9, 0, -9}, {18, 0, 0}, {0, 0, 18}, "touched");
  AddQuad(scene, {-9, 2, -9}, {18, 0, 0}, {0, 0, 18}, "wall");
  const SonarModel sonar = TestSonar(0.0, 30.0);
  const EchoList echoes = Trace(RayCaster(scene), TestFan(sonar), Pose{}, sonar.axes);
  EXPECT_THAT(echoes.range_m, ::testing::Each(::testing::Gt(0.0F)));
}

TEST(Trace, EmptyViewGivesNoEchoes) {
  Scene scene;
  AddQuad(scene, {-9, -2, -9}, {18, 0, 0}, {0, 0, 18}, "behind");
  const SonarModel sonar = TestSonar(0.1, 30.0);
  EXPECT_EQ(Trace(RayCaster(scene), TestFan(sonar), Pose{}, sonar.axes).size(), 0U);
}

TEST(Trace, SameListOnAnyNumberOfThreads) {
  Scene scene;
  AddBox(scene, {-4, -4, -1}, {4, 6, 2}, "tank");
  AddSphere(scene, {0.5, 3, 0}, 0.5, 40, "ball");
  const RayCaster caster(scene);
  const SonarModel sonar = TestSonar(0.5, 5.0);
  const RayFan fan = TestFan(sonar);
  const auto trace = [&] {
    return Trace(caster, fan, Pose{}, sonar.axes, {.normals = NormalSource::kDepth});
  };
  const EchoList one = WithThreads(1, trace);
  ASSERT_GT(one.size(), 1000U);
  for (const int threads : {2, 4}) {
    const EchoList many = WithThreads(threads, trace);
    EXPECT_EQ(many.ray, one.ray);
    EXPECT_EQ(many.material, one.material);
    EXPECT_EQ(many.range_m, one.range_m);
    EXPECT_EQ(many.azimuth_rad, one.azimuth_rad);
    EXPECT_EQ(many.elevation_rad, one.elevation_rad);
    EXPECT_EQ(many.incidence_rad, one.incidence_rad);
    EXPECT_EQ(many.solid_angle_sr, one.solid_angle_sr);
  }
}

TEST(TraceOptions, OptionsOutsideTheirLimitsAreRefused) {
  EXPECT_THROW((TraceOptions{.step = 0}.Check()), DataError);
  EXPECT_THROW((TraceOptions{.step = 17}.Check()), DataError);
  EXPECT_THROW((TraceOptions{.jump_ratio = 0.0}.Check()), DataError);
  EXPECT_THROW((TraceOptions{.jump_ratio = std::nan("")}.Check()), DataError);
  EXPECT_NO_THROW(TraceOptions{}.Check());
}

}  // namespace
}  // namespace sonarcal::sim
