// What a number of rays does to an image, and what neither sampling may get wrong: stripes, aliasing, edges,
// grazing incidence, what lies behind or around the sonar, and rays that meet nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/paper/paper_frame.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "sim/simulator.h"
#include "tests/sim/meshes.h"
#include "tests/sim/reference_paper_model.h"
#include "tests/sim/slow_paper_model.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim
namespace ref = testing::reference;

const SonarModel& P900() {
  return FindSonarPreset("p900-45").sonar;
}

constexpr double kSampledAlphaDbPerM = 0.22;

// Every material alike, by Table 4, over the display that `sonarcal scenes` writes.
PaperParameters<double> TableFour(std::size_t materials) {
  PaperParameters<double> p;
  p.source_level_db = 200.0;
  p.display = {.db_min = 150.0, .db_max = 153.0};
  p.materials.assign(materials, {});
  return p;
}

// Not rounded.
Grid<float> Render(const Scene& scene, const SonarModel& sonar, const RayFanOptions& fan, const Pose& pose) {
  const RayCaster caster(scene);
  const EchoList echoes = Trace(caster, RayFan(sonar, fan), pose, sonar.axes);
  return RenderPaperImage(echoes, sonar, TableFour(caster.material_names().size()), kSampledAlphaDbPerM)
      .value;
}

Pose LevelAt(double x_m, double y_m, double z_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, y_m, z_m}};
}

class BothWays : public ::testing::TestWithParam<Sampling> {
 protected:
  static RayFanOptions Fan(int cols, int rows) {
    return {.sampling = GetParam(), .cols = cols, .rows = rows};
  }
};

// --- Stripes

// A level floor under a level sonar: rows land R^2 / h d(elevation) apart. Whatever their number, a bin holds
// the rows of a stretch of elevation, so each column errs by less than one row: a pixel by less than
// I s / rows, the stated bound. Where rows lie more than a bin apart, some bins get none: stripes. That is
// beyond sqrt(bin h / d(elevation)): 3.3 m for 200 rows of 20 degrees from 0.75 m up, where the floor comes
// into view at 4.3 m; 8.1 m for 1200.
class Stripes : public BothWays {
 protected:
  static constexpr double kHeightM = 0.75;

  static Grid<float> Floor(int rows) {
    Scene scene;
    AddQuad(scene, {-20, -1, 0}, {40, 0, 0}, {0, 25, 0}, "floor");
    return Render(scene, P900(), Fan(256, rows), LevelAt(0, 0, kHeightM));
  }

  // Greatest level of one ray at a range, in units of full scale.
  static double LevelOfARay(double range_m) {
    return SlowNormalisedEcho(TableFour(1), 0, range_m, std::acos(kHeightM / range_m), kSampledAlphaDbPerM);
  }

  // Dark bins between lit ones along the middle beam, from 4.5 m on, where the floor is in view.
  static int DarkBins(const Grid<float>& image) {
    int dark = 0;
    for (int bin = 155; bin < 330; ++bin) dark += image(bin, 128) == 0.0F ? 1 : 0;
    return dark;
  }
};

TEST_P(Stripes, StayBelowOneRowOfRays) {
  constexpr int kDense = 25'600;
  const Grid<float> dense = Floor(kDense);
  for (const int rows : {200, 400, 1200, 3200}) {
    const Grid<float> image = Floor(rows);
    double worst = 0.0;
    for (int bin = 155; bin < 330; ++bin) {
      // Nearer is louder; the beams' first column at an edge of the fan looks as far as any.
      const double bound = 255.0 * LevelOfARay(P900().axes.range_min_m + bin * P900().axes.range_bin_m()) *
                           (1.0 / rows + 1.0 / kDense);
      for (int beam = 0; beam < 256; ++beam) {
        const double error = std::abs(image(bin, beam) - dense(bin, beam));
        ASSERT_LE(error, bound) << rows << " rows, bin " << bin << ", beam " << beam;
        worst = std::max(worst, error / bound);
      }
    }
    EXPECT_GT(worst, 0.5) << rows << " rows: the bound is far from reached";
  }
}

// Where rows lie more than a bin apart, as many bins stay dark as rows are too few. A bin of 2.54 cm at 9 m,
// the end of the window, is 2.36e-4 rad of elevation: 1480 rows of 20 degrees leave none.
TEST_P(Stripes, NeedARowABin) {
  const double end_m = P900().axes.range_max_m;
  const double bin_m = P900().axes.range_bin_m();
  for (const int rows : {200, 400, 1200, 1500}) {
    const double row_rad = RadFromDeg(20.0) / rows;
    const double from_m = std::max(4.55, std::sqrt(bin_m * kHeightM / row_rad));
    const double rows_there = (std::asin(kHeightM / from_m) - std::asin(kHeightM / end_m)) / row_rad;
    const double lacking = std::max(0.0, (end_m - from_m) / bin_m - rows_there);
    EXPECT_NEAR(DarkBins(Floor(rows)), std::floor(lacking), rows == 1500 ? 0.0 : 3.0) << rows << " rows";
  }
}

INSTANTIATE_TEST_SUITE_P(Sampling, Stripes, ::testing::Values(Sampling::kFrustum, Sampling::kBeams),
                         [](const auto& tested) {
                           return tested.param == Sampling::kFrustum ? "Frustum" : "Beams";
                         });

// --- Edges and aliasing, with all of a plate in one bin: a pixel is the share of its rays that meet it

SonarModel OneBin() {
  return MakeSonar(EvenAzimuthsDeg(20, 1.0), 20.0, 2.0, 12.0, 1);
}

// Of full scale, for a level of one ray that does not depend on where the plate is met.
Grid<float> Coverage(const Scene& scene, const RayFanOptions& fan) {
  const SonarModel sonar = OneBin();
  const EchoList echoes = Trace(RayCaster(scene), RayFan(sonar, fan), Pose{}, sonar.axes);
  PaperParameters<double> p;
  p.source_level_db = 500.0;
  p.display = {.db_min = 500.0 - 1e6, .db_max = 500.0};  // s = 1 to within 1e-4
  p.materials.assign(1, {});
  return RenderPaperImage(echoes, sonar, p, 0.0, {.full_scale = 1.0, .noise_seed = {}}).value;
}

// A plate across half the view, its edge 0.37 of the way through beam 10: no more than half a column is
// counted wrongly, whatever the columns; likewise for its upper edge and rows.
TEST_P(BothWays, AnEdgeCostsAtMostHalfACell) {
  const double edge_rad = RadFromDeg(0.37);  // beam 10 begins at 0
  const double above_rad = RadFromDeg(2.71);
  Scene upright;
  AddQuad(upright, {-30, 5, -30}, {30 + 5 * std::tan(edge_rad), 0, 0}, {0, 0, 60}, "plate");
  Scene level;
  AddQuad(level, {-30, 5, -30}, {60, 0, 0}, {0, 0, 30 + 5 * std::tan(above_rad)}, "plate");
  for (const int each : {1, 2, 3, 4, 8, 16, 64}) {
    const Grid<float> image = Coverage(upright, Fan(20 * each, 10));
    // A pinhole's columns are not quite even in angle, and begin anywhere in a beam.
    const double half_cell = GetParam() == Sampling::kBeams ? 0.5 / each : 1.05 / each;
    EXPECT_NEAR(image(0, 10), 0.37, half_cell + 2e-4) << each << " columns a beam";
    EXPECT_NEAR(image(0, 9), 1.0, 2e-4);
    EXPECT_EQ(image(0, 11), 0.0F);
  }
  for (const int rows : {1, 5, 20, 200, 1200}) {
    const Grid<float> image = Coverage(level, Fan(20, rows));
    const double share = GetParam() == Sampling::kBeams
                             ? (10.0 + 2.71) / 20.0
                             : 0.5 + 0.5 * std::tan(above_rad) / std::tan(RadFromDeg(10.0));
    // At azimuth 0.5 degrees the level edge of a plate looks lower by its cosine: 4e-5.
    EXPECT_NEAR(image(0, 10), share, 0.5 / rows + 3e-4) << rows << " rows";
  }
}

// Staggered rows: the same upright edge in one column a beam, whose rays stand at golden sections of its
// width. Of n of those the share left of any point is wrong by less than (0.5 + log2(n)) / n, a bound that
// holds with room to spare; columns that stand alike show all or nothing.
TEST(Staggered, AnEdgeCostsAFewRaysInstead) {
  for (const double at_deg : {0.13, 0.37, 0.5, 0.81}) {
    Scene upright;
    AddQuad(upright, {-30, 5, -30}, {30 + 5 * std::tan(RadFromDeg(at_deg)), 0, 0}, {0, 0, 60}, "plate");
    for (const int rows : {10, 100, 300}) {
      RayFanOptions fan{.sampling = Sampling::kBeams, .cols = 20, .rows = rows, .stagger = true};
      const Grid<float> image = Coverage(upright, fan);
      EXPECT_NEAR(image(0, 10), at_deg, (0.5 + std::log2(rows)) / rows) << rows << " rows";
      EXPECT_NEAR(image(0, 9), 1.0, 2e-4);
      EXPECT_EQ(image(0, 11), 0.0F);
      fan.stagger = false;
      EXPECT_NEAR(Coverage(upright, fan)(0, 10), at_deg < 0.5 ? 0.0 : 1.0, at_deg == 0.5 ? 1.0 : 2e-4);
    }
  }
}

// Slats and gaps of equal width, 1.1 columns apart: with one column a beam the image beats between none and
// all of the slats; with many columns each beam shows the half it sees. Each beam holds at most two edges a
// period, each of which costs half a column.
TEST_P(BothWays, ColumnsCoarserThanTheSceneAliasAndTheErrorFallsWithThem) {
  constexpr double kPeriodDeg = 1.1;
  Scene slats;
  for (int i = -12; i < 12; ++i) {
    const double left_m = 5.0 * std::tan(RadFromDeg(i * kPeriodDeg));
    const double right_m = 5.0 * std::tan(RadFromDeg((i + 0.5) * kPeriodDeg));
    AddQuad(slats, {left_m, 5, -30}, {right_m - left_m, 0, 0}, {0, 0, 60}, "slat");
  }
  const auto worst = [&](int each) {
    const Grid<float> image = Coverage(slats, Fan(20 * each, 4));
    double error = 0.0;
    for (int beam = 0; beam < 20; ++beam) {
      double covered = 0.0;
      for (int i = -12; i < 12; ++i) {
        const double low = std::max(beam - 10.0, i * kPeriodDeg);
        const double high = std::min(beam - 9.0, (i + 0.5) * kPeriodDeg);
        covered += std::max(0.0, high - low);
      }
      error = std::max(error, std::abs(image(0, beam) - covered));
    }
    return error;
  };
  EXPECT_GT(worst(1), 0.4);  // aliased
  const double edges = 2.0;
  const double half_cell = GetParam() == Sampling::kBeams ? 0.5 : 1.05;
  for (const int each : {4, 16, 64, 256}) EXPECT_LE(worst(each), edges * half_cell / each + 2e-4) << each;
}

// --- Where the sonar is

TEST_P(BothWays, ObjectsBehindTheSonarAreNotSeen) {
  const Pose pose = MockupTankPoses(1)[0];
  const Scene tank = MakeMockupTank();
  Scene more = tank;
  more.Append(Moved(MakeMockup({}), WorldFromObject({pose.position_m.x(), pose.position_m.y() - 1.2, 0.3})));
  const RayFanOptions fan = Fan(512, 200);
  EXPECT_EQ(Render(more, P900(), fan, pose), Render(tank, P900(), fan, pose));
  // And in front of it, it is.
  more = tank;
  more.Append(Moved(MakeMockup({}), WorldFromObject({pose.position_m.x(), pose.position_m.y() + 1.2, 0.3})));
  EXPECT_NE(Render(more, P900(), fan, pose), Render(tank, P900(), fan, pose));
}

constexpr double kInsideDoubtM = 2e-6;

// Against the closed form, with what rays at edges and borders of bins may do.
void ExpectReference(const Grid<float>& image, const ref::World& world, Sampling sampling, int cols, int rows,
                     const Pose& pose) {
  ref::Sonar sonar{.beam_deg = EvenAzimuthsDeg(256, 0.18),
                   .elevation_deg = 20.0,
                   .range_min_m = 0.62,
                   .range_max_m = 9.0,
                   .bins = 330,
                   .frequency_khz = 900.0};
  const ref::Settings settings{.temperature_c = 15.0,
                               .salinity_ppt = 0.5,
                               .ph = 7.0,
                               .depth_km = 0.001,
                               .source_level_db = 200.0,
                               .db_min = 150.0,
                               .db_max = 153.0,
                               .materials = {{90, 4, 100, 1, 90, 8}}};
  Eigen::Isometry3d world_from_sonar = Eigen::Isometry3d::Identity();
  world_from_sonar.translate(pose.position_m);
  world_from_sonar.rotate(pose.rotation);
  const ref::Frame frame(world, sonar, settings,
                         sampling == Sampling::kBeams ? ref::Spread::kBeams : ref::Spread::kFrustum, cols,
                         rows, world_from_sonar);
  int lit = 0;
  int beyond = 0;
  for (int beam = 0; beam < 256; ++beam) {
    std::vector<double> doubt;
    for (int bin = 0; bin < 330; ++bin) {
      const double expected = frame.Grey(bin, beam);
      lit += expected > 0.0 ? 1 : 0;
      if (std::abs(image(bin, beam) - expected) <= 0.02) continue;
      ++beyond;
      int doubtful = 0;
      if (doubt.empty()) doubt = frame.Doubt(beam, 5e-7, kInsideDoubtM, &doubtful);
      EXPECT_LE(std::abs(image(bin, beam) - expected), 0.02 + doubt[bin])
          << "bin " << bin << ", beam " << beam;
    }
  }
  EXPECT_GT(lit, 500);
  EXPECT_LT(beyond, 85);  // 0.1 %
}

Grid<float> RenderFresh(const Scene& scene, const RayFanOptions& fan, const Pose& pose) {
  SimulationOptions options;
  options.fan = fan;
  options.water = FindSonarPreset("p900-45").water;
  options.absorption = AbsorptionFormula::kAinslieMcColm;  // the reference's
  const Simulator simulator(scene, P900(), options);
  return RenderPaperImage(simulator.TraceEchoes(pose), P900(), TableFour(1), simulator.absorption_db_per_m())
      .value;
}

// Within a closed box, whose triangles all face away: every ray meets a wall from behind, at the right angle.
TEST_P(BothWays, ASonarInsideAMeshSeesItsInside) {
  const Pose pose{RotationFromYawPitchRoll(0.3, -0.2, 0.1), {0.2, -0.1, 0.4}};
  const Scene room = MakeBox({-2, -3, -1}, {3, 4, 2}, kUndivided, "room");
  ref::World world;
  world.solids = {ref::Box({-2, -3, -1}, {3, 4, 2}, 0)};
  ExpectReference(RenderFresh(room, Fan(512, 150), pose), world, GetParam(), 512, 150, pose);
}

// 3 cm above a floor that runs to the horizon: incidences from 80 to 89.8 degrees, where the level falls off
// ever faster; finite, within the display, and the closed form's.
TEST_P(BothWays, GrazingIncidenceStaysFiniteAndEqualsTheReference) {
  const Pose pose = LevelAt(0.0, 0.0, 0.03);
  const Scene floor = MakePatch({-50, -5, 0}, {100, 0, 0}, {0, 100, 0}, kUndivided, "floor");
  ref::World world;
  world.rectangles = {{{-50, -5, 0}, {100, 0, 0}, {0, 100, 0}, 0}};
  const Grid<float> image = RenderFresh(floor, Fan(512, 4000), pose);
  EXPECT_THAT(image.values(), ::testing::Each(::testing::AllOf(::testing::Ge(0.0F), ::testing::Le(255.0F))));
  ExpectReference(image, world, GetParam(), 512, 4000, pose);
}

// --- Rays that meet nothing

TEST_P(BothWays, AnEmptyViewIsBlack) {
  const Scene scene = MakeMockup({});
  SimulationOptions options;
  options.fan = Fan(512, 100);
  ParameterSet parameters;
  parameters.display = {.db_min = 150.0, .db_max = 153.0};
  parameters.materials["default"];
  parameters.jitter.sigma_range_m = 0.02;
  parameters.jitter.sigma_azimuth_deg = 0.5;
  const Pose away = LevelAt(0.0, 3.0, 0.75);  // the mock-up is behind
  for (const bool noise : {false, true}) {
    options.noise = noise;
    const Simulator simulator(scene, P900(), options);
    EXPECT_THAT(simulator.Render(away, parameters).value.values(), ::testing::Each(0.0F));
    EXPECT_THAT(simulator.RenderExpected(simulator.TraceEchoes(away), parameters).value.values(),
                ::testing::Each(0.0F));
  }
}

// A plate before the left half of the fan: those beams show what they would of a whole plate, the others
// nothing. A ray that meets nothing still counts as one of its beam's: the plate's lower half gives half.
TEST_P(BothWays, RaysThatMissTakeNothingFromTheOthers) {
  Scene whole;
  AddQuad(whole, {-30, 5, -30}, {60, 0, 0}, {0, 0, 60}, "plate");
  Scene left;
  AddQuad(left, {-30, 5, -30}, {30, 0, 0}, {0, 0, 60}, "plate");
  const RayFanOptions fan = Fan(512, 100);
  const Grid<float> of_whole = Render(whole, P900(), fan, Pose{});
  const Grid<float> of_left = Render(left, P900(), fan, Pose{});
  for (int bin = 0; bin < 330; ++bin) {
    for (int beam = 0; beam < 256; ++beam)
      EXPECT_EQ(of_left(bin, beam), beam < 128 ? of_whole(bin, beam) : 0.0F) << bin << ", " << beam;
  }
  Scene lower;
  AddQuad(lower, {-30, 5, -30}, {60, 0, 0}, {0, 0, 30}, "plate");
  const Grid<float> half = Coverage(lower, Fan(20, 100));
  for (int beam = 0; beam < 20; ++beam) EXPECT_NEAR(half(0, beam), 0.5, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Sampling, BothWays, ::testing::Values(Sampling::kFrustum, Sampling::kBeams),
                         [](const auto& tested) {
                           return tested.param == Sampling::kFrustum ? "Frustum" : "Beams";
                         });

// --- Two samplings, one truth

// Rays of a pinhole stand for unequal angles: at azimuth a and elevation e its rows are
// cos(a) cos(e)^2 tan(E) / E of an even row high, E half the field of view; and they end at
// atan(tan(E) cos(a)), short of E. Weighed by their solid angle, both samplings must come to one image.
class TwoSamplings : public ::testing::TestWithParam<bool> {
 protected:
  TwoSamplings()
      : caster_(GetParam() ? MakeMockupTank() : MakeMockup({})),
        pose_(GetParam() ? MockupTankPoses(3)[1]
                         : Pose{RotationFromYawPitchRoll(-0.55, -0.42, 0.1), {-1.6, -2.4, 2.3}}) {}

  Grid<float> Image(Sampling sampling, RayWeight weight, int cols, int rows) const {
    const RayFan fan(P900(), {.sampling = sampling, .cols = cols, .rows = rows, .weight = weight});
    return RenderPaperFrame(caster_, fan, pose_, P900(), TableFour(caster_.material_names().size()),
                            kSampledAlphaDbPerM)
        .value;
  }

  // Percentiles of the difference over all pixels, in grey levels of the 3 dB display.
  struct Difference {
    double p99 = 0.0;
    double p999 = 0.0;
  };
  Difference Between(RayWeight weight, int cols, int rows) const {
    const Grid<float> frustum = Image(Sampling::kFrustum, weight, cols, rows);
    const Grid<float> beams = Image(Sampling::kBeams, weight, cols, rows);
    std::vector<double> differences;
    for (std::size_t i = 0; i < frustum.size(); ++i)
      differences.push_back(std::abs(double{frustum.values()[i]} - double{beams.values()[i]}));
    std::sort(differences.begin(), differences.end());
    const auto at = [&](double share) {
      return differences[static_cast<std::size_t>(share * static_cast<double>(differences.size()))];
    };
    return {at(0.99), at(0.999)};
  }

  RayCaster caster_;
  Pose pose_;
};

// By 9.2 million rays, five times the paper's, measured: 0.81 and 2.72 grey levels in the tank, 0.64 and 2.51
// at the mock-up; by four times as many 0.43 and 1.64, 0.45 and 1.69. What is left falls with the rays: walls
// that a row meets all at one range, at the border of a bin.
TEST_P(TwoSamplings, ComeToOneImageBySolidAngle) {
  const Difference some = Between(RayWeight::kSolidAngle, 256 * 12, 3000);
  EXPECT_LE(some.p99, 1.0);
  EXPECT_LE(some.p999, 2.8);
  const Difference more = Between(RayWeight::kSolidAngle, 256 * 24, 6000);
  EXPECT_LE(more.p99, 0.5);
  EXPECT_LE(more.p999, 1.8);
}

// What the paper's even weights cost: the pinhole's rows crowd by up to a tenth and stop 0.75 degrees short
// in the outer beams. Measured: 7.8 and 8.9 grey levels in the tank, 2.1 and 8.8 at the mock-up.
TEST_P(TwoSamplings, StayApartAsThePaperWeighsThem) {
  const Difference even = Between(RayWeight::kEven, 256 * 12, 3000);
  EXPECT_GT(even.p99, 2.0);
  EXPECT_GT(even.p999, 8.0);
  EXPECT_LT(even.p999, 9.5);
}

INSTANTIATE_TEST_SUITE_P(Scene, TwoSamplings, ::testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Tank" : "Mockup"; });

}  // namespace
}  // namespace sonarcal::sim
