#include "apps/workflow/drawn_floor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/types/units.h"
#include "sim/physics/speckle.h"

namespace sonarcal::workflow {
namespace {

ParameterSet LogDisplay(double looks) {
  ParameterSet parameters;
  parameters.display = {.db_min = 0.0, .db_max = 80.0};
  parameters.receiver.looks = looks;
  return parameters;
}

// A level far from both clips: the mean display is 10 log10 P less 2.51 dB at one look.
TEST(SpeckleDrawTest, DrawsScatterAboutTheImageAsTheLawSays) {
  constexpr double kMeanDb = 50.0;
  const Grid<float> mean(400, 250, static_cast<float>(kMeanDb / 80.0 * 255.0));
  for (const double looks : {1.0, 3.0}) {
    const ParameterSet parameters = LogDisplay(looks);
    const Grid<float> drawn = SpeckleDraw(parameters, 255.0).Draw(mean, 7);
    double sum = 0.0, power = 0.0;
    for (const float grey : drawn.values()) {
      EXPECT_EQ(grey, std::round(grey));
      const double level_db = grey / 255.0 * 80.0;
      sum += level_db;
      power += PowerFromDb(level_db);
    }
    const auto count = static_cast<double>(drawn.size());
    EXPECT_NEAR(sum / count, kMeanDb, 0.1);
    // 10 / ln 10 (digamma(L) - ln L): -2.507 dB at one look, -0.763 at three.
    EXPECT_NEAR(DbFromPower(power / count) - kMeanDb, looks == 1.0 ? 2.507 : 0.763, 0.08) << looks;
  }
}

TEST(SpeckleDrawTest, TheSeedDecidesTheSample) {
  const SpeckleDraw draw(LogDisplay(1.0), 255.0);
  const Grid<float> mean(20, 20, 120.0F);
  EXPECT_EQ(draw.Draw(mean, 1), draw.Draw(mean, 1));
  EXPECT_NE(draw.Draw(mean, 1), draw.Draw(mean, 2));
}

TEST(SpeckleDrawTest, ABlackImageStaysBlack) {
  const Grid<float> drawn = SpeckleDraw(LogDisplay(1.0), 255.0).Draw(Grid<float>(30, 30), 1);
  EXPECT_EQ(drawn, Grid<float>(30, 30));
}

TEST(SpeckleDrawTest, InvalidNumbersOfLooksAreRefused) {
  EXPECT_THROW(SpeckleDraw(LogDisplay(0.0), 255.0), DataError);
}

// The mean |difference| of one look from its mean level is 4.27 dB of 80 (metrics/noise_floor.h).
TEST(DrawnFloorTest, ReachesTheTheoryOfASmoothSimulation) {
  PolarAxes axes{1.0, 3.0, 200, {}};
  for (int beam = 0; beam < 100; ++beam) axes.beam_azimuth_rad.push_back(0.005 * (beam - 49.5));
  ImageScale scale;
  scale.db_min = 0.0;
  scale.db_max = 80.0;
  std::vector<Frame> frames;
  for (int i = 0; i < 4; ++i) {
    frames.push_back(
        {{fmt::format("frame {}", i), 0.1 * i, {}, {}}, {axes, scale, Grid<float>(200, 100, 150.0F)}});
  }
  const metrics::DrawnFloor floor =
      DrawFloor(MemoryRecording({}, std::move(frames)), {0, 1, 2, 3}, LogDisplay(1.0), {});
  EXPECT_EQ(floor.aggregate.frame_count, 4);
  EXPECT_NEAR(*floor.aggregate.micro.polar.At("intensity.whole.mean_absolute").value,
              metrics::SingleLookMeanDifferenceDb() / 80.0, 3e-4);
  EXPECT_NEAR(*floor.aggregate.micro.polar.At("intensity.whole.bias").value, 0.0, 5e-4);
}

}  // namespace
}  // namespace sonarcal::workflow
