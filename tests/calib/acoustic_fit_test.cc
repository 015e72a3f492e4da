// Costs and start values of fits of the acoustic model, on SYNTHETIC pixels.
#include "calib/acoustic_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calib/problem_builder.h"
#include "core/types/error.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

// The start is off the centre of the prior by ln 1.3 / 0.2 of its sigmas.
TEST(AcousticFitTest, TheInitialCostIsThatOfTheStartWithPriorsWhateverIsFree) {
  sim::SimulationOptions options = testing::SmallTankOptions();
  options.noise = true;
  const sim::Simulator simulator(testing::SmallTank(), testing::SmallSonar(), options);
  ParameterSet truth = testing::SmallTankAcousticTruth();
  truth.pulse.length_m = 0.05;
  const Pose pose = testing::SmallTankPoses().front();
  const std::vector<AcousticFrame> frames = {
      {.index = 0,
       .world_from_sonar = pose,
       .recorded = RecordedPowers(simulator.Render(pose, truth), truth.display)}};
  ParameterSet initial = truth;
  initial.pulse.length_m = 1.3 * truth.pulse.length_m;
  const AcousticFrameModel model(simulator, frames, initial);
  const double of_start = CostAt(model, model.initial_values(), 1);
  const double of_prior = 0.5 * std::pow(std::log(1.3) / 0.2, 2);
  const std::vector<std::vector<std::string>> free = {{"pulse.length_m"},
                                                      {"pulse.length_m", "receiver.noise_db"}};
  for (const std::vector<std::string>& names : free) {
    FitConfig config{.free = names};
    config.priors["pulse.length_m"] = std::pair{truth.pulse.length_m, 0.2 * truth.pulse.length_m};
    FitOptions fit_options;
    fit_options.starts = 1;
    fit_options.near_start = true;
    fit_options.standard_errors = false;
    const AcousticFit fit = FitAcousticModel(simulator, frames, initial, config, fit_options);
    ASSERT_TRUE(fit.usable);
    EXPECT_NEAR(fit.report.cost_initial, of_start + of_prior, 1e-6 * of_start) << names.size();
    EXPECT_LT(fit.report.cost_final, fit.report.cost_initial) << names.size();
  }
}

// Exponential power of mean 1, by quantiles.
AcousticFrame NoiseAlone(int pixels) {
  AcousticFrame frame;
  for (int i = 0; i < pixels; ++i)
    frame.recorded.push_back({.power = -std::log1p(-(i + 0.5) / pixels), .censoring = Censoring::kNone});
  return frame;
}

double NoiseStartDb(const AcousticFrame& frame) {
  return *WithNoiseStart({}, {frame}).receiver.noise_db;
}

TEST(WithNoiseStartTest, IsTheMeanOfNoiseOfWhichASoftDisplayHidesAnyPart) {
  for (const int hidden : {0, 10, 20, 60, 90}) {
    AcousticFrame frame = NoiseAlone(100);
    for (int i = 0; i < hidden; ++i) frame.recorded[i] = {.power = 0.0, .censoring = Censoring::kAtMost};
    EXPECT_NEAR(NoiseStartDb(frame), 0.0, 0.3) << hidden;
  }
}

TEST(WithNoiseStartTest, LeavesOutPixelsThatAreNotUsed) {
  AcousticFrame frame = NoiseAlone(100);
  const double alone_db = NoiseStartDb(frame);
  frame.use.assign(100, 1);
  for (int i = 0; i < 100; ++i) {
    frame.recorded.push_back({.power = 1e-6, .censoring = Censoring::kNone});
    frame.use.push_back(0);
  }
  EXPECT_EQ(NoiseStartDb(frame), alone_db);
}

TEST(WithNoiseStartTest, RefusesFramesWithoutPower) {
  AcousticFrame frame = NoiseAlone(3);
  frame.use = {0, 0, 0};
  EXPECT_THROW(NoiseStartDb(frame), DataError);
  frame.use = {1, 1, 1};
  for (RecordedPower& recorded : frame.recorded) recorded.power = 0.0;
  EXPECT_THROW(NoiseStartDb(frame), DataError);
}

}  // namespace
}  // namespace sonarcal::calib
