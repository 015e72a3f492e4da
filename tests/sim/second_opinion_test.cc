// The program against tests/sim/reference_paper_model.h, pixel by pixel, in whole grey levels: the paper's
// tank and its mock-up alone at 1500 x 1200 rays, by either sampling; and smooth bodies as fine meshes.
//
// Cylinders: the tank's meshes are prisms of 16 sides with one normal a facet, so the reference intersects
// those prisms, in closed form. That a fine mesh comes to the round body is the last test's to show.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <string>

#include "core/types/units.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "sim/simulator.h"
#include "tests/sim/reference_paper_model.h"

namespace sonarcal::sim {
namespace {

namespace ref = testing::reference;
using Eigen::Vector3d;

// Table 4; other values for walls and mock-ups, so that one taken for another would show.
const std::map<std::string, ref::Gsab> kMaterials = {{"floor", {90, 4, 100, 1, 90, 8}},
                                                     {"wall", {60, 3, 80, 1.5, 70, 10}},
                                                     {"mockup", {120, 5, 150, 1.2, 60, 7}}};
// The display that `sonarcal scenes` writes: one ray is worth up to 0.4 grey levels.
constexpr DisplayParameters<double> kDisplay = {.db_min = 150.0, .db_max = 153.0};

ref::Settings ReferenceSettings() {
  ref::Settings settings{.temperature_c = 15.0,
                         .salinity_ppt = 0.5,
                         .ph = 7.0,
                         .depth_km = 0.001,
                         .source_level_db = 200.0,
                         .db_min = kDisplay.db_min,
                         .db_max = kDisplay.db_max,
                         .materials = {}};
  for (const char* name : {"floor", "wall", "mockup"}) settings.materials.push_back(kMaterials.at(name));
  return settings;
}

// Table 5: 256 beams 0.18 degrees apart, 20 degrees high, 0.62 to 9 m.
ref::Sonar ReferenceSonar() {
  ref::Sonar sonar{.beam_deg = {},
                   .elevation_deg = 20.0,
                   .range_min_m = 0.62,
                   .range_max_m = 9.0,
                   .bins = 330,
                   .frequency_khz = 900.0};
  for (int beam = 0; beam < 256; ++beam) sonar.beam_deg.push_back(0.18 * beam - 22.95);
  return sonar;
}

ParameterSet ProgramParameters() {
  ParameterSet parameters;
  parameters.display = kDisplay;
  for (const auto& [name, g] : kMaterials) {
    parameters.materials[name].gsab = {
        .a = g.a, .b_deg = g.b_deg, .c = g.c, .d = g.d, .e = g.e, .f_deg = g.f_deg};
  }
  return parameters;
}

struct Case {
  const char* name;
  Sampling sampling;
  ref::Spread spread;
};
constexpr Case kCases[] = {{"Frustum", Sampling::kFrustum, ref::Spread::kFrustum},
                           {"Beams", Sampling::kBeams, ref::Spread::kBeams}};

// What float arithmetic may do to a ray: 2^-24 in each of direction, rotation and edge of a triangle; and to
// where a surface lies: coordinates of up to 12 m in float (4.8e-7 m) as vertices, origin and range.
constexpr double kDoubtRad = 5e-7;
constexpr double kDoubtM = 2.5e-6;

class SecondOpinion : public ::testing::TestWithParam<Case> {
 protected:
  // At most one grey level apart in 99.9 % of pixels. Wherever rounding alone does not explain a difference,
  // rays beside an edge or the border of a bin must account for it, and these are rare.
  static void ExpectAgreement(const Scene& scene, const ref::World& world, const Pose& pose, int least_lit,
                              double doubt_m = kDoubtM, double level_tolerance = 0.02) {
    const SonarPreset& preset = FindSonarPreset("p900-45");
    SimulationOptions options;
    options.fan = {.sampling = GetParam().sampling, .cols = 1500, .rows = 1200};
    options.water = preset.water;
    options.absorption = AbsorptionFormula::kAinslieMcColm;  // the reference's
    const PolarImage image = Simulator(scene, preset.sonar, options).Render(pose, ProgramParameters());

    Eigen::Isometry3d world_from_sonar = Eigen::Isometry3d::Identity();
    world_from_sonar.translate(pose.position_m);
    world_from_sonar.rotate(pose.rotation);
    const ref::Frame frame(world, ReferenceSonar(), ReferenceSettings(), GetParam().spread, 1500, 1200,
                           world_from_sonar);
    ASSERT_EQ(image.value.rows(), frame.bins());
    ASSERT_EQ(image.value.cols(), frame.beams());

    const int pixels = frame.bins() * frame.beams();
    int lit = 0;
    int apart = 0;
    int beyond_rounding = 0;
    int beams_checked = 0;
    int doubtful = 0;
    for (int beam = 0; beam < frame.beams(); ++beam) {
      std::vector<double> doubt;
      for (int bin = 0; bin < frame.bins(); ++bin) {
        const double expected = frame.Grey(bin, beam);
        const double shown = image.value(bin, beam);
        lit += expected > 1.0 && expected < 254.0 ? 1 : 0;
        apart += std::abs(shown - std::round(expected)) > 1.0 ? 1 : 0;
        if (std::abs(shown - expected) <= 0.5 + level_tolerance) continue;
        ++beyond_rounding;
        if (doubt.empty()) {
          doubt = frame.Doubt(beam, kDoubtRad, doubt_m, &doubtful);
          ++beams_checked;
        }
        EXPECT_LE(std::abs(shown - expected), 0.5 + level_tolerance + doubt[bin])
            << "bin " << bin << ", beam " << beam << ": " << shown << " for " << expected
            << ", rays at edges and borders account for " << doubt[bin];
      }
    }
    std::cout << lit << " of " << pixels << " pixels between black and full; " << apart
              << " more than one grey level apart, " << beyond_rounding << " beyond rounding, in "
              << beams_checked << " beams with " << doubtful << " rays at edges and borders\n";
    EXPECT_LE(apart, 0.001 * pixels);
    EXPECT_GE(lit, least_lit);
    // Of a beam's 7000 rays, so that the account above is no blank cheque.
    EXPECT_LE(doubtful, 35 * beams_checked);
  }
};

TEST_P(SecondOpinion, ImageOfThePapersTankEqualsTheReference) {
  const Pose pose = MockupTankPoses(3)[1];
  ExpectAgreement(MakeMockupTank(), ref::PaperTank(), pose, 10'000);
}

// Seen from above, turned and rolled, so that top, two sides and the edges between them show, and rays miss.
TEST_P(SecondOpinion, ImageOfTheMockupEqualsTheReference) {
  const Pose pose{RotationFromYawPitchRoll(RadFromDeg(-32.0), RadFromDeg(-24.0), RadFromDeg(7.0)),
                  {-1.6, -2.4, 2.3}};
  ExpectAgreement(MakeMockup(), ref::Mockup(), pose, 3'000);
}

// A ball, an upright and a lying cylinder and a lying tube over a floor, as meshes whose facets are 0.15 to
// 0.9 degrees wide. Facets lie up to radius x width^2 / 8 within the body, and lean up to half their width.
TEST_P(SecondOpinion, ImageOfRoundBodiesEqualsTheReference) {
  constexpr int kSectors = 2400;
  constexpr int kBallRings = 400;
  const auto along = [](const Vector3d& axis, const Vector3d& base) {
    Eigen::Isometry3d to = Eigen::Isometry3d::Identity();
    to.translate(base);
    to.rotate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), axis));
    return to;
  };
  const auto rod = [&](const Vector3d& base, const Vector3d& axis, double radius) {
    const std::vector<ProfilePoint> profile = {
        {0.0, 0.0}, {0.0, radius}, {axis.norm(), radius}, {axis.norm(), 0.0}};
    return Moved(MakeRevolution(profile, kSectors, false, "mockup"), along(axis, base));
  };
  Scene scene = MakePatch({-4, 0, 0}, {8, 0, 0}, {0, 10, 0}, kUndivided, "floor");
  scene.Append(rod({-0.6, 3.5, 0.0}, {0, 0, 1.6}, 0.15));
  scene.Append(rod({-1.0, 4.6, 0.5}, {1.5, 0.6, 0.3}, 0.2));
  const Vector3d pipe_m(0.9, -0.5, 0.1);
  scene.Append(Moved(MakeRevolution({{0.0, 0.1}, {0.0, 0.18}, {pipe_m.norm(), 0.18}, {pipe_m.norm(), 0.1}},
                                    kSectors, true, "wall"),
                     along(pipe_m, {0.5, 3.4, 0.9})));
  std::vector<ProfilePoint> circle = {{-0.4, 0.0}};
  for (int ring = 1; ring < kBallRings; ++ring) {
    const double angle = kPi * ring / kBallRings;
    circle.push_back({-0.4 * std::cos(angle), 0.4 * std::sin(angle)});
  }
  circle.push_back({0.4, 0.0});
  scene.Append(Moved(MakeRevolution(circle, 2 * kBallRings, false, "wall"),
                     along(Vector3d::UnitX(), {0.6, 5.0, 0.6})));

  ref::World world;
  world.rectangles = {{{-4, 0, 0}, {8, 0, 0}, {0, 10, 0}, ref::kFloor}};
  world.solids = {ref::Cylinder({-0.6, 3.5, 0.0}, {0, 0, 1.6}, 0.15, 0, ref::kMockup),
                  ref::Cylinder({-1.0, 4.6, 0.5}, {1.5, 0.6, 0.3}, 0.2, 0, ref::kMockup),
                  ref::Cylinder({0.5, 3.4, 0.9}, pipe_m, 0.18, 0, ref::kWall, 0.1),
                  ref::Ball({0.6, 5.0, 0.6}, 0.4, ref::kWall)};
  const Pose pose{RotationFromYawPitchRoll(RadFromDeg(4.0), RadFromDeg(-4.0), RadFromDeg(-3.0)),
                  {0.1, 0.0, 1.2}};
  const double facet_rad = kPi / kBallRings;
  const double within_m = 2.0 * 0.4 * facet_rad * facet_rad / 8.0;
  ExpectAgreement(scene, world, pose, 5'000, within_m + kDoubtM, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Sampling, SecondOpinion, ::testing::ValuesIn(kCases),
                         [](const auto& tested) { return std::string(tested.param.name); });

// The reference by itself, against numbers of its own: a ray through a tube's wall, its bore and past it.
TEST(Reference, MeetsATubeByWallBoreAndEnd) {
  ref::World world;
  world.solids = {ref::Cylinder({0, 0, 0}, {0, 0, 2}, 1.0, 0, 0, 0.5)};
  EXPECT_NEAR(world.Meet({-3, 0, 1}, {1, 0, 0}).range_m, 2.0, 1e-12);
  EXPECT_NEAR(world.Meet({0, 0, 1}, {1, 0, 0}).range_m, 0.5, 1e-12);    // from within the bore
  EXPECT_NEAR(world.Meet({0.7, 0, 1}, {1, 0, 0}).range_m, 0.3, 1e-12);  // from within the wall
  EXPECT_NEAR(world.Meet({0.7, 0, 5}, {0, 0, -1}).range_m, 3.0, 1e-12);
  EXPECT_EQ(world.Meet({0.2, 0, 5}, {0, 0, -1}).material, -1);  // through the bore
  // Into the bore's mouth, aslant, and onto its far wall.
  EXPECT_NEAR(world.Meet({-0.5, 0, 3}, Vector3d(1, 0, -2).normalized()).range_m, std::sqrt(5.0), 1e-12);
}

TEST(Reference, CornersOfAPrismLieOnItsRadius) {
  ref::World world;
  world.solids = {ref::Cylinder({0, 0, 0}, {0, 0, 2}, 1.0, 16, 0)};
  EXPECT_NEAR(world.Meet({-3, 0, 1}, {1, 0, 0}).range_m, 2.0, 1e-12);  // a corner
  const double angle = kPi / 16;
  const ref::Hit facet =
      world.Meet({-3 * std::cos(angle), -3 * std::sin(angle), 1}, {std::cos(angle), std::sin(angle), 0});
  EXPECT_NEAR(facet.range_m, 3.0 - std::cos(angle), 1e-12);
  EXPECT_NEAR(std::abs(facet.normal.x()), std::cos(angle), 1e-12);
}

// 900 kHz, 15 C, fresh, pH 7, 1 m: the published value of docs of absorption_test.cc.
TEST(Reference, AbsorptionIsThePublished) {
  ref::Settings water = ReferenceSettings();
  water.salinity_ppt = 0.0;
  EXPECT_NEAR(ref::AbsorptionDbPerM(900.0, water) * 1000.0, 227.709, 1e-3);
  water = {.temperature_c = 10,
           .salinity_ppt = 35,
           .ph = 8,
           .depth_km = 0,
           .source_level_db = 0,
           .db_min = 0,
           .db_max = 1,
           .materials = {}};
  EXPECT_NEAR(ref::AbsorptionDbPerM(100.0, water) * 1000.0, 34.341, 1e-3);
}

}  // namespace
}  // namespace sonarcal::sim
