#include "sim/scenes/sonar_presets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/absorption.h"
#include "sim/rays/ray_fan.h"

namespace sonarcal::sim {
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
  EXPECT_THAT(std::string(preset.assumed), HasSubstr("beam width"));
}

TEST(SonarPresets, AllCanBeSampledBothWays) {
  for (const SonarPreset& preset : SonarPresets()) {
    EXPECT_FALSE(preset.source.empty());
    EXPECT_FALSE(preset.assumed.empty());
    EXPECT_NE(preset.sonar.beam_forming, BeamForming::kUnknown) << preset.name;
    EXPECT_GT(preset.sonar.sound_speed_m_per_s, 1400.0);
    for (const Sampling sampling : {Sampling::kFrustum, Sampling::kBeams}) {
      EXPECT_NO_THROW(RayFan(preset.sonar, {.sampling = sampling, .cols = 300, .rows = 20})) << preset.name;
    }
  }
}

struct Expected {
  const char* name;
  double frequency_hz;
  int beams;
  double field_deg;
  double azimuth_width_deg;
  double elevation_width_deg;
  BeamForming forming;
};

// model.md, section 6; a width of 0: assumed, not from a source.
constexpr Expected kExpected[] = {
    {"p900-45", 900e3, 256, 46.08, 1.0, 20.0, BeamForming::kArray},
    {"didson-1.8", 1.8e6, 96, 28.8, 0.3, 14.0, BeamForming::kLens},
    {"didson-1.1", 1.1e6, 48, 28.8, 0.4, 14.0, BeamForming::kLens},
    {"aris1200-1.2", 1.2e6, 48, 28.0, 0.0, 14.0, BeamForming::kLens},
    {"aris1200-0.7", 0.7e6, 48, 28.0, 0.0, 14.0, BeamForming::kLens},
    {"aris1800-1.8", 1.8e6, 96, 28.0, 0.0, 14.0, BeamForming::kLens},
    {"aris1800-1.1", 1.1e6, 48, 28.0, 0.0, 14.0, BeamForming::kLens},
    {"aris3000", 3.0e6, 128, 30.0, 0.0, 15.0, BeamForming::kLens},
    {"aris3000-1.8", 1.8e6, 64, 30.0, 0.0, 15.0, BeamForming::kLens},
    {"oculus-m750d-0.75", 0.75e6, 512, 130.0, 1.0, 20.0, BeamForming::kArray},
    {"oculus-m750d-1.2", 1.2e6, 512, 130.0, 0.6, 20.0, BeamForming::kArray},
    {"oculus-m1200d-1.2", 1.2e6, 512, 130.0, 0.6, 20.0, BeamForming::kArray},
    {"oculus-m1200d-2.1", 2.1e6, 512, 60.0, 0.4, 12.0, BeamForming::kArray},
    {"oculus-m3000d-1.2", 1.2e6, 512, 130.0, 0.6, 20.0, BeamForming::kArray},
    {"oculus-m3000d-3.0", 3.0e6, 512, 40.0, 0.25, 20.0, BeamForming::kArray},
    {"gemini-720is", 0.72e6, 512, 120.0, 1.0, 20.0, BeamForming::kArray},
};

TEST(SonarPresets, HaveTheFiguresOfTheirDataSheets) {
  ASSERT_EQ(SonarPresets().size(), std::size(kExpected));
  for (const Expected& expected : kExpected) {
    SCOPED_TRACE(expected.name);
    const SonarModel& sonar = FindSonarPreset(expected.name).sonar;
    EXPECT_EQ(sonar.frequency_hz, expected.frequency_hz);
    EXPECT_EQ(sonar.axes.beam_count(), expected.beams);
    const std::vector<double> edges_rad = sonar.axes.BeamEdgesRad();
    // The maker's tables of ARIS beams reach a little beyond the nominal field.
    EXPECT_NEAR(DegFromRad(edges_rad.back() - edges_rad.front()), expected.field_deg, 0.9);
    if (expected.azimuth_width_deg > 0.0) {
      EXPECT_EQ(sonar.azimuth_beam_width_deg, expected.azimuth_width_deg);
    }
    EXPECT_GT(sonar.azimuth_beam_width_deg, 0.0);
    EXPECT_EQ(sonar.elevation_beam_width_deg, expected.elevation_width_deg);
    EXPECT_EQ(sonar.beam_forming, expected.forming);
  }
}

// Otherwise every command would warn.
TEST(SonarPresets, LieWithinTheLimitsOfTheirAbsorption) {
  for (const SonarPreset& preset : SonarPresets()) {
    EXPECT_EQ(AbsorptionCaveat(AbsorptionFormula::kAuto, preset.sonar.frequency_hz, preset.water), "")
        << preset.name;
  }
}

TEST(SonarPresets, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  EXPECT_THAT([] { FindSonarPreset("p901"); },
              ::testing::ThrowsMessage<UsageError>(
                  ::testing::AllOf(HasSubstr("'p901'"), HasSubstr("p900-45"), HasSubstr("aris3000"))));
}

}  // namespace
}  // namespace sonarcal::sim
