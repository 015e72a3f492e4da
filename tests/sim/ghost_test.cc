// Ghosts against image sources: the sonar's image behind a flat mirror sees each point of an object at the
// distance and from the side that the mirrored leg has. Sums over points of the object, no ray.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "data_io/types/error.h"
#include "sim/ghost_power.h"
#include "sim/scenes.h"
#include "sim/simulator.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr double kAlphaDbPerM = 0.31;
constexpr double kAzimuthWidthDeg = 1.6;
constexpr double kElevationWidthDeg = 24.0;
constexpr double kPulseM = 0.1;
constexpr double kLossDb = 4.5;
constexpr int kBeams = 64;
constexpr int kBins = 60;

// 64 beams of 0.8 degrees; 60 bins of 5 cm from 2.5 m on.
SonarModel TestSonar() {
  SonarModel sonar = MakeSonar(EvenAzimuthsDeg(kBeams, 0.8), kElevationWidthDeg, 2.5, 5.5, kBins);
  sonar.azimuth_beam_width_deg = kAzimuthWidthDeg;
  return sonar;
}

// Objects scatter; mirrors do nothing else.
ParameterSet TestParameters() {
  ParameterSet p;
  p.model = EchoModel::kAcoustic;
  p.source_level_db = 180.0;
  p.receiver.gain_db = 5.0;
  p.materials["default"].gsab = {.a = 0.16, .b_deg = 9.0, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
  p.materials["mirror"].gsab = {.a = 0.0, .b_deg = 1.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 1.0};
  p.mirrors["mirror"].loss_db = kLossDb;
  p.pulse.length_m = kPulseM;
  p.beam.azimuth_pattern = AzimuthPattern::kGaussian;  // closed forms
  p.beam.elevation_pattern = ElevationPattern::kGaussian;
  return p;
}

double Sigma(const ParameterSet& p, double cosine, double other_cosine, double tilt_rad) {
  const GsabParameters<double>& g = p.materials.at("default").gsab;
  const double tilt = tilt_rad * 180.0 / kPi;
  return g.a * std::exp(-tilt * tilt / (2.0 * g.b_deg * g.b_deg)) +
         g.c * std::pow(cosine, 0.5 * g.d) * std::pow(other_cosine, 0.5 * g.d) +
         g.e * std::exp(-tilt * tilt / (2.0 * g.f_deg * g.f_deg));
}

// Full width at half power.
double Response(double x, double width) {
  return std::pow(0.5, 4.0 * x * x / (width * width));
}

struct Acoustics {
  SonarModel sonar = TestSonar();
  ParameterSet parameters = TestParameters();

  AcousticGeometry geometry() const { return {sonar, kAlphaDbPerM}; }
  RayFan Fan(int cols, int rows) const {
    return {sonar, {.sampling = Sampling::kBeams, .cols = cols, .rows = rows, .elevation_span_deg = 60.0}};
  }
  GhostList Trace(const Scene& scene, const Pose& pose, const RayFan& fan, int order = 1) const {
    const RayCaster caster(scene);
    const MirrorSurface mirrors(caster.scene(), ReflectingMaterials(caster.material_names(), parameters));
    return TraceGhosts(caster, mirrors, fan, pose, {.order = order, .range_min_m = 0.5, .range_max_m = 8.0});
  }
  // Of the ghosts alone, through beam and pulse.
  Grid<float> Power(const GhostList& ghosts) const {
    const RayFan fan = Fan(4 * kBeams, 1);
    ScatterMap scatter = MakeScatterMap(Nothing(fan), fan, geometry(), parameters);
    AddGhosts(ghosts, geometry(), parameters, scatter);
    return ExpectedPower(scatter, geometry(), parameters).value;
  }

 private:
  static EchoList Nothing(const RayFan& fan) {
    EchoList echoes;
    echoes.cols = fan.cols();
    return echoes;
  }
};

// A point of an object: where it is, which way its surface looks, how much of it there is.
struct Point {
  Eigen::Vector3d at_m;
  Eigen::Vector3d normal;
  double area_m2;
};

// What the sonar at the origin, looking along +y, gets from points by a flat mirror through `on_mirror`.
class ImageSource {
 public:
  ImageSource(const Acoustics& acoustics, const Eigen::Vector3d& on_mirror,
              const Eigen::Vector3d& mirror_normal)
      : acoustics_(acoustics),
        image_m_(2.0 * on_mirror.dot(mirror_normal) * mirror_normal),
        normal_(mirror_normal),
        power_(kBins, kBeams) {}

  void Add(const Point& point) {
    const Leg straight = LegFrom(Eigen::Vector3d::Zero(), point, point.at_m);
    // The sonar sees the point where its image lies.
    const Eigen::Vector3d seen_at = point.at_m - 2.0 * (point.at_m - 0.5 * image_m_).dot(normal_) * normal_;
    const Leg mirrored = LegFrom(image_m_, point, seen_at);
    if (!(mirrored.cosine > 0.0)) return;
    const double reflected = std::pow(10.0, -kLossDb / 10.0);
    Arrive(point.area_m2 * mirrored.power * mirrored.power * reflected * reflected *
               Sigma(acoustics_.parameters, mirrored.cosine, mirrored.cosine, std::acos(mirrored.cosine)),
           mirrored.length_m, {mirrored.azimuth_rad});
    if (!(straight.cosine > 0.0)) return;
    // Out by one leg, back by the other, and the reverse: the fields of both at a beam.
    const double tilt_rad = std::acos((straight.back + mirrored.back).normalized().dot(point.normal));
    Arrive(point.area_m2 * mirrored.power * straight.power * reflected *
               Sigma(acoustics_.parameters, mirrored.cosine, straight.cosine, tilt_rad),
           0.5 * (mirrored.length_m + straight.length_m), {mirrored.azimuth_rad, straight.azimuth_rad});
  }

  const Grid<double>& power() const { return power_; }

 private:
  struct Leg {
    double length_m;
    double cosine;
    double azimuth_rad;
    double power;  // what it leaves of a source
    Eigen::Vector3d back;
  };

  Leg LegFrom(const Eigen::Vector3d& from_m, const Point& point, const Eigen::Vector3d& seen_at) const {
    const Eigen::Vector3d way = point.at_m - from_m;
    const double length_m = way.norm();
    const ParameterSet& p = acoustics_.parameters;
    const double level_db = 0.5 * (p.source_level_db + p.receiver.gain_db) - 20.0 * std::log10(length_m) -
                            kAlphaDbPerM * length_m;
    const double there_and_back =
        Response(std::asin(seen_at.z() / length_m), kElevationWidthDeg * kPi / 180.0);
    return {length_m, -way.dot(point.normal) / length_m, std::atan2(seen_at.x(), seen_at.y()),
            std::pow(10.0, level_db / 10.0) * std::sqrt(there_and_back), -way / length_m};
  }

  void Arrive(double power, double range_m, const std::vector<double>& azimuths_rad) {
    for (int beam = 0; beam < kBeams; ++beam) {
      double field = 0.0;
      for (const double azimuth_rad : azimuths_rad) {
        field += std::sqrt(Response(azimuth_rad - acoustics_.sonar.axes.beam_azimuth_rad[beam],
                                    kAzimuthWidthDeg * kPi / 180.0));
      }
      const double heard = power * field * field;
      if (heard == 0.0) continue;
      for (int bin = 0; bin < kBins; ++bin) {
        power_(bin, beam) += heard * Response(range_m - (2.5 + (bin + 0.5) * 0.05), kPulseM);
      }
    }
  }

  const Acoustics& acoustics_;
  Eigen::Vector3d image_m_;
  Eigen::Vector3d normal_;
  Grid<double> power_;
};

// Points of a plate from `corner` along u and v, n by n.
std::vector<Point> PlatePoints(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                               const Eigen::Vector3d& v, int n) {
  std::vector<Point> points;
  const Eigen::Vector3d across = u.cross(v);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      points.push_back(
          {corner + (i + 0.5) / n * u + (j + 0.5) / n * v, across.normalized(), across.norm() / n / n});
    }
  }
  return points;
}

// Pixels within `tolerance` of the image source's, of its peak; and their sum within a tenth of that.
void ExpectLike(const Grid<float>& power, const Grid<double>& expected, double tolerance) {
  const double peak = *std::max_element(expected.values().begin(), expected.values().end());
  ASSERT_GT(peak, 0.0);
  double sum = 0.0;
  double expected_sum = 0.0;
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      ASSERT_NEAR(power(bin, beam), expected(bin, beam), tolerance * peak)
          << "bin " << bin << ", beam " << beam;
      sum += power(bin, beam);
      expected_sum += expected(bin, beam);
    }
  }
  EXPECT_NEAR(sum / expected_sum, 1.0, 0.25 * tolerance);
}

// A wall at the right, along the way the sonar looks; a plate beside it that faces the sonar. Straight and in
// the mirror the plate stands some 13 degrees apart: three arrivals. A pulse of two bins is sampled eight
// times, so that sharing moves a pixel by 8 ln 2 / 8 / 64 = 1.1 % of its peak at most, columns of a fifth of
// a beam 0.4 %; the plate's edges are sharp to a ray, 0.04 x 0.05 degrees of its 4 x 6.
TEST(Ghosts, PlateBeforeAWallByImageSource) {
  const Acoustics acoustics;
  Scene scene;
  AddQuad(scene, {0.5, 0.5, -3}, {0, 6, 0}, {0, 0, 6}, "mirror");
  AddQuad(scene, {-0.1, 3.5, -0.15}, {0.25, 0, 0}, {0, 0, 0.4}, "plate");
  ImageSource image(acoustics, {0.5, 0, 0}, {-1, 0, 0});
  for (const Point& point : PlatePoints({-0.1, 3.5, -0.15}, {0.25, 0, 0}, {0, 0, 0.4}, 60)) image.Add(point);
  const GhostList ghosts = acoustics.Trace(scene, Pose{}, acoustics.Fan(18 * kBeams, 1200));
  ExpectLike(acoustics.Power(ghosts), image.power(), 0.03);
}

// Of a floor the two ways of a pair come back from one direction: fields add.
TEST(Ghosts, SphereAboveAFloorByImageSource) {
  const Acoustics acoustics;
  constexpr double kRadiusM = 0.3;
  const Eigen::Vector3d centre(0.1, 3.6, -0.05);
  Scene scene;
  AddQuad(scene, {-6, -2, -0.6}, {12, 0, 0}, {0, 12, 0}, "mirror");
  AddSphere(scene, centre, kRadiusM, 160, "sphere");
  ImageSource image(acoustics, {0, 0, -0.6}, {0, 0, 1});
  constexpr int kRings = 200;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < 2 * kRings; ++sector) {
      const double polar = kPi * (ring + 0.5) / kRings;
      const double around = kPi * (sector + 0.5) / kRings;
      const Eigen::Vector3d normal(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                   std::cos(polar));
      image.Add({centre + kRadiusM * normal, normal,
                 kRadiusM * kRadiusM * std::sin(polar) * (kPi / kRings) * (kPi / kRings)});
    }
  }
  const GhostList ghosts = acoustics.Trace(scene, Pose{}, acoustics.Fan(6 * kBeams, 2000));
  ExpectLike(acoustics.Power(ghosts), image.power(), 0.03);
}

TEST(Ghosts, LevelDoesNotDependOnTheNumberOfRays) {
  const Acoustics acoustics;
  const Pose pose{RotationFromYawPitchRoll(0.3, -0.1, 0.1), {6.0, 4.0, 0.8}};
  Scene tank = MakeTank({.surface = true});
  tank.material_names = {"default", "mirror", "surface"};
  Acoustics six = acoustics;
  six.parameters.mirrors = {{"default", {10.0}}, {"mirror", {6.0}}, {"surface", {0.7}}};
  six.parameters.materials["mirror"] = six.parameters.materials["default"];
  const auto total = [&](int cols, int rows) {
    const Grid<float> power = six.Power(six.Trace(tank, pose, six.Fan(cols, rows)));
    double sum = 0.0;
    for (const float value : power.values()) sum += value;
    return sum;
  };
  const double few = total(kBeams, 400);
  const double many = total(3 * kBeams, 1600);
  EXPECT_GT(many, 0.0);
  EXPECT_NEAR(few / many, 1.0, 0.01);
}

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
      const FanHits hit = caster.Meet(ray);
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

TEST(MirrorSurface, FlatStaysFlat) {
  Scene scene;
  AddBox(scene, {-1, -1, -1}, {1, 1, 1}, "mirror");
  const MirrorSurface mirrors(scene, {1});
  const RayBundle sent({0.1, 0.2, 0.3}, Eigen::Vector3d(0.4, 0.9, -0.1).normalized());
  for (int triangle = 0; triangle < 12; ++triangle) {
    EXPECT_EQ(mirrors.Reflected(sent, triangle, 1.25).SpreadingM(0.5), 1.75);
  }
}

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
    const GhostList ghosts = acoustics_.Trace(scene, Pose{}, acoustics_.Fan(3 * kBeams, 600));
    std::pair<int, int> counts{0, 0};
    for (const GhostEcho& echo : ghosts.echoes) {
      if (ghosts.material_names[echo.material] == "plate") ++(echo.both_ways ? counts.second : counts.first);
    }
    return counts;
  }

  Acoustics acoustics_;
};

TEST_F(OnePlate, IsSeenBothWaysAndAtTheRightPlace) {
  const auto [single, both] = Counts(Make(0.5, 3.4));
  EXPECT_GT(single, 50);
  EXPECT_EQ(single, both);
  const GhostList ghosts = acoustics_.Trace(Make(0.5, 3.4), Pose{}, acoustics_.Fan(3 * kBeams, 600));
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

TEST_F(OnePlate, LegsAreBlocked) {
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
  const Acoustics acoustics;
  Scene scene;
  AddQuad(scene, {-6, -2, -0.5}, {12, 0, 0}, {0, 12, 0}, "mirror");
  AddQuad(scene, {-6, -2, 0.6}, {0, 12, 0}, {12, 0, 0}, "mirror");
  AddQuad(scene, {-0.05, 4.0, -0.05}, {0.1, 0, 0}, {0, 0, 0.1}, "plate");
  const RayFan fan = acoustics.Fan(kBeams, 1200);
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

TEST(Ghosts, SameOnAnyNumberOfThreads) {
  const Acoustics acoustics;
  Scene scene;
  AddQuad(scene, {0.5, 0.5, -3}, {0, 6, 0}, {0, 0, 6}, "mirror");
  AddQuad(scene, {-0.1, 3.5, -0.15}, {0.25, 0, 0}, {0, 0, 0.4}, "plate");
  const auto power = [&](int threads) {
    return WithThreads(
        threads, [&] { return acoustics.Power(acoustics.Trace(scene, Pose{}, acoustics.Fan(kBeams, 200))); });
  };
  EXPECT_EQ(power(1), power(2));
  EXPECT_EQ(power(1), power(4));
}

class TankWithMirrors : public ::testing::Test {
 protected:
  static SimulationOptions Options() {
    SimulationOptions options;
    options.fan = {.sampling = Sampling::kBeams, .cols = 2 * kBeams, .rows = 300, .elevation_span_deg = 60.0};
    options.noise = true;
    return options;
  }

  Simulator simulator_{MakeTank({.surface = true}), TestSonar(), Options()};
  Pose pose_{RotationFromYawPitchRoll(0.3, -0.1, 0.0), {6.0, 4.0, 0.8}};
  ParameterSet parameters_ = TestParameters();
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
  EXPECT_EQ(simulator_.RenderEchoes(simulator_.TraceEchoes(pose_), none).value, without);
}

// Expected and sampled images show the ghosts; a mirror that loses everything is none.
TEST_F(TankWithMirrors, ImagesShowThem) {
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
  EXPECT_EQ(simulator_.Render(pose_, parameters_).value,
            simulator_.RenderEchoes(echoes, parameters_, 0, ghosts).value);
  for (auto& [name, mirror] : parameters_.mirrors) mirror.loss_db = 200.0;
  const Grid<float> lost = simulator_.RenderExpected(echoes, parameters_, ghosts).value;
  for (std::size_t i = 0; i < lost.size(); ++i) EXPECT_NEAR(lost.values()[i], without.values()[i], 1e-3);
}

// What is sent at 30 degrees is outside of beams that end at 25.6, and comes back into them by a wall.
TEST(Ghosts, WhatIsSentAsideComesBack) {
  Scene scene;
  AddQuad(scene, {1.0, 0.5, -1}, {0, 6, 0}, {0, 0, 2}, "mirror");
  AddQuad(scene, {-0.1, 3.4, -0.1}, {0.2, 0, 0}, {0, 0, 0.2}, "plate");
  SimulationOptions options;
  options.fan = {.sampling = Sampling::kBeams, .cols = 2 * kBeams, .rows = 400, .elevation_span_deg = 60.0};
  const Simulator simulator(scene, TestSonar(), options);
  ParameterSet parameters = TestParameters();
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
}  // namespace sonarcal
