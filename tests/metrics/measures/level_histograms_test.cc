#include "metrics/measures/level_histograms.h"

#include <gtest/gtest.h>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using testing::MaskOf;

TEST(LevelHistogramsTest, PixelsAreCountedByDomain) {
  const Grid<float> real = GridOf({{0.0f, 1.0f, 2.0f, 3.0f}});
  const Grid<float> simulated = GridOf({{3.0f, 3.0f, 0.4f, 2.6f}});  // read as 3, 3, 0, 3
  const LevelHistograms levels = CountLevels(real, simulated, 3.0, MaskOf({"##.."}), MaskOf({".##."}));
  using Counts = std::vector<double>;
  EXPECT_EQ(levels.Over(LevelDomain::kWhole).real, (Counts{1, 1, 1, 1}));
  EXPECT_EQ(levels.Over(LevelDomain::kWhole).simulated, (Counts{1, 0, 0, 3}));
  EXPECT_EQ(levels.Over(LevelDomain::kUnion).real, (Counts{1, 1, 1, 0}));
  EXPECT_EQ(levels.Over(LevelDomain::kOverlap).simulated, (Counts{0, 0, 0, 1}));
  EXPECT_EQ(levels.Over(LevelDomain::kObjects).real, (Counts{1, 1, 0, 0}));
  EXPECT_EQ(levels.Over(LevelDomain::kObjects).simulated, (Counts{1, 0, 0, 1}));
}

TEST(LevelHistogramsTest, DistancesAreInFullScaleAndAbsentWithoutPixels) {
  const Mask all = MaskOf({"##"}), none = MaskOf({".."});
  const LevelHistograms levels =
      CountLevels(GridOf({{0.0f, 0.0f}}), GridOf({{255.0f, 255.0f}}), 255.0, all, none);
  EXPECT_DOUBLE_EQ(levels.Over(LevelDomain::kWhole).Distances().wasserstein.value(), 1.0);
  EXPECT_DOUBLE_EQ(levels.Over(LevelDomain::kWhole).Distances().l1_half.value(), 1.0);
  EXPECT_FALSE(levels.Over(LevelDomain::kOverlap).Distances().l1_half);
  EXPECT_FALSE(levels.Over(LevelDomain::kObjects).Distances().hellinger) << "one side has no object";
}

TEST(LevelHistogramsTest, PooledFramesAreOneImage) {
  const Mask mask = MaskOf({"##"});
  LevelHistograms pooled = CountLevels(GridOf({{0, 9}}), GridOf({{9, 0}}), 9.0, mask, mask);
  EXPECT_DOUBLE_EQ(pooled.Over(LevelDomain::kUnion).Distances().l1_half.value(), 0.0)
      << "places do not count";
  pooled += CountLevels(GridOf({{0, 0}}), GridOf({{9, 9}}), 9.0, mask, mask);
  EXPECT_DOUBLE_EQ(pooled.Over(LevelDomain::kUnion).Distances().l1_half.value(), 0.5);
  EXPECT_THROW(pooled += CountLevels(GridOf({{0, 0}}), GridOf({{1, 1}}), 1.0, mask, mask), DataError);
}

TEST(LevelHistogramsTest, FineDisplaysAreReadIn4096Classes) {
  const Mask mask = MaskOf({"#"});
  const LevelHistograms levels = CountLevels(GridOf({{0.0f}}), GridOf({{65535.0f}}), 65535.0, mask, mask);
  EXPECT_EQ(levels.Over(LevelDomain::kWhole).real.size(), 4096U);
  EXPECT_DOUBLE_EQ(levels.Over(LevelDomain::kWhole).Distances().wasserstein.value(), 1.0);
}

}  // namespace
}  // namespace sonarcal::metrics
