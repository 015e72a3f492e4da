// Ghosts as a Simulator has them: with the rays of its own, in the images, and none without a mirror.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/acoustic/acoustic_frame.h"
#include "sim/scenes/scenes.h"
#include "sim/simulator.h"
#include "tests/sim/ghost_world.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

TEST(Ghosts, LevelDoesNotDependOnTheNumberOfRays) {
  const GhostAcoustics acoustics;
  const Pose pose{RotationFromYawPitchRoll(0.3, -0.1, 0.1), {6.0, 4.0, 0.8}};
  Scene tank = MakeTank({.surface = true});
  tank.material_names = {"default", "mirror", "surface"};
  GhostAcoustics six = acoustics;
  six.parameters.mirrors = {{"default", {10.0}}, {"mirror", {6.0}}, {"surface", {0.7}}};
  six.parameters.materials["mirror"] = six.parameters.materials["default"];
  const auto total = [&](int cols, int rows) {
    const Grid<float> power = six.Power(six.Trace(tank, pose, six.Fan(cols, rows)));
    double sum = 0.0;
    for (const float value : power.values()) sum += value;
    return sum;
  };
  const double few = total(kGhostBeams, 400);
  const double many = total(3 * kGhostBeams, 1600);
  EXPECT_GT(many, 0.0);
  EXPECT_NEAR(few / many, 1.0, 0.01);
}

TEST(Ghosts, SameOnAnyNumberOfThreads) {
  const GhostAcoustics acoustics;
  Scene scene;
  AddQuad(scene, {0.5, 0.5, -3}, {0, 6, 0}, {0, 0, 6}, "mirror");
  AddQuad(scene, {-0.1, 3.5, -0.15}, {0.25, 0, 0}, {0, 0, 0.4}, "plate");
  const auto power = [&](int threads) {
    return WithThreads(threads, [&] {
      return acoustics.Power(acoustics.Trace(scene, Pose{}, acoustics.Fan(kGhostBeams, 200)));
    });
  };
  EXPECT_EQ(power(1), power(2));
  EXPECT_EQ(power(1), power(4));
}

class TankWithMirrors : public ::testing::Test {
 protected:
  static SimulationOptions Options() {
    SimulationOptions options;
    options.fan = {
        .sampling = Sampling::kBeams, .cols = 2 * kGhostBeams, .rows = 300, .elevation_span_deg = 60.0};
    options.noise = true;
    return options;
  }

  Simulator simulator_{MakeTank({.surface = true}), GhostSonar(), Options()};
  Pose pose_{RotationFromYawPitchRoll(0.3, -0.1, 0.0), {6.0, 4.0, 0.8}};
  ParameterSet parameters_ = GhostParameters();
};

// Without a mirror in the scene: not a ray more, not a bit changed.
TEST_F(TankWithMirrors, NoMirrorNoGhosts) {
  parameters_.display = {.db_min = 60.0, .db_max = 160.0};
  ParameterSet none = parameters_;
  none.mirrors.clear();
  const std::int64_t before = simulator_.caster().rays_cast();
  const Grid<float> without = simulator_.Render(pose_, none).value;
  EXPECT_EQ(simulator_.caster().rays_cast() - before, simulator_.fan().size());
  EXPECT_EQ(simulator_.Render(pose_, parameters_).value, without) << "'mirror' is no material of the tank";
  EXPECT_EQ(simulator_.caster().rays_cast() - before, 2 * simulator_.fan().size());
  EXPECT_TRUE(simulator_.TraceGhosts(pose_, parameters_).echoes.empty());
  const EchoList echoes = simulator_.TraceEchoes(pose_);
  EXPECT_EQ(simulator_.RenderEchoes(echoes, parameters_).value, simulator_.RenderEchoes(echoes, none).value);
  // A list of echoes gives the powers of the one pass in Render only to single precision
  // (sim/acoustic/acoustic_frame.h). So powers are compared, within the bound of the tests of that file.
  // Grey levels would round them.
  const AcousticGeometry geometry{simulator_.sonar(), simulator_.absorption_db_per_m()};
  const Grid<double> of_echoes = ThroughPulse(simulator_.Scatter(echoes, none), geometry, none);
  const ExpectedFrames frames(simulator_.caster(), simulator_.fan(), geometry, none,
                              simulator_.options().trace);
  const Grid<float> in_one_pass = frames.Pulsed(pose_).power;
  const double largest = *std::max_element(of_echoes.values().begin(), of_echoes.values().end());
  ASSERT_GT(largest, 0.0);
  for (std::size_t i = 0; i < of_echoes.size(); ++i)
    EXPECT_NEAR(in_one_pass.values()[i], of_echoes.values()[i], 1e-3 * of_echoes.values()[i] + 1e-9 * largest)
        << i;
}

// Expected and sampled images show the ghosts; a mirror that loses everything is none.
TEST_F(TankWithMirrors, GhostsBrightenTheExpectedImageAndNeverDarkenIt) {
  parameters_.display = {.db_min = 60.0, .db_max = 160.0};
  const EchoList echoes = simulator_.TraceEchoes(pose_);
  const Grid<float> without = simulator_.RenderExpected(echoes, parameters_).value;
  for (const char* name : {"floor", "wall", "surface"}) parameters_.mirrors[name].loss_db = 1.0;
  const GhostList ghosts = simulator_.TraceGhosts(pose_, parameters_);
  const Grid<float> with = simulator_.RenderExpected(echoes, parameters_, ghosts).value;
  int brighter = 0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_GE(with.values()[i], without.values()[i] - 1e-3F);
    brighter += with.values()[i] > without.values()[i] + 2.0F ? 1 : 0;
  }
  EXPECT_GT(brighter, 200);
  // As above, powers are equal to single precision, so a grey level may be rounded to its neighbour.
  const Grid<float> in_one_pass = simulator_.Render(pose_, parameters_).value;
  const Grid<float> of_echoes = simulator_.RenderEchoes(echoes, parameters_, 0, ghosts).value;
  std::size_t rounded = 0;
  for (std::size_t i = 0; i < of_echoes.size(); ++i) {
    EXPECT_NEAR(in_one_pass.values()[i], of_echoes.values()[i], 1.0F) << i;
    rounded += in_one_pass.values()[i] == of_echoes.values()[i] ? 0 : 1;
  }
  EXPECT_LT(rounded, of_echoes.size() / 100);
  for (auto& [name, mirror] : parameters_.mirrors) mirror.loss_db = 200.0;
  const Grid<float> lost = simulator_.RenderExpected(echoes, parameters_, ghosts).value;
  for (std::size_t i = 0; i < lost.size(); ++i) EXPECT_NEAR(lost.values()[i], without.values()[i], 1e-3);
}

// The list has echoes of both orders and of both kinds. The curve has all of its terms.
TEST_F(TankWithMirrors, PowersOfManyEchoesAreThoseOfEach) {
  for (auto& [name, material] : parameters_.materials)
    material.gsab = {.a = 4.0, .b_deg = 3.0, .c = 0.2, .d = 1.7, .e = 0.9, .f_deg = 25.0};
  for (const char* name : {"floor", "wall", "surface"}) parameters_.mirrors[name].loss_db = 1.5;
  SimulationOptions options = Options();
  options.ghost_order = 2;
  SonarModel far_seeing = GhostSonar();
  far_seeing.axes.range_max_m = 25.0;
  const Simulator simulator(MakeTank({.surface = true}), far_seeing, options);
  const GhostList ghosts = simulator.TraceGhosts(pose_, parameters_);
  const GhostPower power(ghosts.material_names, {simulator.sonar(), simulator.absorption_db_per_m()},
                         parameters_);
  const std::vector<double> powers = power.OneWays(ghosts.echoes);
  ASSERT_EQ(powers.size(), ghosts.echoes.size());
  ASSERT_GT(powers.size(), 2'000U);
  double largest = 0.0;
  int second_order = 0;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const double exact = power.OneWay(ghosts.echoes[i]);
    largest = std::max(largest, exact);
    const GhostEcho& echo = ghosts.echoes[i];
    second_order += echo.leg.mirror[1] != kNoMirror || (echo.both_ways && !echo.other.straight()) ? 1 : 0;
    ASSERT_NEAR(powers[i], exact, 2e-5 * exact) << i;
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_GT(second_order, 100);
}

// What is sent at 30 degrees is outside of beams that end at 25.6, and comes back into them by a wall.
TEST(Ghosts, EnergySentAsideReturnsByTheMirror) {
  Scene scene;
  AddQuad(scene, {1.0, 0.5, -1}, {0, 6, 0}, {0, 0, 2}, "mirror");
  AddQuad(scene, {-0.1, 3.4, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, "plate");
  SimulationOptions options;
  options.fan = {
      .sampling = Sampling::kBeams, .cols = 2 * kGhostBeams, .rows = 400, .elevation_span_deg = 60.0};
  const Simulator simulator(scene, GhostSonar(), options);
  ParameterSet parameters = GhostParameters();
  const auto plates = [&] {
    const GhostList list = simulator.TraceGhosts(Pose{}, parameters);
    return std::count_if(list.echoes.begin(), list.echoes.end(), [&](const GhostEcho& echo) {
      return list.material_names[echo.material] == "plate";
    });
  };
  EXPECT_EQ(plates(), 0);
  parameters.beam.transmit_even_deg = 26.0;
  parameters.beam.transmit_end_deg = 40.0;
  EXPECT_GT(plates(), 20);
  const GhostPower power(simulator.caster().material_names(), {simulator.sonar(), kAlphaDbPerM}, parameters);
  for (const GhostEcho& echo : simulator.TraceGhosts(Pose{}, parameters).echoes) {
    if (!echo.both_ways) continue;
    EXPECT_NEAR(echo.leg.azimuth_rad, std::atan2(2.0, 3.4), 0.03);
    // Heard from where the plate is, after it was sent where the cosine has fallen.
    const double fallen = std::cos(0.5 * kPi * (echo.leg.azimuth_rad * 180.0 / kPi - 26.0) / 14.0);
    double straight_ahead = 0.0;
    power.ForEachArrival(echo, [&](const GhostArrival& arrival) {
      if (arrival.azimuth_rad == double{echo.other.azimuth_rad}) straight_ahead = arrival.power;
    });
    EXPECT_NEAR(straight_ahead / power.OneWay(echo), fallen * fallen, 1e-6);
  }
}

}  // namespace
}  // namespace sonarcal::sim
