// Fits to SYNTHETIC frames whose display shows powers down to nothing.
#include <gtest/gtest.h>

#include "calib/acoustic_fit.h"
#include "calib/selection/held_out_likelihood.h"
#include "sim/physics/display.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

class SoftDisplayTest : public ::testing::Test {
 protected:
  // The soft level lies at the display's lower end, or above: no power is shown as 0.
  static ParameterSet Truth(DisplayLaw law) {
    ParameterSet truth = testing::SmallTankAcousticTruth();
    truth.display = {.db_min = 116.0, .db_max = 160.0, .law = law, .soft_db = 116.05};
    truth.pulse.length_m = 0.05;
    return truth;
  }

  static AcousticFit FitTo(const ParameterSet& truth, double looks) {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.bits = 8;
    options.noise = true;
    options.seed = 5;
    const sim::Simulator simulator(testing::SmallTank(), testing::SmallSonar(), options);
    std::vector<GreyFrame> recorded;
    for (const Pose& pose : testing::SmallTankPoses()) {
      const int index = static_cast<int>(recorded.size());
      recorded.push_back(
          {.index = index, .world_from_sonar = pose, .image = simulator.Render(pose, truth, index)});
    }
    ParameterSet start = truth;
    start.receiver.looks = looks;
    start.receiver.noise_db = *truth.receiver.noise_db + 2.0;
    for (auto& [name, material] : start.materials) material.gsab.c *= 1.5;
    FitOptions fit;
    fit.starts = 1;
    return FitAcousticModel(
        simulator, FramesFor(recorded, truth.display), start,
        {.free = std::vector<std::string>{"materials", "receiver.noise_db", "pulse.length_m"}}, fit);
  }
};

// The information of one look is counted by the fast path, that of any other number of looks by the slow one
// (calib/models/pixel_math.h): a hair beside one look it must be the same.
TEST_F(SoftDisplayTest, TheFastPathGivesTheStandardErrorsOfTheSlowOne) {
  for (const DisplayLaw law : {DisplayLaw::kSoftLog, DisplayLaw::kSoftAmplitude}) {
    const ParameterSet truth = Truth(law);
    ASSERT_EQ(sim::PowerFromDisplay(truth.display, 0.0), 0.0);
    const AcousticFit fast = FitTo(truth, 1.0);
    const AcousticFit slow = FitTo(truth, 1.0 + 1e-9);
    ASSERT_TRUE(fast.usable && slow.usable);
    ASSERT_EQ(fast.report.parameters.size(), slow.report.parameters.size());
    int fitted = 0;
    for (std::size_t i = 0; i < fast.report.parameters.size(); ++i) {
      const FittedParameter& a = fast.report.parameters[i];
      const FittedParameter& b = slow.report.parameters[i];
      EXPECT_EQ(a.status, b.status) << a.name;
      EXPECT_EQ(a.sigma.has_value(), b.sigma.has_value()) << a.name;
      if (!a.sigma || !b.sigma) continue;
      ++fitted;
      EXPECT_NEAR(*a.sigma, *b.sigma, 0.01 * *b.sigma) << a.name;
      EXPECT_NEAR(a.value, b.value, 0.05 * *b.sigma) << a.name;
    }
    EXPECT_GE(fitted, 6);
    EXPECT_NEAR(*fast.parameters.receiver.noise_db, *truth.receiver.noise_db, 0.3);
    EXPECT_NEAR(fast.parameters.pulse.length_m, truth.pulse.length_m, 0.005);
  }
}

// Grey levels below the least that a display shows: they hold what lies below it, or tell nothing.
TEST_F(SoftDisplayTest, LevelsThatShowNoPowerAreAtMostWhatRoundsToThem) {
  const DisplayParameters<double> display{
      .db_min = 100.0, .db_max = 151.0, .law = DisplayLaw::kSoftLog, .soft_db = 102.06};
  PolarImage image{
      testing::SmallSonar().axes,
      {.quantity = Quantity::kGrey, .full_scale = 255.0, .db_min = {}, .db_max = {}, .db_span = {}},
      Grid<float>(160, 48)};
  // The least shown is 10.3 grey levels.
  for (int level = 0; level < 48; ++level) image.value(0, level) = static_cast<float>(level);
  const std::vector<RecordedPower> recorded = RecordedPowers(image, display);
  for (int level = 0; level < 48; ++level) {
    const RecordedPower& of = recorded[level];
    EXPECT_EQ(of.censoring, level <= 10 ? Censoring::kAtMost : Censoring::kNone) << level;
    EXPECT_EQ(of.power > 0.0, level >= 10) << level;
  }
}

}  // namespace
}  // namespace sonarcal::calib
