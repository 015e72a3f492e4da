#include "sim/paper/paper_values.h"

#include <gtest/gtest.h>

#include "sim/physics/absorption.h"
#include "sim/physics/propagation.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::sim {
namespace {

TEST(PaperValues, AreTablesFourAndFiveWithTheRuleForTheRest) {
  const ParameterSet values = PaperValues(FindSonarPreset("p900-45").sonar, {"floor", "wall"});
  EXPECT_EQ(values.model, EchoModel::kPaper);
  EXPECT_EQ(values.source_level_db, 200.0);
  EXPECT_EQ(values.display.db_min, 150.0);
  EXPECT_EQ(values.display.db_max, 153.0);
  EXPECT_NEAR(values.jitter.sigma_range_m, 0.0127, 1e-12);  // half of 2.54 cm
  EXPECT_NEAR(values.jitter.sigma_azimuth_deg, 0.5, 1e-12);
  ASSERT_EQ(values.materials.size(), 2U);
  const GsabParameters<double> table4{90.0, 4.0, 100.0, 1.0, 90.0, 8.0};
  EXPECT_EQ(values.Material("wall").gsab, table4);
}

TEST(PaperValues, ATargetOfZeroDecibelsIsBlackBeyondThePapersWindow) {
  const SonarPreset& preset = FindSonarPreset("p900-45");
  const double alpha =
      AbsorptionDbPerM(AbsorptionFormula::kAinslieMcColm, preset.sonar.frequency_hz, preset.water);
  const auto shown = [&](double range_m) {
    return kPaperSourceLevelDb - 2.0 * TransmissionLossDb(range_m, alpha) > PaperDisplay().db_min;
  };
  EXPECT_TRUE(shown(preset.sonar.axes.range_max_m));
  EXPECT_TRUE(shown(12.6));
  EXPECT_FALSE(shown(12.8));
}

}  // namespace
}  // namespace sonarcal::sim
