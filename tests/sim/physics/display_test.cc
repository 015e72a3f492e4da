#include "sim/physics/display.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

std::vector<DisplayParameters<double>> EachLaw() {
  return {{.db_min = 40.0, .db_max = 120.0},
          {.db_min = 10.0, .db_max = 74.0, .law = DisplayLaw::kSoftLog, .soft_db = 8.0},
          {.db_min = 0.0, .db_max = 60.0, .law = DisplayLaw::kPower, .exponent = 0.498},
          {.db_min = 10.0, .db_max = 74.0, .law = DisplayLaw::kSoftAmplitude, .soft_db = 8.0}};
}

TEST(DisplayTest, LogRunsFromMinimumToMaximum) {
  const DisplayParameters<double> display{.db_min = 40.0, .db_max = 120.0};
  EXPECT_DOUBLE_EQ(LogDisplay(display, 40.0), 0.0);
  EXPECT_DOUBLE_EQ(LogDisplay(display, 60.0), 0.25);
  EXPECT_DOUBLE_EQ(LogDisplay(display, 200.0), 2.0);  // clipped later
  EXPECT_NEAR(DisplayValue(display, 1e6), 0.25, 1e-14);
  EXPECT_TRUE(std::isfinite(DisplayValue(display, 0.0)));
}

TEST(DisplayTest, SoftLogHasAFloorAndIsALogarithmFarAboveIt) {
  const DisplayParameters<double> soft = EachLaw()[1];
  EXPECT_NEAR(DisplayValue(soft, 0.0), (8.0 - 10.0) / 64.0, 1e-14);
  EXPECT_NEAR(DisplayValue(soft, PowerFromDb(8.0)), (8.0 + 10.0 * std::log10(2.0) - 10.0) / 64.0, 1e-14);
  EXPECT_NEAR(DisplayValue(soft, 1e9), LogDisplay(soft, 90.0), 1e-9);
  EXPECT_EQ(PowerFromDisplay(soft, -2.0 / 64.0 - 1e-9), 0.0);  // no power is shown below the soft floor
}

TEST(DisplayTest, SoftAmplitudeAddsBeforeTheLogarithmIsTaken) {
  const DisplayParameters<double> soft = EachLaw()[3];
  EXPECT_NEAR(DisplayValue(soft, 0.0), (8.0 - 10.0) / 64.0, 1e-14);
  // An amplitude as large as the one added doubles it.
  EXPECT_NEAR(DisplayValue(soft, PowerFromDb(8.0)), (8.0 + 20.0 * std::log10(2.0) - 10.0) / 64.0, 1e-14);
  EXPECT_NEAR(DisplayValue(soft, 1e14), LogDisplay(soft, 140.0), 1e-6);
  EXPECT_EQ(PowerFromDisplay(soft, -2.0 / 64.0 - 1e-9), 0.0);
}

TEST(DisplayTest, PowerLawIsAPowerOfTheAmplitude) {
  const DisplayParameters<double> power = EachLaw()[2];
  EXPECT_NEAR(DisplayValue(power, 1e6), 1.0, 1e-12);
  EXPECT_NEAR(DisplayValue(power, 1e4), std::pow(0.1, 0.498), 1e-12);  // amplitude a tenth
  EXPECT_EQ(PowerFromDisplay(power, 0.0), 0.0);
}

TEST(DisplayTest, InverseAndSlopeAreThoseOfEachLaw) {
  for (const DisplayParameters<double>& display : EachLaw()) {
    for (const double level_db : {12.0, 25.0, 50.0, 80.0}) {
      const double power = PowerFromDb(level_db);
      const double value = DisplayValue(display, power);
      EXPECT_NEAR(PowerFromDisplay(display, value) / power, 1.0, 1e-10);
      const double step = 1e-5 * power;
      const double difference =
          (DisplayValue(display, power + step) - DisplayValue(display, power - step)) / (2.0 * step);
      EXPECT_NEAR(DisplaySlope(display, power) / difference, 1.0, 1e-6);
    }
  }
}

TEST(DisplayTest, DerivativesPassThroughEachLaw) {
  using Jet = ceres::Jet<double, 3>;
  for (const DisplayParameters<double>& display : EachLaw()) {
    const DisplayParameters<Jet> jets{.db_min = Jet(display.db_min, 0),
                                      .db_max = Jet(display.db_max, 1),
                                      .law = display.law,
                                      .soft_db = display.soft_db,
                                      .exponent = display.exponent};
    const double power = PowerFromDb(33.0);
    const Jet value = DisplayValue(jets, Jet(power, 2));
    EXPECT_NEAR(value.a, DisplayValue(display, power), 1e-14);
    EXPECT_NEAR(value.v[2], DisplaySlope(display, power), 1e-12);
    DisplayParameters<double> moved = display;
    moved.db_max += 1e-5;
    EXPECT_NEAR(value.v[1], (DisplayValue(moved, power) - DisplayValue(display, power)) / 1e-5, 1e-7);
    EXPECT_NEAR(PowerFromDisplay(jets, value).v[2], 1.0, 1e-10);  // dP/dP
    EXPECT_NEAR(PowerFromDisplay(jets, value).v[1], 0.0, 1e-8 * power);
  }
}

// A soft display at 0 dB: 10 log10(P + 1) or 20 log10(sqrt(P) + 1) over 20 dB. Below its own level it shows
// no power.
TEST(DisplayTest, SoftLawsShowPowerBelowOneAndNoneBelowTheirLevel) {
  for (const DisplayLaw law : {DisplayLaw::kSoftLog, DisplayLaw::kSoftAmplitude}) {
    const DisplayParameters<double> display{.db_min = -10.0, .db_max = 10.0, .law = law, .soft_db = 0.0};
    const double shown_db = law == DisplayLaw::kSoftLog ? 10.0 * std::log10(1.25) : 20.0 * std::log10(1.5);
    EXPECT_NEAR(PowerFromDisplay(display, (shown_db + 10.0) / 20.0), 0.25, 1e-12);
    EXPECT_EQ(PowerFromDisplay(display, 0.4), 0.0);
  }
}

}  // namespace
}  // namespace sonarcal::sim
