#include "sim/physics/absorption.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/physics/propagation.h"

namespace sonarcal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

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

TEST(Absorption, CaveatNamesWhatIsOutsideAndTheSpread) {
  for (const auto formula : {AbsorptionFormula::kAinslieMcColm, AbsorptionFormula::kFrancoisGarrison}) {
    EXPECT_THAT(AbsorptionCaveat(formula, 900e3, kWaters[0]), IsEmpty());
    EXPECT_THAT(AbsorptionCaveat(formula, 900e3, kWaters[3]), IsEmpty());

    const std::string fresh = AbsorptionCaveat(formula, 900e3, kWaters[2]);
    EXPECT_THAT(fresh, HasSubstr("salinity 0 ppt"));
    EXPECT_THAT(fresh, HasSubstr("pH 7"));
    EXPECT_THAT(fresh, HasSubstr("0.2277 dB/m"));  // the table's two figures
    EXPECT_THAT(fresh, HasSubstr("0.2102 dB/m"));
    EXPECT_THAT(fresh, Not(HasSubstr("frequency")));

    const std::string fast = AbsorptionCaveat(formula, 3e6, kWaters[0]);
    EXPECT_THAT(fast, HasSubstr("frequency 3000 kHz"));
    EXPECT_THAT(fast, Not(HasSubstr("salinity")));
  }
}

TEST(Absorption, CaveatKnowsEachAuthorsLimits) {
  const Water brackish{.temperature_c = 10.0, .salinity_ppt = 10.0, .ph = 8.0, .depth_m = 0.0};
  EXPECT_THAT(AbsorptionCaveat(AbsorptionFormula::kAinslieMcColm, 900e3, brackish), IsEmpty());
  EXPECT_THAT(AbsorptionCaveat(AbsorptionFormula::kFrancoisGarrison, 900e3, brackish), HasSubstr("salinity"));
  Water deep = kWaters[0];
  deep.depth_m = 5000.0;
  EXPECT_THAT(AbsorptionCaveat(AbsorptionFormula::kAinslieMcColm, 900e3, deep), IsEmpty());
  EXPECT_THAT(AbsorptionCaveat(AbsorptionFormula::kFrancoisGarrison, 900e3, deep), HasSubstr("depth"));
  Water warm = kWaters[0];
  warm.temperature_c = 32.0;
  EXPECT_THAT(AbsorptionCaveat(AbsorptionFormula::kAinslieMcColm, 900e3, warm), IsEmpty());
  EXPECT_THAT(AbsorptionCaveat(AbsorptionFormula::kFrancoisGarrison, 900e3, warm), HasSubstr("temperature"));
}

TEST(SoundSpeed, MeetsPublishedCheckValues) {
  EXPECT_NEAR(MackenzieSoundSpeed(25.0, 35.0, 1000.0), 1550.744, 5e-4);
  EXPECT_NEAR(BilaniukWongSoundSpeed(15.0), 1465.9, 0.05);
  EXPECT_NEAR(BilaniukWongSoundSpeed(20.0), 1482.4, 0.05);
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

}  // namespace
}  // namespace sonarcal
