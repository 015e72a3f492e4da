#include "sim/paper/expected_paper_image.h"

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "sim/paper/paper_image.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/thread_limit.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr int kBeams = 14;
constexpr int kImageBins = 18;

// A patch of echoes spread evenly over each cell of the histogram, with materials and incidences that change
// from pixel to pixel. Incidences lie on the histogram's grid, so that nothing is interpolated.
EchoList EvenlySpreadEchoes(const SonarModel& sonar) {
  constexpr int kAzimuths = 16;  // a beam
  constexpr int kRanges = 4;     // a cell
  EchoList echoes;
  echoes.cols = kBeams;
  echoes.beam_of_column.resize(kBeams);
  std::iota(echoes.beam_of_column.begin(), echoes.beam_of_column.end(), 0);
  echoes.rays_per_beam.assign(kBeams, 1500);
  echoes.material_names = {"floor", "wall"};
  const std::vector<double> edges = sonar.axes.BeamEdgesRad();
  for (int bin = 3; bin < 14; ++bin) {
    for (int beam = 2; beam < 11; ++beam) {
      if ((3 * bin + 5 * beam) % 4 == 0) continue;  // holes
      for (int i = 0; i < 4 * kRanges * kAzimuths; ++i) {
        const int range = i / kAzimuths;
        const int azimuth = i % kAzimuths;
        const double in_bin = (range + 0.5) / (4 * kRanges);
        const double in_beam = (azimuth + 0.5) / kAzimuths;
        echoes.ray.push_back(static_cast<std::uint32_t>(beam + kBeams * i));
        echoes.material.push_back((bin + beam) % 3 == 0 ? 1 : 0);
        echoes.range_m.push_back(
            static_cast<float>(sonar.axes.range_min_m + (bin + in_bin) * sonar.axes.range_bin_m()));
        echoes.azimuth_rad.push_back(
            static_cast<float>(edges[beam] + in_beam * (edges[beam + 1] - edges[beam])));
        echoes.elevation_rad.push_back(0.0F);
        echoes.incidence_rad.push_back(static_cast<float>(RadFromDeg(5.0 * ((bin * 7 + beam) % 16))));
        echoes.solid_angle_sr.push_back(1e-4F);
      }
    }
  }
  return echoes;
}

SonarModel EvenSonar() {
  return MakeSonar(EvenAzimuthsDeg(kBeams, 0.8), 20.0, 2.0, 2.9, kImageBins);
}

SonarModel UnevenSonar() {
  std::vector<double> azimuth_deg = EvenAzimuthsDeg(kBeams, 0.8);
  for (double& azimuth : azimuth_deg) azimuth += 0.004 * azimuth * azimuth * azimuth;
  return MakeSonar(azimuth_deg, 20.0, 2.0, 2.9, kImageBins);
}

PaperParameters<double> TwoMaterials(double sigma_range_m, double sigma_azimuth_deg, JitterGrowth growth) {
  PaperParameters<double> p;
  p.source_level_db = 190.0;
  p.display = {.db_min = 100.0, .db_max = 260.0};
  p.materials = {{90, 4, 100, 1, 90, 8}, {40, 3, 10, 2, 20, 12}};
  p.jitter = {.sigma_range_m = sigma_range_m,
              .sigma_azimuth_deg = sigma_azimuth_deg,
              .reference_range_m = 3.0,
              .reference_frequency_hz = 900e3,
              .growth = growth};
  p.noise_level_db = 2.0;
  p.array_gain_db = 1.0;
  return p;
}

std::vector<double> Expected(const EchoHistogram& histogram, const SonarModel& sonar,
                             const PaperParameters<double>& p) {
  const ImageGeometry geometry(sonar, kAlphaDbPerM);
  return ExpectedPaperImage(histogram, geometry, p);
}

double Largest(const Grid<double>& image) {
  return *std::max_element(image.values().begin(), image.values().end());
}

// What may differ from the ray-by-ray expectation, as a part of the brightest pixel:
//   blurs cut at 4 sigma         2 axes x 2 sides x 3.2e-5 of what a pixel would get
//   midpoint sums in azimuth     h^2/24 x 0.48/sigma^2, h = 1/16 beam, sigma >= 0.8 beam: 1.2e-4
//   ... and in range             h = 1/16 bin, sigma >= 1 bin: 8e-5
//   blurs shared within 1 %      0.5 x 1e-4 x |sigma^2 w''| <= 1e-4
//   sigma at the cell's middle   its growth over an eighth (or half) of a bin of 5 cm: 2e-4 at most
TEST(ExpectedPaperImage, EqualsTheRaysForEchoesEvenlySpread) {
  struct Case {
    double sigma_range_m, sigma_azimuth_deg;
    JitterGrowth growth;
  };
  for (const SonarModel& sonar : {EvenSonar(), UnevenSonar()}) {
    const EchoList echoes = EvenlySpreadEchoes(sonar);
    const EchoHistogram histogram = GatherEchoes(echoes, sonar.axes);
    for (const Case& c : {Case{0.05, 0.7, JitterGrowth::kRoot}, Case{0.05, 0.7, JitterGrowth::kLinear},
                          Case{0.11, 1.6, JitterGrowth::kRoot}, Case{0.3, 0.7, JitterGrowth::kRoot}}) {
      const auto p = TwoMaterials(c.sigma_range_m, c.sigma_azimuth_deg, c.growth);
      const SlowImage exact = SlowExpectation(echoes, sonar, p, kAlphaDbPerM);
      const std::vector<double> image = Expected(histogram, sonar, p);
      ASSERT_EQ(image.size(), exact.mean.size());
      const double peak = Largest(exact.mean);
      ASSERT_GT(peak, 0.005);
      ASSERT_LT(peak, 1.0);
      for (std::size_t i = 0; i < image.size(); ++i) {
        ASSERT_NEAR(image[i], exact.mean.values()[i], 6e-4 * peak)
            << "pixel " << i << ", sigmas " << c.sigma_range_m << " m, " << c.sigma_azimuth_deg << " deg";
      }
    }
  }
}

// One axis without errors stays sharp there.
TEST(ExpectedPaperImage, BlursOneAxisAlone) {
  const SonarModel sonar = EvenSonar();
  const EchoList echoes = EvenlySpreadEchoes(sonar);
  const EchoHistogram histogram = GatherEchoes(echoes, sonar.axes);
  for (const auto& [sigma_range_m, sigma_azimuth_deg] : {std::pair(0.05, 0.0), std::pair(0.0, 0.7)}) {
    const auto p = TwoMaterials(sigma_range_m, sigma_azimuth_deg, JitterGrowth::kRoot);
    const SlowImage exact = SlowExpectation(echoes, sonar, p, kAlphaDbPerM);
    const std::vector<double> image = Expected(histogram, sonar, p);
    for (std::size_t i = 0; i < image.size(); ++i) {
      ASSERT_NEAR(image[i], exact.mean.values()[i], 6e-4 * Largest(exact.mean));
    }
  }
}

TEST(ExpectedPaperImage, SameOnAnyNumberOfThreads) {
  const SonarModel sonar = UnevenSonar();
  const EchoHistogram histogram = GatherEchoes(EvenlySpreadEchoes(sonar), sonar.axes);
  const auto render = [&] {
    return Expected(histogram, sonar, TwoMaterials(0.05, 0.7, JitterGrowth::kRoot));
  };
  const auto one = WithThreads(1, render);
  EXPECT_EQ(WithThreads(2, render), one);
  EXPECT_EQ(WithThreads(4, render), one);
}

TEST(ExpectedPaperImage, TheMeanIsClampedToTheDisplaysEnds) {
  const SonarModel sonar = EvenSonar();
  const EchoHistogram histogram = GatherEchoes(EvenlySpreadEchoes(sonar), sonar.axes);
  auto p = TwoMaterials(0.05, 0.7, JitterGrowth::kRoot);
  p.display = {.db_min = 100.0, .db_max = 101.0};
  EXPECT_THAT(Expected(histogram, sonar, p), ::testing::Contains(1.0).Times(::testing::Gt(50)));
  p.display = {.db_min = 300.0, .db_max = 400.0};
  EXPECT_THAT(Expected(histogram, sonar, p), ::testing::Each(0.0));
}

EchoList TankEchoes(const SonarModel& sonar) {
  Scene scene;
  AddQuad(scene, {-20, -20, 0}, {40, 0, 0}, {0, 40, 0}, "floor");
  AddBox(scene, {-1.0, 3.0, 0.0}, {-0.2, 3.8, 0.9}, "box");
  AddSphere(scene, {0.9, 3.8, 0.7}, 0.5, 60, "box");
  const RayFan fan(sonar, {.sampling = Sampling::kFrustum, .cols = 200, .rows = 160});
  return Trace(RayCaster(scene), fan, Pose{RotationFromYawPitchRoll(0.1, -0.1, 0.05), {0, 0, 1.1}},
               sonar.axes);
}

// The stated bound of the incidence grid: 0.003 dB an echo up to 86 degrees. Nearer to grazing the level of
// the cosine falls ever faster: h^2/8 |f''| = h^2/8 x 4.343 / cos^2, h a quarter of a degree.
TEST(ExpectedPaperImage, WithoutErrorsIsTheSharpImage) {
  const SonarModel sonar = MakeSonar(EvenAzimuthsDeg(30, 1.5), 24.0, 1.5, 8.0, 130);
  const EchoList echoes = TankEchoes(sonar);
  PaperParameters<double> p = TwoMaterials(0.0, 0.0, JitterGrowth::kRoot);
  p.display = {.db_min = 100.0, .db_max = 110.0};
  const PolarImage sharp =
      RenderPaperImage(echoes, sonar, p, kAlphaDbPerM, {.full_scale = 1.0, .noise_seed = {}});
  Grid<double> bound_db(130, 30);
  const double step_rad = RadFromDeg(kIncidenceStepDeg);
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const int bin = static_cast<int>((echoes.range_m[echo] - 1.5) / 0.05);
    const double cosine = std::cos(echoes.incidence_rad[echo] + step_rad);
    const double exponent = p.materials[echoes.material[echo]].d;
    const double per_echo = std::max(0.003, step_rad * step_rad / 8.0 * 4.343 * exponent / (cosine * cosine));
    // Within a step of 90 degrees there is no such bound: see the next test.
    bound_db(bin, echoes.Beam(echo)) +=
        (cosine > 0.004 ? per_echo : 40.0) / echoes.rays_per_beam[echoes.Beam(echo)];
  }
  const std::vector<double> image = Expected(GatherEchoes(echoes, sonar.axes), sonar, p);
  int lit = 0;
  for (int bin = 0; bin < 130; ++bin) {
    for (int beam = 0; beam < 30; ++beam) {
      const double value = image[static_cast<std::size_t>(bin) * 30 + beam];
      // Floats of 1 in the sharp image and in the histogram's weights: 1.2e-7 x 40 dB / 10 dB.
      ASSERT_NEAR(value, sharp.value(bin, beam), bound_db(bin, beam) / 10.0 + 1e-6);
      lit += value > 0.01 ? 1 : 0;
    }
  }
  EXPECT_GT(lit, 1000);
}

// Rays that count by their solid angle: the image that fits use weighs them as the one ray by ray does, sharp
// and (against the law) blurred. Bounds as above, for incidences of this scene.
TEST(ExpectedPaperImage, WeighsRaysAsTheImageRayByRay) {
  const SonarModel sonar = MakeSonar(EvenAzimuthsDeg(30, 1.5), 24.0, 1.5, 8.0, 130);
  Scene plate;
  AddQuad(plate, {-20, 4, -20}, {40, 1, 0}, {0, 3, 40}, "floor");
  const auto trace = [&](RayWeight weight) {
    const RayFan fan(sonar, {.sampling = Sampling::kFrustum, .cols = 300, .rows = 400, .weight = weight});
    EchoList echoes = Trace(RayCaster(plate), fan, Pose{}, sonar.axes);
    echoes.material_names = {"floor", "wall"};
    return echoes;
  };
  const EchoList echoes = trace(RayWeight::kSolidAngle);
  ASSERT_EQ(echoes.weight.size(), echoes.size());
  PaperParameters<double> p = TwoMaterials(0.0, 0.0, JitterGrowth::kRoot);
  p.display = {.db_min = 100.0, .db_max = 180.0};
  const auto sharp = [&](const EchoList& of) {
    return RenderPaperImage(of, sonar, p, kAlphaDbPerM, {.full_scale = 1.0, .noise_seed = {}}).value;
  };
  const Grid<float> ray_by_ray = sharp(echoes);
  const std::vector<double> image = Expected(GatherEchoes(echoes, sonar.axes), sonar, p);
  const Grid<float> even = sharp(trace(RayWeight::kEven));
  double apart = 0.0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_NEAR(image[i], ray_by_ray.values()[i], 1e-4);
    apart = std::max(apart, std::abs(image[i] - double{even.values()[i]}));
  }
  EXPECT_GT(apart, 1e-3) << "weights change the image";
  const auto blurred = TwoMaterials(0.05, 0.7, JitterGrowth::kRoot);
  const SlowImage exact = SlowExpectation(echoes, sonar, blurred, kAlphaDbPerM);
  const std::vector<double> expected = Expected(GatherEchoes(echoes, sonar.axes), sonar, blurred);
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_NEAR(expected[i], exact.mean.values()[i], 0.02 * Largest(exact.mean));
}

// Towards 90 degrees the level of a cosine has no bottom. Echoes spread evenly over the last quarter of a
// degree must keep their mean level, D x 10/ln 10 (ln cos(89.75 deg) - 1); not sink to the floor of -120 dB.
TEST(ExpectedPaperImage, GrazingEchoesKeepTheirMeanLevel) {
  const SonarModel sonar = EvenSonar();
  EchoList echoes;
  echoes.cols = kBeams;
  echoes.beam_of_column.resize(kBeams);
  std::iota(echoes.beam_of_column.begin(), echoes.beam_of_column.end(), 0);
  echoes.material_names = {"floor", "wall"};
  constexpr int kCount = 1000;
  echoes.rays_per_beam.assign(kBeams, kCount);
  for (int i = 0; i < kCount; ++i) {
    echoes.ray.push_back(static_cast<std::uint32_t>(4 + kBeams * i));
    echoes.material.push_back(0);
    echoes.range_m.push_back(2.26F);
    echoes.azimuth_rad.push_back(static_cast<float>(sonar.axes.beam_azimuth_rad[4]));
    echoes.elevation_rad.push_back(0.0F);
    echoes.incidence_rad.push_back(static_cast<float>(RadFromDeg(89.75 + 0.25 * (i + 0.5) / kCount)));
    echoes.solid_angle_sr.push_back(1e-4F);
  }
  PaperParameters<double> p = TwoMaterials(0.0, 0.0, JitterGrowth::kRoot);
  p.display = {.db_min = 0.0, .db_max = 300.0};
  const std::vector<double> image = Expected(GatherEchoes(echoes, sonar.axes), sonar, p);
  const double grazing_rad = RadFromDeg(0.25);
  const double strength_db = 20.0 + 4.342945 * (std::log(grazing_rad) - 1.0);
  const double loss_db = 2.0 * (20.0 * std::log10(2.26) + kAlphaDbPerM * 2.26);
  EXPECT_NEAR(300.0 * image[5 * kBeams + 4], 190.0 - loss_db + strength_db - 2.0 + 1.0, 0.02);
}

// --- Derivatives
// ---------------------------------------------------------------------------------------------

constexpr int kParameters = 18;  // level, display, two materials, jitter
using Vector = Eigen::Matrix<double, kParameters, 1>;

template <typename T>
PaperParameters<T> FromVector(const Eigen::Matrix<T, kParameters, 1>& v) {
  const auto material = [&](int first) {
    return GsabParameters<T>{v[first], v[first + 1], v[first + 2], v[first + 3], v[first + 4], v[first + 5]};
  };
  PaperParameters<T> p;
  p.source_level_db = v[0];
  p.display = {v[1], v[2]};
  p.materials = {material(3), material(9)};
  p.jitter = {.sigma_range_m = v[15],
              .sigma_azimuth_deg = v[16],
              .reference_range_m = v[17],
              .reference_frequency_hz = 900e3,
              .growth = JitterGrowth::kRoot};
  return p;
}

Vector ExampleVector() {
  Vector v;
  v << 190, 100, 260, 90, 4, 100, 1, 90, 8, 40, 3, 10, 2, 20, 12, 0.06, 0.8, 3.0;
  return v;
}

class ExpectedPaperImageDerivatives : public ::testing::TestWithParam<bool> {
 protected:
  using Jet = ceres::Jet<double, kParameters>;

  std::vector<double> Values(const Vector& v) const {
    return ExpectedPaperImage(histogram_, geometry_, FromVector<double>(v));
  }

  std::vector<Jet> Jets(const Vector& v) const {
    Eigen::Matrix<Jet, kParameters, 1> jets;
    for (int i = 0; i < kParameters; ++i) jets[i] = Jet(v[i], i);
    return ExpectedPaperImage(histogram_, geometry_, FromVector<Jet>(jets));
  }

  SonarModel sonar_ = GetParam() ? EvenSonar() : UnevenSonar();
  EchoList echoes_ = EvenlySpreadEchoes(sonar_);
  EchoHistogram histogram_ = GatherEchoes(echoes_, sonar_.axes);
  ImageGeometry geometry_{sonar_, kAlphaDbPerM};
};

// Levels, display and materials: against differences of the same function, whose blurs do not change. Steps
// of 1e-4 p; the image's third derivatives (p^3 f''' <= 10) leave 1e-8 x 10 / 6.
TEST_P(ExpectedPaperImageDerivatives, DerivativesEqualCentralDifferences) {
  const Vector at = ExampleVector();
  const std::vector<Jet> jets = Jets(at);
  const std::vector<double> values = Values(at);
  for (int parameter = 0; parameter < 15; ++parameter) {
    const double h = 1e-4 * at[parameter];
    const std::vector<double> plus = Values(at + h * Vector::Unit(parameter));
    const std::vector<double> minus = Values(at - h * Vector::Unit(parameter));
    double largest = 0.0;
    for (std::size_t i = 0; i < plus.size(); ++i) {
      ASSERT_NEAR(jets[i].a, values[i], 1e-14);
      const double derivative = jets[i].v[parameter] * at[parameter];
      ASSERT_NEAR(derivative, (plus[i] - minus[i]) / 2e-4, 2e-8) << "parameter " << parameter;
      largest = std::max(largest, std::abs(derivative));
    }
    EXPECT_GT(largest, 1e-5) << "parameter " << parameter << " moves nothing";
  }
}

// Errors: against differences of the ray-by-ray expectation. Rows of cells share a blur within 1 % of their
// sigma: the slope is off by up to 0.01 x |sigma^2 w''| <= 0.012 of what the neighbourhood holds, beside the
// 6e-4 of the values' own.
TEST_P(ExpectedPaperImageDerivatives, OfErrorsEqualDifferencesOfTheRays) {
  const Vector at = ExampleVector();
  const std::vector<Jet> jets = Jets(at);
  const double peak = Largest(SlowExpectation(echoes_, sonar_, FromVector<double>(at), kAlphaDbPerM).mean);
  for (int parameter = 15; parameter < kParameters; ++parameter) {
    const double h = 1e-3 * at[parameter];
    const auto exact = [&](double step) {
      return SlowExpectation(echoes_, sonar_, FromVector<double>(at + step * Vector::Unit(parameter)),
                             kAlphaDbPerM)
          .mean;
    };
    const Grid<double> plus = exact(h);
    const Grid<double> minus = exact(-h);
    double largest = 0.0;
    for (std::size_t i = 0; i < plus.size(); ++i) {
      const double difference = (plus.values()[i] - minus.values()[i]) / 2e-3;
      ASSERT_NEAR(jets[i].v[parameter] * at[parameter], difference, 0.013 * peak)
          << "parameter " << parameter;
      largest = std::max(largest, std::abs(difference));
    }
    EXPECT_GT(largest, 0.1 * peak) << "parameter " << parameter;
  }
}

// A pixel at a clamp does not move.
TEST_P(ExpectedPaperImageDerivatives, VanishAtTheClamps) {
  Vector at = ExampleVector();
  at[2] = 101.0;  // db_max
  int clamped = 0;
  for (const Jet& jet : Jets(at)) {
    if (jet.a != 1.0) continue;
    EXPECT_TRUE(jet.v.isZero(0.0));
    ++clamped;
  }
  EXPECT_GT(clamped, 50);
}

INSTANTIATE_TEST_SUITE_P(Beams, ExpectedPaperImageDerivatives, ::testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Even" : "Uneven"; });

}  // namespace
}  // namespace sonarcal::sim
