#include "sim/ghosts/ghost_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "tests/sim/ghost_world.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

// What a mirrored echo of a small plate needs, one thing taken away after the other.
class OnePlate : public ::testing::Test {
 protected:
  // A mirror at the right from y = `from` on; a plate 3.5 m ahead. The way by the mirror meets it at y
  // = 1.75.
  static Scene Make(double mirror_from_m, double mirror_to_m) {
    Scene scene;
    AddQuad(scene, {0.5, mirror_from_m, -1}, {0, mirror_to_m - mirror_from_m, 0}, {0, 0, 2}, "mirror");
    AddQuad(scene, {-0.05, 3.5, -0.05}, {0.1, 0, 0}, {0, 0, 0.1}, "plate");
    return scene;
  }

  // How many echoes of the plate go by one leg, and how many by two.
  std::pair<int, int> Counts(const Scene& scene) const {
    const GhostList ghosts = acoustics_.Trace(scene, Pose{}, acoustics_.Fan(3 * kGhostBeams, 600));
    std::pair<int, int> counts{0, 0};
    for (const GhostEcho& echo : ghosts.echoes) {
      if (ghosts.material_names[echo.material] == "plate") ++(echo.both_ways ? counts.second : counts.first);
    }
    return counts;
  }

  GhostAcoustics acoustics_;
};

TEST_F(OnePlate, IsSeenBothWaysAndAtTheRightPlace) {
  const auto [single, both] = Counts(Make(0.5, 3.4));
  EXPECT_GT(single, 50);
  EXPECT_EQ(single, both);
  const GhostList ghosts = acoustics_.Trace(Make(0.5, 3.4), Pose{}, acoustics_.Fan(3 * kGhostBeams, 600));
  for (const GhostEcho& echo : ghosts.echoes) {
    if (ghosts.material_names[echo.material] != "plate") continue;
    EXPECT_EQ(ghosts.material_names[echo.leg.mirror[0]], "mirror");
    EXPECT_EQ(echo.leg.mirror[1], kNoMirror);
    // In the mirror the plate stands at x = 1, 0.05 to either side.
    EXPECT_NEAR(echo.leg.azimuth_rad, std::atan2(1.0, 3.5), 0.016);
    EXPECT_NEAR(echo.leg.length_m, std::hypot(1.0, 3.5), 0.02);
    EXPECT_EQ(echo.leg.spreading_m, echo.leg.length_m);
    if (!echo.both_ways) continue;
    EXPECT_TRUE(echo.other.straight());
    EXPECT_NEAR(echo.other.length_m, 3.5, 0.002);
    EXPECT_NEAR(echo.range_m(), 0.5 * (3.5 + std::hypot(1.0, 3.5)), 0.01);
    // The point that the mirrored leg ends at is the one that the straight leg leaves.
    EXPECT_NEAR(3.5 * std::tan(echo.leg.azimuth_rad), 1.0 - 3.5 * std::tan(echo.other.azimuth_rad), 1e-3);
  }
}

TEST_F(OnePlate, AMirrorEndsWhereItsSurfaceDoes) {
  EXPECT_EQ(Counts(Make(0.5, 1.6)), std::make_pair(0, 0));
  EXPECT_EQ(Counts(Make(1.9, 3.4)), std::make_pair(0, 0));
}

TEST_F(OnePlate, AScreenOnEitherLegRemovesItsEchoes) {
  const auto [single, both] = Counts(Make(0.5, 3.4));
  Scene straight_blocked = Make(0.5, 3.4);
  AddQuad(straight_blocked, {-0.1, 2.5, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, "screen");
  EXPECT_EQ(Counts(straight_blocked), std::make_pair(single, 0));
  Scene before_mirror = Make(0.5, 3.4);
  AddQuad(before_mirror, {0.2, 1.0, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, "screen");
  EXPECT_EQ(Counts(before_mirror), std::make_pair(0, 0));
  Scene behind_mirror = Make(0.5, 3.4);
  AddQuad(behind_mirror, {0.12, 2.8, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, "screen");
  EXPECT_EQ(Counts(behind_mirror), std::make_pair(0, 0));
}

// The back of a plate, seen in a mirror behind it, is not what the sonar sees straight.
TEST_F(OnePlate, BothLegsAreOnOneSide) {
  Scene scene;
  AddQuad(scene, {-3, 4.2, -1}, {6, 0, 0}, {0, 0, 2}, "mirror");
  AddQuad(scene, {0.4, 3.5, -0.05}, {0.1, 0, 0}, {0, 0, 0.1}, "plate");
  const auto [single, both] = Counts(scene);
  EXPECT_GT(single, 20);
  EXPECT_EQ(both, 0);
}

// Between a floor and a surface: legs by both, as long as to the image of the image.
TEST(Ghosts, SecondOrderReachesTheImageOfTheImage) {
  const GhostAcoustics acoustics;
  Scene scene;
  AddQuad(scene, {-6, -2, -0.5}, {12, 0, 0}, {0, 12, 0}, "mirror");
  AddQuad(scene, {-6, -2, 0.6}, {0, 12, 0}, {12, 0, 0}, "mirror");
  AddQuad(scene, {-0.05, 4.0, -0.05}, {0.1, 0, 0}, {0, 0, 0.1}, "plate");
  const RayFan fan = acoustics.Fan(kGhostBeams, 1200);
  const GhostList first = acoustics.Trace(scene, Pose{}, fan);
  const GhostList second = acoustics.Trace(scene, Pose{}, fan, 2);
  const auto count = [](const GhostList& list, auto&& what) {
    return std::count_if(list.echoes.begin(), list.echoes.end(), what);
  };
  const auto by_two = [](const GhostEcho& echo) { return echo.leg.mirror[1] != kNoMirror; };
  EXPECT_EQ(count(first, by_two), 0);
  const auto of_first = [&](const GhostEcho& echo) {
    return !by_two(echo) && (!echo.both_ways || echo.other.straight());
  };
  EXPECT_EQ(count(second, of_first), std::ssize(first.echoes));
  int plates = 0;
  for (const GhostEcho& echo : second.echoes) {
    if (!by_two(echo) || second.material_names[echo.material] != "plate") continue;
    EXPECT_TRUE(echo.both_ways);
    // By floor and surface or the other way round: 2.2 m up or down.
    EXPECT_NEAR(echo.leg.length_m, std::hypot(4.0, 2.2), 0.04);
    EXPECT_NEAR(std::abs(echo.leg.elevation_rad), std::atan2(2.2, 4.0), 0.02);
    ++plates;
  }
  EXPECT_GT(plates, 5);
  // Out by the floor and back by the surface: by images 1 m below and 1.2 m above, each pair once.
  int floor_and_surface = 0;
  for (const GhostEcho& echo : second.echoes) {
    if (by_two(echo) || of_first(echo) || second.material_names[echo.material] != "plate") continue;
    EXPECT_LT(echo.leg.elevation_rad * echo.other.elevation_rad, 0.0F);
    EXPECT_NEAR(echo.leg.length_m, std::hypot(4.0, echo.leg.elevation_rad < 0.0F ? 1.0 : 1.2), 0.04);
    EXPECT_NEAR(echo.other.length_m, std::hypot(4.0, echo.other.elevation_rad < 0.0F ? 1.0 : 1.2), 0.04);
    ++floor_and_surface;
  }
  const auto by_floor_alone = [&](const GhostEcho& echo) {
    return of_first(echo) && !echo.both_ways && echo.leg.elevation_rad < 0.0F &&
           second.material_names[echo.material] == "plate";
  };
  EXPECT_EQ(floor_and_surface, count(second, by_floor_alone));
  EXPECT_THROW(acoustics.Trace(scene, Pose{}, fan, 3), DataError);
}

TEST(GhostFan, ReachesThroughTheLobesThatTheParametersName) {
  const SonarModel sonar = GhostSonar();
  const RayFanOptions fan{
      .sampling = Sampling::kBeams, .cols = kGhostBeams, .rows = 100, .elevation_span_deg = 150.0};
  BeamParameters beam{.elevation_width_deg = 20.0};
  EXPECT_EQ(GhostFanOptions(fan, sonar, beam).elevation_span_deg, 150.0);
  beam.mirror_lobes = MirrorLobes::kMain;
  // A cosine-shaded aperture v = L sin(el) has half of its two-way power, cos(pi v) / (1 - 4 v^2) =
  // 0.5^(1/4), at 0.4255, and its first null at 1.5.
  const double null_deg = DegFromRad(std::asin(1.5 / 0.4255 * std::sin(RadFromDeg(10.0))));
  EXPECT_NEAR(GhostFanOptions(fan, sonar, beam).elevation_span_deg, 2.0 * null_deg, 0.2);
}

}  // namespace
}  // namespace sonarcal::sim
