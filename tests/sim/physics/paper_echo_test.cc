#include "sim/physics/paper_echo.h"

#include <gtest/gtest.h>

#include "core/types/error.h"

namespace sonarcal::sim {
namespace {

// SNR = 200 - 44 - 30 - 60 + 4 = 70 dB, on a display of 50 .. 90 dB.
TEST(PaperEchoTest, LevelIsScaledBetweenTheLimitsOfTheDisplay) {
  PaperParameters<double> paper;
  paper.source_level_db = 200.0;
  paper.noise_level_db = 60.0;
  paper.array_gain_db = 4.0;
  paper.display = {.db_min = 50.0, .db_max = 90.0};
  EXPECT_NEAR(NormalisedPaperEcho(paper, 44.0, -30.0), 0.5, 1e-12);
  EXPECT_NEAR(NormalisedPaperEcho(paper, 84.0, -30.0), -0.5, 1e-12) << "not clamped";
}

TEST(PaperEchoTest, MaterialsFollowTheNamesOfTheScene) {
  ParameterSet parameters;
  parameters.source_level_db = 190.0;
  parameters.noise_level_db = 3.0;
  parameters.array_gain_db = 5.0;
  parameters.materials["mud"].gsab.a = 0.1;
  parameters.materials["sand"].gsab.a = 0.2;
  const PaperParameters<double> paper = PaperParametersFor(parameters, {"sand", "mud", "sand"});
  ASSERT_EQ(paper.materials.size(), 3U);
  EXPECT_EQ(paper.materials[0].a, 0.2);
  EXPECT_EQ(paper.materials[1].a, 0.1);
  EXPECT_EQ(paper.materials[2].a, 0.2);
  EXPECT_EQ(paper.source_level_db, 190.0);
  EXPECT_EQ(paper.noise_level_db, 3.0);
  EXPECT_EQ(paper.array_gain_db, 5.0);
  EXPECT_THROW(PaperParametersFor(parameters, {"rock"}), DataError);
}

}  // namespace
}  // namespace sonarcal::sim
