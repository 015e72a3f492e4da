// The frame in one pass against the same rays traced to echoes and shaded one at a time.
#include "sim/acoustic/acoustic_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/sim/thread_limit.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using testing::kAlphaDbPerM;

struct FrameCase {
  RayFanOptions fan;
  ElevationPattern pattern = ElevationPattern::kAperture;
  double elevation_width_deg = 20.0;
};

class AcousticFrame : public ::testing::TestWithParam<FrameCase> {
 protected:
  static ParameterSet Parameters() {
    ParameterSet set;
    set.model = EchoModel::kAcoustic;
    set.source_level_db = 200.0;
    set.materials["default"].gsab = {.a = 80.0, .b_deg = 0.7, .c = 2.0, .d = 1.5, .e = 8.0, .f_deg = 14.0};
    set.materials["mockup"].gsab = {.a = 4.0, .b_deg = 3.0, .c = 20.0, .d = 1.0, .e = 10.0, .f_deg = 12.0};
    set.beam.elevation_pattern = GetParam().pattern;
    set.beam.elevation_width_deg = GetParam().elevation_width_deg;
    return set;
  }
  PulsedMap Pulsed() const {
    return PulsedCaster(fan_, geometry_, Parameters(), caster_.material_names()).Cast(caster_, pose_);
  }
  SonarModel sonar_ = FindSonarPreset("p900-45").sonar;
  RayCaster caster_{MakeMockupTank()};
  RayFan fan_{sonar_, GetParam().fan};
  Pose pose_ = MockupTankPoses(3)[1];
  AcousticGeometry geometry_{sonar_, kAlphaDbPerM};
};

// Cell by cell; where a table's straight lines and single precision count, against the cell's neighbours, as
// an echo at the end of a row may fall to either side.
TEST_P(AcousticFrame, IsTheMapOfTheEchoes) {
  const ScatterMap slow =
      MakeScatterMap(Trace(caster_, fan_, pose_, sonar_.axes), fan_, geometry_, Parameters());
  const ScatterMap quick = CastScatterMap(caster_, fan_, pose_, geometry_, Parameters());
  EXPECT_EQ(quick.column_azimuth_rad, slow.column_azimuth_rad);
  EXPECT_EQ(quick.range_steps, slow.range_steps);
  ASSERT_EQ(quick.power.size(), slow.power.size());
  const double largest = *std::max_element(slow.power.values().begin(), slow.power.values().end());
  ASSERT_GT(largest, 0.0);
  double lit = 0.0;
  for (int row = 1; row + 1 < slow.power.rows(); ++row) {
    for (int col = 0; col < slow.power.cols(); ++col) {
      const double near = slow.power(row - 1, col) + slow.power(row, col) + slow.power(row + 1, col);
      lit += near > 0.0 ? 1.0 : 0.0;
      ASSERT_NEAR(quick.power(row, col), slow.power(row, col), 2e-3 * near + 1e-9 * largest)
          << row << ' ' << col;
    }
  }
  EXPECT_GT(lit, 0.01 * static_cast<double>(slow.power.size()));
}

TEST_P(AcousticFrame, ThroughThePulseIsTheMapOfTheEchoesThroughThePulse) {
  const Grid<double> slow =
      ThroughPulse(MakeScatterMap(Trace(caster_, fan_, pose_, sonar_.axes), fan_, geometry_, Parameters()),
                   geometry_, Parameters());
  const PulsedMap quick = Pulsed();
  EXPECT_EQ(quick.column_azimuth_rad, ColumnAzimuthsRad(fan_));
  ASSERT_EQ(quick.power.size(), slow.size());
  const double largest = *std::max_element(slow.values().begin(), slow.values().end());
  ASSERT_GT(largest, 0.0);
  for (std::size_t i = 0; i < slow.size(); ++i) {
    const double expected = slow.values()[i];
    ASSERT_NEAR(quick.power.values()[i], expected, 1e-3 * expected + 1e-9 * largest) << i;
  }
}

TEST_P(AcousticFrame, ThroughThePulseIsTheSameOnAnyNumberOfThreads) {
  const auto map = [&] { return Pulsed().power; };
  EXPECT_EQ(testing::WithThreads(1, map), testing::WithThreads(2, map));
}

TEST_P(AcousticFrame, IsTheSameOnAnyNumberOfThreads) {
  const auto map = [&] { return CastScatterMap(caster_, fan_, pose_, geometry_, Parameters()).power; };
  EXPECT_EQ(testing::WithThreads(1, map), testing::WithThreads(2, map));
}

INSTANTIATE_TEST_SUITE_P(
    All, AcousticFrame,
    ::testing::Values(
        FrameCase{.fan = {.sampling = Sampling::kBeams, .cols = 512, .rows = 300}},
        FrameCase{.fan = {.sampling = Sampling::kBeams,
                          .cols = 512,
                          .rows = 400,
                          .elevation_span_deg = 176.0,
                          .azimuth_margin_deg = 3.0,
                          .row_crowding = 6.0,
                          .stagger = true,
                          .stagger_rows = true}},
        FrameCase{.fan = {.sampling = Sampling::kBeams,
                          .cols = 300,
                          .rows = 20,
                          .elevation_span_deg = 176.0,
                          .stagger_rows = true},
                  .pattern = ElevationPattern::kGaussian,
                  .elevation_width_deg = 8.0},
        FrameCase{.fan = {.sampling = Sampling::kBeams, .cols = 300, .rows = 200, .elevation_span_deg = 90.0},
                  .pattern = ElevationPattern::kCosine}));

}  // namespace
}  // namespace sonarcal::sim
