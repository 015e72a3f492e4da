#include "sim/sonar_presets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/ray_fan.h"

namespace sonarcal {
namespace {

using ::testing::HasSubstr;

// Park 2024, Tables 4 and 5.
TEST(SonarPresets, P900IsThatOfThePaper) {
  const SonarPreset& preset = FindSonarPreset("p900-45");
  const SonarModel& sonar = preset.sonar;
  EXPECT_EQ(sonar.frequency_hz, 900e3);
  EXPECT_EQ(sonar.axes.range_min_m, 0.62);
  EXPECT_EQ(sonar.axes.range_max_m, 9.0);
  EXPECT_NEAR(sonar.axes.range_bin_m(), 0.0254, 0.00005);
  ASSERT_EQ(sonar.axes.beam_count(), 256);
  for (int beam = 1; beam < 256; ++beam) {
    EXPECT_NEAR(DegFromRad(sonar.axes.beam_azimuth_rad[beam] - sonar.axes.beam_azimuth_rad[beam - 1]), 0.18,
                1e-12);
  }
  EXPECT_NEAR(sonar.axes.beam_azimuth_rad.front(), -sonar.axes.beam_azimuth_rad.back(), 1e-12);
  // 256 beams of 0.18 degrees cover 46.08 degrees; "45" is the nominal field of view.
  EXPECT_NEAR(DegFromRad(sonar.axes.beam_azimuth_rad.back()), 22.95, 1e-9);
  EXPECT_EQ(sonar.azimuth_beam_width_deg, 1.0);
  EXPECT_EQ(sonar.elevation_beam_width_deg, 20.0);
  EXPECT_NEAR(sonar.sound_speed_m_per_s, 1465.94, 0.01);
  EXPECT_EQ(preset.water, (Water{.temperature_c = 15.0, .salinity_ppt = 0.5, .ph = 7.0, .depth_m = 1.0}));
}

TEST(SonarPresets, Aris3000HasItsOwnBeams) {
  const SonarPreset& preset = FindSonarPreset("aris3000");
  const SonarModel& sonar = preset.sonar;
  EXPECT_EQ(sonar.frequency_hz, 3.0e6);
  EXPECT_EQ(sonar.axes.range_min_m, 0.690);
  EXPECT_EQ(sonar.axes.range_max_m, 2.998);
  EXPECT_EQ(sonar.axes.range_bins, 780);
  EXPECT_NEAR(1e3 * sonar.axes.range_bin_m(), 2.96, 0.005);
  EXPECT_NEAR(sonar.axes.range_min_m / sonar.axes.range_max_m, 0.2300, 2e-4);
  ASSERT_EQ(sonar.axes.beam_count(), 128);
  // The maker counts from the right, angles to the left: its last beam, +15.0156, is our leftmost.
  EXPECT_NEAR(DegFromRad(sonar.axes.beam_azimuth_rad.front()), -15.0156, 1e-9);
  EXPECT_NEAR(DegFromRad(sonar.axes.beam_azimuth_rad.back()), 15.0068, 1e-9);
  EXPECT_NEAR(DegFromRad(sonar.axes.BeamEdgesRad().back() - sonar.axes.BeamEdgesRad().front()), 30.0, 0.5);
  EXPECT_EQ(sonar.azimuth_beam_width_deg, 0.25);
  EXPECT_EQ(sonar.elevation_beam_width_deg, 15.0);
  EXPECT_THAT(std::string(preset.source), HasSubstr("assumed"));
}

TEST(SonarPresets, AllCanBeSampledBothWays) {
  for (const SonarPreset& preset : SonarPresets()) {
    EXPECT_FALSE(preset.source.empty());
    EXPECT_GT(preset.sonar.sound_speed_m_per_s, 1400.0);
    for (const Sampling sampling : {Sampling::kFrustum, Sampling::kBeams}) {
      EXPECT_NO_THROW(RayFan(preset.sonar, {.sampling = sampling, .cols = 300, .rows = 20})) << preset.name;
    }
  }
}

TEST(SonarPresets, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  EXPECT_THAT([] { FindSonarPreset("p901"); },
              ::testing::ThrowsMessage<UsageError>(
                  ::testing::AllOf(HasSubstr("'p901'"), HasSubstr("p900-45"), HasSubstr("aris3000"))));
}

}  // namespace
}  // namespace sonarcal
