// Pitch and the slope of the floor's curve over range hang together: poses that look too low, with curves
// fitted to them, lie in a valley. The recording is SYNTHETIC, made by another kind of simulation.
#include "calib/joint_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/acoustic_fit.h"
#include "calib/fit.h"
#include "calib/parameters/pose_step.h"
#include "calib/problem_builder.h"
#include "tests/calib/synthetic_tank.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

// Frames at their true poses, except that their pitch is off by this.
std::vector<AcousticFrame> Pitched(const testing::SyntheticTank& tank, const std::vector<int>& indices,
                                   double off_deg) {
  std::vector<AcousticFrame> frames = tank.Frames(indices);
  PoseStep off = PoseStep::Zero();
  off(4) = off_deg;
  for (AcousticFrame& frame : frames) frame.world_from_sonar = MovePose(tank.TruePose(frame.index), off);
  return frames;
}

// Gives the entries of the catalog their priors, and returns those that the configuration frees.
std::vector<int> FreeEntries(const AcousticFrameModel& model, FitConfig& config,
                             std::vector<CatalogEntry>& catalog) {
  const std::vector<bool> free = ApplyFitConfigWithPriors(model.initial_values(), config, catalog);
  std::vector<int> active;
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i]) active.push_back(static_cast<int>(i));
  }
  return active;
}

TEST(JointSteps, GoDownTheValleyOfPitchAndCurves) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_poses");
  constexpr double kTooLowDeg = -0.4;
  const testing::SyntheticTank tank(folder);
  const std::vector<AcousticFrame> frames = Pitched(tank, {0, 1, 3}, kTooLowDeg);
  ParameterSet initial = WithNoiseStart(tank.known, frames);
  AcousticFrameModel model(tank.simulator, frames, initial);

  FitConfig config{.free = std::vector<std::string>{"materials", "noise", "pose"},
                   .pose_prior = {.position_m = 0.02, .angle_deg = 1.0}};
  std::vector<CatalogEntry> catalog = model.catalog();
  const std::vector<int> active = FreeEntries(model, config, catalog);
  FitConfig curves = config;
  curves.fixed = {"pose.*"};
  FitOptions options;
  options.starts = 1;
  options.rough = true;
  const auto settle = [&](ParameterValues& values) { values = Fit(model, values, curves, options).values; };

  ParameterValues values = model.initial_values();
  settle(values);
  settle(values);
  const double cost = CostAt(model, values, model.frame_count());
  const auto traced = [&](const ParameterValues& at) {
    return model.TracedCost(at, tank.simulator.options().fan);
  };
  const auto roughness = [](const ParameterValues&) { return 17.0; };
  TakeJointSteps(model, catalog, active,
                 {.steps = 6, .least = 5.0, .cost = traced, .roughness = roughness, .settle = settle},
                 values);
  model.Linearise(values, {});
  EXPECT_LT(CostAt(model, values, model.frame_count()), cost - 50.0);

  double mean_deg = 0.0;
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    const PoseStep off = StepBetween(tank.TruePose(model.frame_index(frame)), model.PoseOf(frame, values));
    mean_deg += off(4) / model.frame_count();
    EXPECT_LT(off.head<3>().norm(), 0.01) << "metres, of frame " << model.frame_index(frame);
  }
  // What three such frames tell of the pitch that they share has a sigma of 0.08 degrees.
  EXPECT_NEAR(mean_deg, 0.0, 0.2);
}

// The prior of a term that contributes nothing lies orders of magnitude away. A step all the way there would
// raise the cost, and the pose would move by a third of its error only.
TEST(JointSteps, MoveThePoseBesideATermThatContributesNothing) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_poses");
  const testing::SyntheticTank tank(folder);
  const std::vector<AcousticFrame> frames = Pitched(tank, {0}, -0.5);
  AcousticFrameModel model(tank.simulator, frames, tank.TrueParameters());
  FitConfig config{.free = std::vector<std::string>{"pose", "material.floor.gsab.A"},
                   .priors = {{"material.floor.gsab.A", std::pair{5.0, 5.0}}},
                   .start = {{"material.floor.gsab.A", 1e-5}}};
  std::vector<CatalogEntry> catalog = model.catalog();
  const std::vector<int> active = FreeEntries(model, config, catalog);
  ParameterValues values = StartValues(config, catalog, model.initial_values());
  const auto traced = [&](const ParameterValues& at) {
    return model.TracedCost(at, tank.simulator.options().fan);
  };
  const auto roughness = [](const ParameterValues&) { return 17.0; };
  TakeJointSteps(model, catalog, active, {.steps = 1, .least = 1.0, .cost = traced, .roughness = roughness},
                 values);
  EXPECT_NEAR(StepBetween(tank.TruePose(0), model.PoseOf(0, values))(4), 0.0, 0.2) << "degrees";
}

TEST(JointSteps, LeaveOutARefitThatRaisesTheCost) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_poses");
  const testing::SyntheticTank tank(folder);
  const std::vector<AcousticFrame> frames = Pitched(tank, {0}, -0.5);
  AcousticFrameModel model(tank.simulator, frames, tank.TrueParameters());
  FitConfig config{.free = std::vector<std::string>{"noise", "pose"}};
  std::vector<CatalogEntry> catalog = model.catalog();
  const std::vector<int> active = FreeEntries(model, config, catalog);
  const auto noise = static_cast<std::size_t>(
      std::ranges::find(catalog, "receiver.noise_db", &CatalogEntry::name) - catalog.begin());
  ASSERT_LT(noise, catalog.size());

  const auto traced = [&](const ParameterValues& at) {
    return model.TracedCost(at, tank.simulator.options().fan);
  };
  int refits = 0;
  const auto spoil = [&](ParameterValues& at) {
    ++refits;
    at[noise] += 12.0;
  };
  const auto roughness = [](const ParameterValues&) { return 17.0; };
  // The search ends with the refit after its first step, because no other step gains so much.
  constexpr double kLeast = 1e9;
  ParameterValues values = model.initial_values();
  TakeJointSteps(model, catalog, active,
                 {.steps = 2, .least = kLeast, .cost = traced, .roughness = roughness, .settle = spoil},
                 values);
  EXPECT_EQ(refits, 1);
  EXPECT_LT(traced(values), traced(model.initial_values()) - 50.0);
}

}  // namespace
}  // namespace sonarcal::calib
