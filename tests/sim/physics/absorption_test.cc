#include "sim/physics/absorption.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/physics/propagation.h"

namespace sonarcal::sim {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr Water kWaters[] = {
    {.temperature_c = 10.0, .salinity_ppt = 35.0, .ph = 8.0, .depth_m = 0.0},
    {.temperature_c = 20.0, .salinity_ppt = 35.0, .ph = 8.0, .depth_m = 0.0},
    {.temperature_c = 15.0, .salinity_ppt = 0.0, .ph = 7.0, .depth_m = 1.0},
    {.temperature_c = 4.0, .salinity_ppt = 35.0, .ph = 7.9, .depth_m = 1000.0},
};

struct TableRow {
  double khz;
  double half_digit;  // of the printed figures, dB/km
  double ainslie_mccolm[4];
  double francois_garrison[4];
};

// Evaluated independently, from the formulas as published, to 40 digits where a figure was in doubt.
constexpr TableRow kTable[] = {
    {10, 5e-5, {0.9866, 0.7532, 0.0281, 0.9942}, {0.9626, 0.7370, 0.0260, 0.9901}},
    {100, 5e-4, {34.341, 38.859, 2.811, 24.002}, {33.630, 38.059, 2.595, 24.077}},
    {450, 5e-4, {115.778, 142.544, 56.927, 105.971}, {109.663, 134.835, 52.557, 104.244}},
    {900, 5e-4, {322.309, 290.848, 227.709, 348.256}, {299.463, 274.234, 210.227, 340.498}},
    {1200, 5e-4, {535.607, 439.028, 404.817, 599.281}, {495.414, 413.787, 373.738, 585.262}},
    {3000, 5e-4, {3093.577, 2206.246, 2530.104, 3611.158}, {2845.223, 2078.723, 2335.861, 3521.998}},
};

TEST(Absorption, BothFormulasMeetTheTable) {
  for (const TableRow& row : kTable) {
    for (int water = 0; water < 4; ++water) {
      SCOPED_TRACE(fmt::format("{} kHz, water {}", row.khz, water));
      EXPECT_NEAR(1e3 * AbsorptionDbPerM(AbsorptionFormula::kAinslieMcColm, 1e3 * row.khz, kWaters[water]),
                  row.ainslie_mccolm[water], row.half_digit);
      EXPECT_NEAR(1e3 * AbsorptionDbPerM(AbsorptionFormula::kFrancoisGarrison, 1e3 * row.khz, kWaters[water]),
                  row.francois_garrison[water], row.half_digit);
    }
  }
}

// Loss of a path of 1 km, from another library's tests: +-0.5 dB as printed there.
TEST(Absorption, FallsWithDepthAsPublished) {
  const double depth_m[] = {0.0, 2000.0, 6000.0};
  const double loss_db[] = {40.0, 30.0, 16.0};
  for (int i = 0; i < 3; ++i) {
    const Water water{.temperature_c = 14.0, .salinity_ppt = 38.5, .ph = 8.1, .depth_m = depth_m[i]};
    SCOPED_TRACE(depth_m[i]);
    EXPECT_NEAR(1e3 * FrancoisGarrisonDbPerM(100e3, water), loss_db[i], 0.5);
  }
}

// Without salts only the viscosity of water is left, which grows with the square of frequency.
TEST(Absorption, FreshWaterIsViscosityAlone) {
  Water fresh = kWaters[2];
  for (const auto formula : {AbsorptionFormula::kAinslieMcColm, AbsorptionFormula::kFrancoisGarrison}) {
    const double at_100 = AbsorptionDbPerM(formula, 100e3, fresh);
    EXPECT_GT(at_100, 0.0);
    EXPECT_NEAR(AbsorptionDbPerM(formula, 900e3, fresh) / at_100, 81.0, 1e-9);
    fresh.ph = 8.2;  // acts through the salts only
    EXPECT_DOUBLE_EQ(AbsorptionDbPerM(formula, 100e3, fresh), at_100);
  }
  // 0.00049 f^2 exp(-(15/27 + 0.001/17)) dB/km at 900 kHz.
  EXPECT_NEAR(AinslieMcColmDbPerM(900e3, kWaters[2]),
              0.00049 * 810.0 * std::exp(-(15.0 / 27.0 + 0.001 / 17.0)), 1e-12);
}

// The two branches of Francois and Garrison's viscous term meet at 20 C to 0.4 %, as published.
TEST(Absorption, FrancoisGarrisonBranchesMeet) {
  const Water below{.temperature_c = 20.0, .salinity_ppt = 0.0, .ph = 7.0, .depth_m = 0.0};
  Water above = below;
  above.temperature_c = 20.0 + 1e-9;
  const double a3_below = 4.937e-4 - 2.59e-5 * 20 + 9.11e-7 * 400 - 1.50e-8 * 8000;
  const double a3_above = 3.964e-4 - 1.146e-5 * 20 + 1.45e-7 * 400 - 6.5e-10 * 8000;
  EXPECT_NEAR(FrancoisGarrisonDbPerM(1e6, below), a3_below * 1e3, 1e-9);
  EXPECT_NEAR(FrancoisGarrisonDbPerM(1e6, above), a3_above * 1e3, 1e-9);
}

constexpr auto kAuto = AbsorptionFormula::kAuto;
constexpr auto kAinslie = AbsorptionFormula::kAinslieMcColm;
constexpr auto kFrancois = AbsorptionFormula::kFrancoisGarrison;

TEST(Absorption, LimitsAreThoseOfTheAuthors) {
  const auto holds = [](AbsorptionFormula formula, double frequency_hz, const Water& water) {
    return OutsideLimits(formula, frequency_hz, water).empty();
  };
  const Water& sea = kWaters[0];
  const Water& fresh = kWaters[2];
  EXPECT_TRUE(holds(kAinslie, 900e3, sea));
  EXPECT_FALSE(holds(kAinslie, 3e6, sea));
  EXPECT_FALSE(holds(kAinslie, 900e3, fresh));
  // Above 500 kHz water dominates: neither salt nor pH matters. Below, they do.
  EXPECT_TRUE(holds(kFrancois, 900e3, fresh));
  EXPECT_TRUE(holds(kFrancois, 3e6, fresh));
  EXPECT_FALSE(holds(kFrancois, 450e3, fresh));
  EXPECT_TRUE(holds(kFrancois, 450e3, sea));
  EXPECT_FALSE(holds(kFrancois, 300.0, sea));

  const auto with = [&sea](double Water::*member, double value) {
    Water water = sea;
    water.*member = value;
    return water;
  };
  EXPECT_TRUE(holds(kFrancois, 900e3, with(&Water::depth_m, 9900.0)));
  EXPECT_FALSE(holds(kFrancois, 900e3, with(&Water::depth_m, 10100.0)));
  EXPECT_FALSE(holds(kFrancois, 450e3, with(&Water::depth_m, 3600.0)));
  EXPECT_FALSE(holds(kAinslie, 450e3, with(&Water::depth_m, 7100.0)));
  EXPECT_FALSE(holds(kFrancois, 900e3, with(&Water::salinity_ppt, 41.0)));
  EXPECT_TRUE(holds(kAinslie, 900e3, with(&Water::salinity_ppt, 41.0)));
  EXPECT_FALSE(holds(kFrancois, 900e3, with(&Water::temperature_c, 32.0)));
  EXPECT_FALSE(holds(kFrancois, 900e3, with(&Water::temperature_c, -1.0)));
  EXPECT_TRUE(holds(kFrancois, 450e3, with(&Water::temperature_c, -1.0)));
  EXPECT_TRUE(holds(kFrancois, 900e3, with(&Water::ph, 7.0)));
  EXPECT_FALSE(holds(kFrancois, 450e3, with(&Water::ph, 7.0)));
}

// Each limit in turn, everything else well inside. A value at the limit is valid, one beside it is not.
TEST(Absorption, EachLimitIsTheLastValueThatIsValid) {
  struct Limits {
    AbsorptionFormula formula;
    double frequency_hz;  // inside
    double Water::*member;
    double low;
    double high;
  };
  const Limits limits[] = {
      {kAinslie, 200e3, &Water::temperature_c, -6.0, 35.0},
      {kAinslie, 200e3, &Water::salinity_ppt, 5.0, 50.0},
      {kAinslie, 200e3, &Water::ph, 7.7, 8.3},
      {kAinslie, 200e3, &Water::depth_m, 0.0, 7000.0},
      {kFrancois, 200e3, &Water::temperature_c, -1.8, 30.0},
      {kFrancois, 200e3, &Water::salinity_ppt, 30.0, 35.0},
      {kFrancois, 200e3, &Water::ph, 7.7, 8.3},
      {kFrancois, 200e3, &Water::depth_m, 0.0, 3500.0},
      {kFrancois, 900e3, &Water::temperature_c, 0.0, 30.0},
      {kFrancois, 900e3, &Water::salinity_ppt, 0.0, 40.0},
      {kFrancois, 900e3, &Water::depth_m, 0.0, 10000.0},
  };
  const Water inside{.temperature_c = 10.0, .salinity_ppt = 33.0, .ph = 8.0, .depth_m = 100.0};
  for (const Limits& limit : limits) {
    SCOPED_TRACE(
        fmt::format("{} at {} Hz, {}..{}", NameOf(limit.formula), limit.frequency_hz, limit.low, limit.high));
    const auto faults = [&](double value) {
      Water water = inside;
      water.*limit.member = value;
      return OutsideLimits(limit.formula, limit.frequency_hz, water).size();
    };
    EXPECT_EQ(faults(limit.low), 0U);
    EXPECT_EQ(faults(limit.high), 0U);
    EXPECT_EQ(faults(limit.low - 1e-6), 1U);
    EXPECT_EQ(faults(limit.high + 1e-6), 1U);
  }
}

TEST(Absorption, LimitsOfFrequencyAreTheLastThatAreValid) {
  const Water& sea = kWaters[0];
  const auto faults = [](AbsorptionFormula formula, double frequency_hz, const Water& water) {
    return OutsideLimits(formula, frequency_hz, water).size();
  };
  EXPECT_EQ(faults(kAinslie, 100.0, sea), 0U);
  EXPECT_EQ(faults(kAinslie, 99.9, sea), 1U);
  EXPECT_EQ(faults(kAinslie, 1e6, sea), 0U);
  EXPECT_EQ(faults(kAinslie, 1.0001e6, sea), 1U);
  EXPECT_EQ(faults(kFrancois, 400.0, sea), 0U);
  EXPECT_EQ(faults(kFrancois, 399.0, sea), 1U);
  // Up to 500 kHz salts count: fresh water lacks salinity and pH.
  EXPECT_EQ(faults(kFrancois, 500e3, kWaters[2]), 2U);
  EXPECT_EQ(faults(kFrancois, 500.1e3, kWaters[2]), 0U);
  EXPECT_THAT(OutsideLimits(kAinslie, 3e6, sea),
              ::testing::ElementsAre("frequency 3000 kHz (stated range 0.1..1000)"));
}

TEST(Absorption, AutoTakesTheFormulaWhoseLimitsHold) {
  // The paper's in the sea; in fresh water and above 1 MHz the other.
  EXPECT_EQ(ResolvedAbsorption(kAuto, 900e3, kWaters[0]), kAinslie);
  EXPECT_EQ(ResolvedAbsorption(kAuto, 900e3, kWaters[2]), kFrancois);
  EXPECT_EQ(ResolvedAbsorption(kAuto, 3e6, kWaters[0]), kFrancois);
  EXPECT_EQ(AbsorptionDbPerM(kAuto, 900e3, kWaters[0]), AinslieMcColmDbPerM(900e3, kWaters[0]));
  EXPECT_EQ(AbsorptionDbPerM(kAuto, 900e3, kWaters[2]), FrancoisGarrisonDbPerM(900e3, kWaters[2]));
  EXPECT_THAT(AbsorptionCaveat(kAuto, 900e3, kWaters[0]), IsEmpty());
  EXPECT_THAT(AbsorptionCaveat(kAuto, 900e3, kWaters[2]), IsEmpty());
  EXPECT_THAT(AbsorptionCaveat(kAuto, 3e6, kWaters[2]), IsEmpty());
  EXPECT_THAT(AbsorptionStatement(kAuto, 900e3, kWaters[2]), HasSubstr("Francois-Garrison: 0.2102 dB/m"));
  EXPECT_THAT(AbsorptionStatement(kAuto, 900e3, kWaters[2]), HasSubstr("0.2277 dB/m outside its stated"));
}

TEST(Absorption, WarnsOnlyWhereNoFormulaHolds) {
  // Fresh water at 450 kHz: neither.
  const std::string none = AbsorptionCaveat(kAuto, 450e3, kWaters[2]);
  EXPECT_THAT(none, StartsWith("warning: absorption by Francois-Garrison (0.0526 dB/m)"));
  EXPECT_THAT(none, HasSubstr("salinity 0 ppt (stated range 30..35)"));
  EXPECT_THAT(none, HasSubstr("Ainslie-McColm gives 0.0569 dB/m"));
  EXPECT_THAT(none, Not(HasSubstr("frequency")));
  // A formula that was asked for, where the other would hold: a note.
  const std::string asked = AbsorptionCaveat(kAinslie, 900e3, kWaters[2]);
  EXPECT_THAT(asked, StartsWith("absorption by Ainslie-McColm (0.2277 dB/m)"));
  EXPECT_THAT(asked, HasSubstr("pH 7 (stated range 7.7..8.3)"));
  EXPECT_THAT(asked, HasSubstr("Francois-Garrison gives 0.2102 dB/m, and its range holds"));
}

TEST(SoundSpeed, MeetsPublishedCheckValues) {
  EXPECT_NEAR(MackenzieSoundSpeed(25.0, 35.0, 1000.0), 1550.744, 5e-4);
  EXPECT_NEAR(BilaniukWongSoundSpeed(15.0), 1465.9, 0.05);
  EXPECT_NEAR(BilaniukWongSoundSpeed(20.0), 1482.4, 0.05);
}

// Del Grosso and Mader, J. Acoust. Soc. Am. 52(5), 1972: another fit, on another temperature scale.
TEST(SoundSpeed, PureWaterAgreesWithAnotherFitUpTo95Degrees) {
  for (double t = 0.0; t <= 95.0; t += 5.0) {
    const double other = 1402.38754 + 5.03711129 * t - 5.80852166e-2 * std::pow(t, 2) +
                         3.34198834e-4 * std::pow(t, 3) - 1.47800417e-6 * std::pow(t, 4) +
                         3.14643091e-9 * std::pow(t, 5);
    EXPECT_NEAR(BilaniukWongSoundSpeed(t), other, 0.025) << t << " C";
  }
}

// Terms that the check value, at 35 ppt, leaves out.
TEST(SoundSpeed, MackenzieDependsOnSalinity) {
  EXPECT_NEAR(MackenzieSoundSpeed(10.0, 30.0, 0.0) - MackenzieSoundSpeed(10.0, 35.0, 0.0),
              -5.0 * (1.340 - 1.025e-2 * 10.0), 1e-9);
}

TEST(TransmissionLoss, TwoWayLossAtTenMetres) {
  EXPECT_NEAR(2.0 * TransmissionLossDb(10.0, FrancoisGarrisonDbPerM(900e3, kWaters[2])), 44.205, 5e-4);
  EXPECT_NEAR(2.0 * TransmissionLossDb(10.0, FrancoisGarrisonDbPerM(900e3, kWaters[0])), 45.989, 5e-4);
}

TEST(TransmissionLoss, SpreadsAsTheSquareOfRange) {
  EXPECT_DOUBLE_EQ(TransmissionLossDb(1.0, 0.0), 0.0);
  EXPECT_NEAR(TransmissionLossDb(2.0, 0.0), 6.0206, 5e-5);
  EXPECT_NEAR(TransmissionLossDb(4.0, 0.25) - TransmissionLossDb(4.0, 0.0), 1.0, 1e-12);
}

TEST(SonarEquation, AddsAndSubtractsAsEquation10) {
  EXPECT_DOUBLE_EQ(SonarEquationDb(200.0, 44.0, -30.0), 126.0);
  EXPECT_DOUBLE_EQ(SonarEquationDb(200.0, 44.0, -30.0, 10.0, 3.0), 119.0);
}

// All three terms at 10 ppt, as published; the table has 35 ppt and fresh water only.
TEST(Absorption, SalinityMovesTheRelaxationOfMagnesium) {
  const Water water{.temperature_c = 10.0, .salinity_ppt = 10.0, .ph = 8.0, .depth_m = 0.0};
  const double c = 1412.0 + 3.21 * 10.0 + 1.19 * 10.0;
  const double f2 = 8.17 * std::pow(10.0, 8.0 - 1990.0 / 283.0) / (1.0 - 0.0018 * 25.0);
  const double f1 = 2.8 * std::sqrt(10.0 / 35.0) * std::pow(10.0, 4.0 - 1245.0 / 283.0);
  const double magnesium = 21.44 * 10.0 / c * 1.25 * f2 * 2500.0 / (f2 * f2 + 2500.0);
  const double boric = 8.86 / c * std::pow(10.0, 1.24) * f1 * 2500.0 / (f1 * f1 + 2500.0);
  const double viscous = (4.937e-4 - 2.59e-4 + 9.11e-5 - 1.50e-5) * 2500.0;
  EXPECT_NEAR(1e3 * FrancoisGarrisonDbPerM(50e3, water), magnesium + boric + viscous, 1e-9);
}

}  // namespace
}  // namespace sonarcal::sim
