// Expected images with shared tables against the image made step by step in double precision.
#include "sim/acoustic/expected_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/types/error.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "sim/simulator.h"
#include "tests/sim/water.h"

namespace sonarcal::sim {
namespace {

using testing::kAlphaDbPerM;

constexpr double kFullScale = 255.0;

ParameterSet Parameters() {
  ParameterSet set;
  set.model = EchoModel::kAcoustic;
  set.source_level_db = 200.0;
  set.display = {.db_min = 80.0, .db_max = 150.0};
  set.receiver.looks = 2.0;
  set.receiver.noise_db = 85.0;
  set.materials["default"].gsab = {.a = 80.0, .b_deg = 0.7, .c = 2.0, .d = 1.5, .e = 8.0, .f_deg = 14.0};
  set.materials["mockup"].gsab = {.a = 4.0, .b_deg = 3.0, .c = 20.0, .d = 1.0, .e = 10.0, .f_deg = 12.0};
  return set;
}

class ExpectedFrame : public ::testing::TestWithParam<RayFanOptions> {
 protected:
  SonarModel sonar_ = FindSonarPreset("p900-45").sonar;
  Pose pose_ = MockupTankPoses(3)[1];
};

TEST_P(ExpectedFrame, IsTheDisplayOfTheMeanPower) {
  const RayCaster caster(MakeMockupTank());
  const RayFan fan(sonar_, GetParam());
  const AcousticGeometry geometry{sonar_, kAlphaDbPerM};
  const ParameterSet parameters = Parameters();
  const ScatterMap scatter =
      MakeScatterMap(Trace(caster, fan, pose_, sonar_.axes), fan, geometry, parameters);
  const PolarImage slow =
      ExpectedDisplay(ExpectedPower(scatter, geometry, parameters), parameters, kFullScale);
  const ExpectedFrames frames(caster, fan, geometry, parameters, {});
  const PolarImage quick = frames.Displayed(frames.Pulsed(pose_), kFullScale);
  EXPECT_EQ(quick.scale, slow.scale);
  ASSERT_EQ(quick.value.size(), slow.value.size());
  const auto [darkest, brightest] =
      std::minmax_element(slow.value.values().begin(), slow.value.values().end());
  ASSERT_GT(*brightest - *darkest, 0.5 * kFullScale);
  for (std::size_t i = 0; i < slow.value.size(); ++i)
    ASSERT_NEAR(quick.value.values()[i], slow.value.values()[i], 0.02) << i;
}

// The tables of one call must not serve another set of parameters.
TEST_P(ExpectedFrame, HasTheParametersOfItsCall) {
  SimulationOptions options;
  options.fan = GetParam();
  const Simulator simulator(MakeMockupTank(), sonar_, options);
  const auto rendered = [&](const ParameterSet& parameters) {
    return Simulator(simulator.shared_caster(), sonar_, options).Render(pose_, parameters).value;
  };
  ParameterSet bright = Parameters();
  bright.source_level_db += 6.0;
  ParameterSet narrow = Parameters();
  narrow.display.db_max -= 10.0;
  for (const ParameterSet& parameters : {Parameters(), bright, narrow, Parameters(), Parameters()})
    EXPECT_EQ(simulator.Render(pose_, parameters).value, rendered(parameters));
  EXPECT_NE(rendered(Parameters()), rendered(bright));
}

// Otherwise infinite factors times pixels without echoes would be no numbers.
TEST(EchoLevel, LevelsBeyondSinglePrecisionAreRefusedByTheModelsOfPower) {
  SimulationOptions options;
  options.fan = {.sampling = Sampling::kBeams, .cols = 512, .rows = 20};
  const Simulator simulator(MakeMockupTank(), FindSonarPreset("p900-45").sonar, options);
  const Pose pose = MockupTankPoses(3)[1];
  const EchoList echoes = simulator.TraceEchoes(pose);
  const std::vector<PingPose> pings = {PingOfAllBeams(simulator.sonar().axes.beam_count())};
  const auto refused = ::testing::ThrowsMessage<DataError>(
      ::testing::HasSubstr("the highest beam.sensitivity_db add up to 419.5 dB, expected at most 350 dB"));
  ParameterSet loud = Parameters();
  loud.source_level_db = 250.0;
  loud.receiver.gain_db = 150.0;
  loud.display = {.db_min = 260.0, .db_max = 360.0};
  for (const EchoModel model : {EchoModel::kAcoustic, EchoModel::kCoherent}) {
    loud.model = model;
    EXPECT_THAT([&] { simulator.Render(pose, loud); }, refused);
    EXPECT_THAT([&] { simulator.RenderPings(pose, pings, loud); }, refused);
    EXPECT_THAT([&] { simulator.RenderExpected(echoes, loud); }, refused);
  }
  loud.model = EchoModel::kAcoustic;
  EXPECT_THAT([&] { simulator.RenderEchoes(echoes, loud); }, refused);
  loud.receiver.gain_db = 80.0;
  const PolarImage image = simulator.Render(pose, loud);
  for (const float value : image.value.values()) {
    ASSERT_GE(value, 0.0F);
    ASSERT_LE(value, kFullScale);
  }
}

TEST(EchoLevel, ThePaperModelHasNoPowersThatOverflow) {
  SimulationOptions options;
  options.fan = {.sampling = Sampling::kBeams, .cols = 512, .rows = 20};
  const Simulator simulator(MakeMockupTank(), FindSonarPreset("p900-45").sonar, options);
  ParameterSet loud = Parameters();
  loud.model = EchoModel::kPaper;
  loud.source_level_db = 450.0;
  EXPECT_NO_THROW(simulator.Render(MockupTankPoses(3)[1], loud));
}

INSTANTIATE_TEST_SUITE_P(
    Fans, ExpectedFrame,
    ::testing::Values(
        RayFanOptions{.sampling = Sampling::kBeams, .cols = 512, .rows = 300, .stagger_rows = true},
        RayFanOptions{.sampling = Sampling::kFrustum, .cols = 512, .rows = 300}));

}  // namespace
}  // namespace sonarcal::sim
