// Frames of one pose in a fit of the acoustic model: frozen speckle counts once, noise every time.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/acoustic_fit.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

constexpr int kRepeats = 5;

ParameterSet Truth(double noise_db) {
  ParameterSet truth = testing::SmallTankTruth();
  truth.model = EchoModel::kAcoustic;
  truth.receiver.noise_db = noise_db;
  truth.display = {.db_min = 60.0, .db_max = 260.0};
  return truth;
}

class Repeats : public ::testing::Test {
 protected:
  // Exponential power about the truth; `fresh` draws anew for each frame.
  std::vector<AcousticFrame> Draw(const ParameterSet& truth, int count, bool fresh) {
    const PolarAxes& axes = simulator_.sonar().axes;
    const auto pixels = static_cast<std::size_t>(axes.range_bins) * axes.beam_count();
    AcousticFrame empty{.world_from_sonar = testing::SmallTankPoses().front(),
                        .recorded = std::vector<RecordedPower>(pixels)};
    const std::vector<AcousticFrame> blank = {empty};
    const AcousticFrameModel model(simulator_, blank, truth);
    const std::vector<double> mean = model.MeanPower(0, model.initial_values());
    std::vector<AcousticFrame> frames;
    std::mt19937_64 random(3);
    for (int i = 0; i < count; ++i) {
      if (!fresh) random.seed(3);
      AcousticFrame& frame = frames.emplace_back(empty);
      frame.index = i;
      std::exponential_distribution<double> exponential;
      for (std::size_t pixel = 0; pixel < pixels; ++pixel)
        frame.recorded[pixel].power = mean[pixel] * exponential(random);
    }
    return frames;
  }

  sim::Simulator simulator_{testing::SmallTank(), testing::SmallSonar(), testing::SmallTankOptions()};
};

// Far above the noise all repeats are one frame: the same values, sigmas, curves and findings, priors and
// all. One small frame determines the curves, not their parts.
TEST_F(Repeats, RepeatsOfFrozenSpeckleDetermineNoMoreThanOneFrame) {
  const ParameterSet truth = Truth(-200.0);
  FitConfig config;
  config.free = {"materials"};
  FitOptions options;
  options.starts = 1;
  const std::vector<AcousticFrame> one = Draw(truth, 1, false);
  const std::vector<AcousticFrame> many = Draw(truth, kRepeats, false);
  const AcousticFit of_one = FitAcousticModel(simulator_, one, truth, config, options);
  const AcousticFit of_many = FitAcousticModel(simulator_, many, truth, config, options);
  ASSERT_TRUE(of_one.usable);
  ASSERT_TRUE(of_many.usable);
  int told = 0;
  for (const FittedParameter& once : of_one.report.parameters) {
    const FittedParameter* again = of_many.report.Find(once.name);
    ASSERT_NE(again, nullptr) << once.name;
    EXPECT_EQ(again->status, once.status) << once.name;
    ASSERT_EQ(again->sigma.has_value(), once.sigma.has_value()) << once.name;
    if (!once.sigma) continue;
    EXPECT_NEAR(again->value, once.value, 0.05 * *once.sigma) << once.name;
    EXPECT_NEAR(*again->sigma, *once.sigma, 0.05 * *once.sigma) << once.name;
  }
  ASSERT_EQ(of_one.report.curves.size(), 2U);
  ASSERT_EQ(of_many.report.curves.size(), 2U);
  for (std::size_t material = 0; material < 2; ++material) {
    const FittedCurve& once = of_one.report.curves[material];
    const FittedCurve& again = of_many.report.curves[material];
    ASSERT_EQ(again.backscatter_db.size(), once.backscatter_db.size());
    for (std::size_t i = 0; i < once.backscatter_db.size(); ++i) {
      if (!std::isfinite(once.sigma_db[i]) || once.incidence_deg[i] > 80.0) continue;
      ++told;
      EXPECT_NEAR(again.backscatter_db[i], once.backscatter_db[i], 0.05 * once.sigma_db[i]);
      EXPECT_NEAR(again.sigma_db[i], once.sigma_db[i], 0.05 * once.sigma_db[i]);
    }
  }
  EXPECT_GT(told, 20);
  EXPECT_NEAR(of_many.report.whitened.spread, of_one.report.whitened.spread, 1e-3);
}

TEST_F(Repeats, RepeatsOfIndependentNoiseAllCount) {
  const ParameterSet truth = Truth(250.0);
  const std::vector<AcousticFrame> frames = Draw(truth, kRepeats, true);
  AcousticFrameModel model(simulator_, frames, truth);
  PixelTerms alone;
  PixelTerms shared;
  ASSERT_TRUE(model.Evaluate(1, model.initial_values(), {}, FrameModel::Terms::kResiduals, alone));
  model.ShareRepeats(model.initial_values());
  ASSERT_TRUE(model.Evaluate(1, model.initial_values(), {}, FrameModel::Terms::kResiduals, shared));
  for (std::size_t pixel = 0; pixel < alone.residual.size(); ++pixel)
    ASSERT_NEAR(shared.residual[pixel], alone.residual[pixel], 0.02 * std::abs(alone.residual[pixel]));
}

// Echoes as strong as the noise: powers of two frames are correlated by a quarter, so that five frames are
// worth 2.5, each half of one.
TEST_F(Repeats, BetweenTheTwoByTheirCorrelation) {
  const ParameterSet truth = Truth(250.0);
  const std::vector<AcousticFrame> frames = Draw(truth, kRepeats, true);
  AcousticFrameModel model(simulator_, frames, truth);
  const std::vector<double> mean = model.MeanPower(0, model.initial_values());
  ParameterValues values = model.initial_values();
  const double noise = std::pow(10.0, 25.0);
  std::size_t brightest = 0;
  for (std::size_t pixel = 0; pixel < mean.size(); ++pixel) {
    if (mean[pixel] > mean[brightest]) brightest = pixel;
  }
  const double echo_db = 10.0 * std::log10(mean[brightest] - noise);
  ASSERT_TRUE(std::isfinite(echo_db));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (model.catalog()[i].name == "receiver.noise_db") values[i] = echo_db;
  }
  model.ShareRepeats(values);
  PixelTerms terms;
  ASSERT_TRUE(model.Evaluate(0, values, {}, FrameModel::Terms::kResiduals, terms));
  EXPECT_NEAR(terms.repeat_factor[brightest], std::sqrt(0.5), 0.01);
}

}  // namespace
}  // namespace sonarcal::calib
