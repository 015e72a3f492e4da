// Range and azimuth errors (Park 2024 Section 3.4) on the paper's tank, by the whole program: sampled ray by
// ray, against the moments that their law gives, and against the expected image that fits are made with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "sim/simulator.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

class NoiseOfTheTank : public ::testing::TestWithParam<JitterGrowth> {
 protected:
  NoiseOfTheTank() : simulator_(MakeMockupTank(), FindSonarPreset("p900-45").sonar, Options()) {
    parameters_.display = {.db_min = 0.0, .db_max = 600.0};  // no pixel near a clamp
    parameters_.materials["default"];
    // As `sonarcal scenes` writes them, half a range bin and three beams, but growing within the tank.
    parameters_.jitter = {.sigma_range_m = 0.0127,
                          .sigma_azimuth_deg = 0.5,
                          .reference_range_m = 5.0,
                          .reference_frequency_hz = 900e3,
                          .growth = GetParam()};
    echoes_ = simulator_.TraceEchoes(MockupTankPoses(3)[1]);
    paper_ = PaperParametersFor(parameters_, echoes_.material_names);
  }

  static SimulationOptions Options() {
    SimulationOptions options;
    options.fan = {.sampling = Sampling::kFrustum, .cols = 600, .rows = 160};
    options.water = FindSonarPreset("p900-45").water;
    options.noise = true;
    return options;
  }

  // In units of full scale, not rounded.
  Grid<float> Sample(std::uint64_t seed) const {
    return RenderPaperImage(echoes_, simulator_.sonar(), paper_, simulator_.absorption_db_per_m(),
                            {.full_scale = 1.0, .noise_seed = seed})
        .value;
  }

  SlowImage Exact() const {
    return SlowExpectation(echoes_, simulator_.sonar(), paper_, simulator_.absorption_db_per_m());
  }

  Simulator simulator_;
  ParameterSet parameters_;
  EchoList echoes_;
  PaperParameters<double> paper_;
};

// From pose to whole grey levels: frame i of a seed is frame 0 of seed + i, on one thread as on two.
TEST_P(NoiseOfTheTank, DependsOnTheSeedOnly) {
  parameters_.display = {.db_min = 150.0, .db_max = 153.0};
  const Pose pose = MockupTankPoses(1)[0];
  const auto render = [&](std::uint64_t seed, int frame) {
    SimulationOptions options = Options();
    options.seed = seed;
    return Simulator(MakeMockupTank(), simulator_.sonar(), options).Render(pose, parameters_, frame).value;
  };
  const Grid<float> one = WithThreads(1, [&] { return render(7, 0); });
  EXPECT_EQ(WithThreads(2, [&] { return render(7, 0); }), one);
  EXPECT_EQ(render(6, 1), one);
  EXPECT_NE(render(8, 0), one);
}

// Over n seeds the mean of a pixel errs by sqrt(variance / n) and its variance by
// sqrt(2 variance^2 / (n - 1) + fourth cumulant / n); z is the error found over the one expected, normal
// where many rays reach the pixel. False alarms, over some 1500 pixels: |z| > 5.5 for a mean has 4e-8 a
// pixel, 6e-5 in all. A variance over 300 seeds is skewed (a chi-square: by 0.16), which makes 5.5 to the
// high side as rare as 4.8 of a normal law: 1.2e-3 in all. The mean of z^2 is 1 to within sqrt(2 / pixels)
// for each sigma, and a little more as neighbours are correlated: 6 of them, below 1e-6.
TEST_P(NoiseOfTheTank, MeanAndVarianceOverSeedsAreThoseOfTheLaw) {
  constexpr int kSeeds = 300;
  const SlowImage exact = Exact();
  Grid<double> sum(exact.mean.rows(), exact.mean.cols());
  Grid<double> squares = sum;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Grid<float> image = Sample(5000 + seed);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double deviation = image.values()[i] - exact.mean.values()[i];
      sum.values()[i] += deviation;
      squares.values()[i] += deviation * deviation;
    }
  }
  double z_of_means = 0.0;
  double z_of_variances = 0.0;
  int pixels = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (exact.rays.values()[i] < 5.0) continue;  // 1500 over all seeds
    const double variance = exact.variance.values()[i];
    const double deviation = sum.values()[i] / kSeeds;
    const double z_mean = deviation / std::sqrt(variance / kSeeds);
    const double sampled = (squares.values()[i] - kSeeds * deviation * deviation) / (kSeeds - 1);
    const double z_variance = (sampled - variance) / std::sqrt(2.0 * variance * variance / (kSeeds - 1) +
                                                               exact.fourth.values()[i] / kSeeds);
    ASSERT_LT(std::abs(z_mean), 5.5) << "pixel " << i;
    ASSERT_LT(std::abs(z_variance), 5.5) << "pixel " << i;
    z_of_means += z_mean * z_mean;
    z_of_variances += z_variance * z_variance;
    ++pixels;
  }
  ASSERT_GT(pixels, 800);
  EXPECT_NEAR(z_of_means / pixels, 1.0, 6.0 * std::sqrt(2.0 / pixels));
  EXPECT_NEAR(z_of_variances / pixels, 1.0, 6.0 * std::sqrt(2.0 / pixels));
}

// The image that fits are made with knows of the echoes of a cell, half a bin and a beam, only how many there
// are and where they are on average. What that costs on this tank, measured: 0.29 % of the brightest pixel at
// most (errors of half a bin), 0.12 % in all but a thousandth of the pixels; it falls with larger errors. The
// mean of 100 noisy frames cannot tell it from the exact law: z^2 of the means is 1 within the 6 standard
// deviations of the test above.
TEST_P(NoiseOfTheTank, MeanOverSeedsIsTheImageThatFitsUse) {
  constexpr int kFrames = 100;
  const SlowImage exact = Exact();
  const PolarImage fitted = simulator_.RenderExpected(echoes_, parameters_);
  Grid<double> sum(exact.mean.rows(), exact.mean.cols());
  for (int seed = 0; seed < kFrames; ++seed) {
    const Grid<float> image = Sample(9000 + seed);
    for (std::size_t i = 0; i < sum.size(); ++i) sum.values()[i] += image.values()[i];
  }
  const double peak = *std::max_element(exact.mean.values().begin(), exact.mean.values().end());
  double z_of_means = 0.0;
  int pixels = 0;
  int beyond_most = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double expected = fitted.value.values()[i] / 255.0;
    const double bias = std::abs(expected - exact.mean.values()[i]) / peak;
    EXPECT_LE(bias, 0.0035) << "pixel " << i;
    beyond_most += bias > 0.0014 ? 1 : 0;
    if (exact.rays.values()[i] < 5.0) continue;
    const double z = (sum.values()[i] / kFrames - expected) / std::sqrt(exact.variance.values()[i] / kFrames);
    z_of_means += z * z;
    ++pixels;
  }
  EXPECT_LE(beyond_most, 84);  // of 84480
  EXPECT_NEAR(z_of_means / pixels, 1.0, 6.0 * std::sqrt(2.0 / pixels));
}

INSTANTIATE_TEST_SUITE_P(Growth, NoiseOfTheTank,
                         ::testing::Values(JitterGrowth::kRoot, JitterGrowth::kLinear),
                         [](const auto& tested) {
                           return tested.param == JitterGrowth::kRoot ? "Root" : "Linear";
                         });

}  // namespace
}  // namespace sonarcal::sim
