#include "sim/paper/paper_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/types/error.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/thread_limit.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

// A floor, a wall, a box and a ball, intersected in closed form and as meshes.
struct World {
  static constexpr double kWallY = 6.0;
  Eigen::Vector3d box_low{-1.2, 3.2, 0.0};
  Eigen::Vector3d box_high{-0.4, 4.0, 0.9};
  Eigen::Vector3d ball{0.9, 3.8, 0.7};
  double ball_radius = 0.5;
  static constexpr int kBallRings = 200;

  struct Hit {
    double range_m = std::numeric_limits<double>::infinity();
    Eigen::Vector3d normal{0, 0, 0};
    int material = -1;
  };

  Hit Intersect(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    Hit hit;
    const auto meet = [&](double t, const Eigen::Vector3d& normal, int material) {
      if (t > 0.0 && t < hit.range_m) hit = {t, normal, material};
    };
    meet(-from.z() / along.z(), {0, 0, 1}, 0);
    meet((kWallY - from.y()) / along.y(), {0, -1, 0}, 1);
    // Slabs.
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    int entered = -1;
    for (int axis = 0; axis < 3; ++axis) {
      double a = (box_low[axis] - from[axis]) / along[axis];
      double b = (box_high[axis] - from[axis]) / along[axis];
      if (a > b) std::swap(a, b);
      if (a > enter) entered = axis;
      enter = std::max(enter, a);
      leave = std::min(leave, b);
    }
    if (entered >= 0 && enter < leave) meet(enter, Eigen::Vector3d::Unit(entered), 2);
    const Eigen::Vector3d to_ball = ball - from;
    const double middle = along.dot(to_ball);
    const double under_root = middle * middle - to_ball.squaredNorm() + ball_radius * ball_radius;
    if (under_root > 0.0) {
      const double t = middle - std::sqrt(under_root);
      meet(t, (from + t * along - ball) / ball_radius, 3);
    }
    return hit;
  }

  Scene Mesh() const {
    Scene scene;
    AddQuad(scene, {-10, -4, 0}, {20, 0, 0}, {0, 20, 0}, "floor");
    AddQuad(scene, {-10, kWallY, -1}, {20, 0, 0}, {0, 0, 10}, "wall");
    AddBox(scene, box_low, box_high, "box");
    AddSphere(scene, ball, ball_radius, kBallRings, "ball");
    return scene;
  }
};

PaperParameters<double> FourMaterials() {
  PaperParameters<double> p;
  p.source_level_db = 200.0;
  p.display = {.db_min = 150.0, .db_max = 156.0};
  p.materials = {
      {90, 4, 100, 1, 90, 8}, {40, 3, 10, 2, 20, 12}, {5, 6, 30, 1.5, 90, 20}, {90, 4, 100, 1, 90, 8}};
  p.noise_level_db = 3.0;
  p.array_gain_db = 1.0;
  return p;
}

// Every pixel, against a renderer that shares nothing with sim/: its own pinhole, intersections and shading.
// Where float arithmetic may put a ray elsewhere (within kDoubt of a bin's border, or of the rim of an
// object), its share is allowed for in all the pixels that it may fall in; nothing else is.
TEST(PaperImage, EqualsASlowRendererInClosedForm) {
  constexpr int kCols = 600;
  constexpr int kRows = 480;
  constexpr double kDoubtRad = 1e-6;
  constexpr double kHalfAzimuthRad = 22.5 * kPi / 180.0;
  constexpr double kHalfElevationRad = 12.0 * kPi / 180.0;
  const World world;
  const SonarModel sonar = MakeSonar(EvenAzimuthsDeg(60, 0.75), 24.0, 1.5, 6.5, 200);
  const Pose pose{RotationFromYawPitchRoll(0.06, -0.1, 0.04), {0.1, 0.2, 1.1}};
  const PaperParameters<double> p = FourMaterials();

  const double fx = kCols / 2.0 / std::tan(kHalfAzimuthRad);
  const double fy = kRows / 2.0 / std::tan(kHalfElevationRad);
  std::vector<int> beam_of_col(kCols);
  std::vector<int> rays_of_beam(60, 0);
  for (int col = 0; col < kCols; ++col) {
    const double azimuth = std::atan((col + 0.5 - kCols / 2.0) / fx);
    beam_of_col[col] =
        static_cast<int>(std::floor((azimuth + kHalfAzimuthRad) / (2.0 * kHalfAzimuthRad) * 60));
    rays_of_beam[beam_of_col[col]] += kRows;
  }
  Grid<double> sum(200, 60);
  Grid<double> allowance(200, 60);
  Grid<int> ball_rays(200, 60);
  const auto bin_of = [](double range_m) { return static_cast<int>(std::floor((range_m - 1.5) / 0.025)); };
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const int beam = beam_of_col[col];
      const auto shoot = [&](double right, double up) {
        const Eigen::Vector3d point((col + 0.5 - kCols / 2.0) / fx + right, 1.0,
                                    -(row + 0.5 - kRows / 2.0) / fy + up);
        const Eigen::Vector3d along = pose.rotation * point.normalized();
        World::Hit hit = world.Intersect(pose.position_m, along);
        const double cosine = std::min(1.0, std::abs(along.dot(hit.normal)));
        return std::make_tuple(hit, std::acos(cosine), cosine);
      };
      const auto [hit, incidence, cosine] = shoot(0.0, 0.0);
      const double share = 255.0 * SlowNormalisedEcho(p, hit.material, hit.range_m, incidence, kAlphaDbPerM) /
                           rays_of_beam[beam];
      std::set<std::pair<int, int>> landings;  // (bin, material)
      // Float coordinates of up to 20 m (2^-24 x 20 m = 1.2e-6 m, a few times over), and the ball's facets,
      // which lie up to 3.2e-5 m inside it.
      const double doubt_m = (hit.material == 3 ? 4e-5 : 8e-6) / std::max(cosine, 0.02);
      for (const double shift_m : {-doubt_m, 0.0, doubt_m}) {
        landings.emplace(bin_of(hit.range_m + shift_m), hit.material);
      }
      for (const double up : {-kDoubtRad, kDoubtRad}) {
        for (const double right : {-kDoubtRad, kDoubtRad}) {
          const World::Hit other = std::get<0>(shoot(right, up));
          landings.emplace(bin_of(other.range_m), other.material);
        }
      }
      const int bin = bin_of(hit.range_m);
      if (bin >= 0 && bin < 200) {
        sum(bin, beam) += share;
        ball_rays(bin, beam) += hit.material == 3 ? 1 : 0;
      }
      if (landings.size() > 1) {
        for (const auto& landing : landings) {
          if (landing.first >= 0 && landing.first < 200) allowance(landing.first, beam) += 1.3 * share;
        }
      }
    }
  }

  const RayFan fan(sonar, {.sampling = Sampling::kFrustum, .cols = kCols, .rows = kRows});
  const RayCaster caster(world.Mesh());
  const PolarImage image = RenderPaperImage(Trace(caster, fan, pose, sonar.axes), sonar, p, kAlphaDbPerM);
  int within_one_grey = 0;
  int lit = 0;
  int saturated = 0;
  for (int bin = 0; bin < 200; ++bin) {
    for (int beam = 0; beam < 60; ++beam) {
      const double expected = std::clamp(sum(bin, beam), 0.0, 255.0);
      const double difference = std::abs(image.value(bin, beam) - expected);
      within_one_grey += difference <= 1.0 ? 1 : 0;
      lit += expected > 5.0 ? 1 : 0;
      saturated += expected == 255.0 ? 1 : 0;
      // Incidence in float moves a level by 1e-6 of a degree's slope; a ball's facet leans up to 0.6 degrees,
      // and the levels fall by at most 1 dB a degree, of 6 dB.
      const double facets = ball_rays(bin, beam) * 255.0 * 0.6 / 6.0 / rays_of_beam[beam];
      ASSERT_LE(difference, 1e-3 + facets + allowance(bin, beam)) << "bin " << bin << ", beam " << beam;
    }
  }
  EXPECT_GE(within_one_grey, 200 * 60 * 0.999);
  EXPECT_GT(lit, 1500);
  EXPECT_LT(saturated, 600);
}

// Echoes as a trace would give them: `cols` columns of one row, two columns in each of the first beams.
struct Ray {
  int col;
  float range_m;
  float incidence_rad;
  std::uint16_t material;
};

EchoList Echoes(const SonarModel& sonar, const std::vector<int>& beam_of_column, int rows,
                const std::vector<Ray>& rays) {
  EchoList echoes;
  echoes.cols = static_cast<int>(beam_of_column.size());
  echoes.beam_of_column = beam_of_column;
  echoes.rays_per_beam.assign(sonar.axes.beam_count(), 0);
  for (const int beam : beam_of_column) echoes.rays_per_beam[beam] += rows;
  echoes.material_names = {"floor", "wall", "box", "ball"};
  std::vector<int> row(echoes.cols, 0);
  for (const Ray& ray : rays) {
    echoes.ray.push_back(static_cast<std::uint32_t>(row[ray.col]++ * echoes.cols + ray.col));
    echoes.material.push_back(ray.material);
    echoes.range_m.push_back(ray.range_m);
    echoes.azimuth_rad.push_back(static_cast<float>(sonar.axes.beam_azimuth_rad[beam_of_column[ray.col]]));
    echoes.elevation_rad.push_back(0.0F);
    echoes.incidence_rad.push_back(ray.incidence_rad);
    echoes.solid_angle_sr.push_back(1e-4F);
  }
  return echoes;
}

// s = (SNR - 0) / 100 with SNR = SL - 40 log10 R + 10 log10 (C cos D): at 1 m, normal incidence, A = E = 0.
PaperParameters<double> LevelsByHand() {
  PaperParameters<double> p;
  p.source_level_db = 50.0;
  p.display = {.db_min = 0.0, .db_max = 100.0};
  p.materials = {{0, 4, 1, 1, 0, 8}, {0, 4, 10, 1, 0, 8}, {0, 4, 1e-7, 1, 0, 8}, {0, 4, 1e7, 1, 0, 8}};
  return p;
}

// Two columns in beam 0 and one in each of the others, three rows: beam 0 has six rays, not three.
TEST(PaperImage, DividesByAllTheRaysOfABeam) {
  const SonarModel sonar = MakeSonar({-1.0, 0.0, 1.0}, 20.0, 0.5, 2.5, 2);
  const EchoList echoes = Echoes(sonar, {0, 0, 1, 2}, 3,
                                 {{0, 1.0F, 0.0F, 0},    // 0.5
                                  {1, 1.0F, 0.0F, 1},    // 0.6
                                  {2, 1.0F, 0.0F, 1},    // 0.6
                                  {2, 1.0F, 0.0F, 0},    // 0.5
                                  {3, 2.0F, 0.0F, 1}});  // 0.6 - 0.4 log10 2
  const PolarImage image = RenderPaperImage(echoes, sonar, LevelsByHand(), 0.0);
  EXPECT_NEAR(image.value(0, 0), 255.0 * 1.1 / 6.0, 1e-4);
  EXPECT_NEAR(image.value(0, 1), 255.0 * 1.1 / 3.0, 1e-4);
  EXPECT_EQ(image.value(0, 2), 0.0F);
  EXPECT_NEAR(image.value(1, 2), 255.0 * (0.6 - 0.4 * std::log10(2.0)) / 3.0, 1e-4);
  EXPECT_EQ(image.scale.quantity, Quantity::kGrey);
  EXPECT_EQ(image.scale.full_scale, 255.0);
  EXPECT_EQ(image.scale.db_min, 0.0);
  EXPECT_EQ(image.scale.db_max, 100.0);
}

// Only the sum is clamped: a ray below db_min takes from what others give, one above db_max gives more
// than 1.
TEST(PaperImage, ClampsTheSumAndNotTheRay) {
  const SonarModel sonar = MakeSonar({-1.0, 0.0, 1.0}, 20.0, 0.5, 2.5, 2);
  // Materials 2 and 3 are at -20 dB and 120 dB: s = -0.2 and 1.2.
  const EchoList echoes = Echoes(sonar, {0, 1, 2}, 2,
                                 {{0, 1.0F, 0.0F, 0},
                                  {0, 1.0F, 0.0F, 2},  // (0.5 - 0.2) / 2
                                  {1, 1.0F, 0.0F, 2},  // below 0
                                  {2, 1.0F, 0.0F, 3},
                                  {2, 1.0F, 0.0F, 3}});  // above 1
  const PolarImage image = RenderPaperImage(echoes, sonar, LevelsByHand(), 0.0);
  EXPECT_NEAR(image.value(0, 0), 255.0 * 0.15, 1e-4);
  EXPECT_EQ(image.value(0, 1), 0.0F);
  EXPECT_EQ(image.value(0, 2), 255.0F);
  PolarImage twelve_bits =
      RenderPaperImage(echoes, sonar, LevelsByHand(), 0.0, {.full_scale = 4095.0, .noise_seed = {}});
  EXPECT_NEAR(twelve_bits.value(0, 0), 4095.0 * 0.15, 1e-3);
  EXPECT_EQ(twelve_bits.value(0, 2), 4095.0F);
  EXPECT_EQ(twelve_bits.scale.full_scale, 4095.0);
  QuantiseImage(twelve_bits);
  EXPECT_EQ(twelve_bits.value(0, 0), 614.0F);  // 614.25
}

// Levels far beyond the display: huge sums must neither wrap around nor lose their sign.
TEST(PaperImage, LevelsFarBeyondANarrowDisplaySaturate) {
  const SonarModel sonar = MakeSonar({-1.0, 0.0, 1.0}, 20.0, 0.5, 2.5, 2);
  std::vector<Ray> rays;
  for (int i = 0; i < 40; ++i) {
    rays.push_back({0, 1.0F, 0.0F, 3});
    rays.push_back({1, 1.0F, 0.0F, 2});
  }
  PaperParameters<double> p = LevelsByHand();
  p.display = {.db_min = 50.0, .db_max = 50.0 + 1e-9};
  const PolarImage image = RenderPaperImage(Echoes(sonar, {0, 1, 2}, 40, rays), sonar, p, 0.0);
  EXPECT_EQ(image.value(0, 0), 255.0F);
  EXPECT_EQ(image.value(0, 1), 0.0F);
}

TEST(PaperImage, EmptyViewIsBlack) {
  const SonarModel sonar = MakeSonar({-1.0, 0.0, 1.0}, 20.0, 0.5, 2.5, 2);
  for (const std::optional<std::uint64_t> seed : {std::optional<std::uint64_t>(), {5}}) {
    const PolarImage image = RenderPaperImage(Echoes(sonar, {0, 1, 2}, 2, {}), sonar, LevelsByHand(), 0.0,
                                              {.full_scale = 255.0, .noise_seed = seed});
    EXPECT_EQ(image.value, Grid<float>(2, 3));
  }
}

TEST(PaperImage, NeedsParametersForEveryMaterial) {
  const SonarModel sonar = MakeSonar({-1.0, 0.0, 1.0}, 20.0, 0.5, 2.5, 2);
  PaperParameters<double> p = LevelsByHand();
  p.materials.pop_back();
  EXPECT_THROW(RenderPaperImage(Echoes(sonar, {0, 1, 2}, 2, {}), sonar, p, 0.0), std::logic_error);
}

class NoisyPaperImage : public ::testing::TestWithParam<JitterGrowth> {
 protected:
  NoisyPaperImage() {
    parameters_.display = {.db_min = 0.0, .db_max = 600.0};  // no pixel near the clamps
    parameters_.jitter = {.sigma_range_m = 0.05,
                          .sigma_azimuth_deg = 0.9,
                          .reference_range_m = 4.0,
                          .reference_frequency_hz = 900e3,
                          .growth = GetParam()};
    const RayFan fan(sonar_, {.sampling = Sampling::kFrustum, .cols = 150, .rows = 80});
    echoes_ = Trace(RayCaster(World().Mesh()), fan, Pose{RotationFromYawPitchRoll(0, -0.1, 0), {0, 0, 1.1}},
                    sonar_.axes);
  }

  PolarImage Render(std::optional<std::uint64_t> seed) const {
    return RenderPaperImage(echoes_, sonar_, parameters_, kAlphaDbPerM,
                            {.full_scale = 255.0, .noise_seed = seed});
  }

  SonarModel sonar_ = MakeSonar(EvenAzimuthsDeg(30, 1.5), 24.0, 1.5, 6.7, 65);
  PaperParameters<double> parameters_ = FourMaterials();
  EchoList echoes_;
};

TEST_P(NoisyPaperImage, SameSeedSameImageOnAnyNumberOfThreads) {
  for (const std::optional<std::uint64_t> seed : {std::optional<std::uint64_t>(), {17}}) {
    const PolarImage one = WithThreads(1, [&] { return Render(seed); });
    for (const int threads : {2, 4}) {
      EXPECT_EQ(WithThreads(threads, [&] { return Render(seed); }).value, one.value) << threads << " threads";
    }
  }
  EXPECT_NE(Render(17).value, Render(18).value);
  EXPECT_NE(Render(17).value, Render({}).value);
}

// Rays err independently, so mean and variance of every pixel are sums over the rays. Over n seeds the mean
// is off by z standard errors, z normal: |z| > 5 in one of 1950 pixels has a chance of 1e-3, and the mean of
// z^2 over N pixels is 1 to within 4.5 sqrt(2 / N), a little more for their correlation.
TEST_P(NoisyPaperImage, MeanOverSeedsIsTheExpectation) {
  const SlowImage exact = SlowExpectation(echoes_, sonar_, parameters_, kAlphaDbPerM);
  constexpr int kSeeds = 300;
  Grid<double> sum(65, 30);
  Grid<double> sum_of_squares(65, 30);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const PolarImage image = Render(1000 + seed);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double value = double{image.value.values()[i]} / 255.0;
      ASSERT_LT(value, 1.0);
      sum.values()[i] += value;
      sum_of_squares.values()[i] += value * value;
    }
  }
  double z_squares = 0.0;
  double variance_ratio = 0.0;
  int pixels = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (exact.rays.values()[i] * kSeeds < 100.0) continue;  // too few rays for a normal law
    const double mean = sum.values()[i] / kSeeds;
    const double z = (mean - exact.mean.values()[i]) / std::sqrt(exact.variance.values()[i] / kSeeds);
    ASSERT_LT(std::abs(z), 5.0) << "pixel " << i;
    z_squares += z * z;
    variance_ratio += (sum_of_squares.values()[i] / kSeeds - mean * mean) / exact.variance.values()[i];
    ++pixels;
  }
  ASSERT_GT(pixels, 800);
  EXPECT_NEAR(z_squares / pixels, 1.0, 6.0 * std::sqrt(2.0 / pixels));
  EXPECT_NEAR(variance_ratio / pixels, 1.0, 1.0 / kSeeds + 6.0 * std::sqrt(2.0 / kSeeds / pixels));
}

INSTANTIATE_TEST_SUITE_P(Growth, NoisyPaperImage,
                         ::testing::Values(JitterGrowth::kRoot, JitterGrowth::kLinear),
                         [](const auto& tested) {
                           return tested.param == JitterGrowth::kRoot ? "Root" : "Linear";
                         });

}  // namespace
}  // namespace sonarcal::sim
