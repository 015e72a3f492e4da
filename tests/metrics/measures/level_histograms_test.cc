#include "metrics/measures/level_histograms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using testing::MaskOf;

constexpr double kNoEcho = std::numeric_limits<double>::infinity();

TEST(LevelHistogramsTest, PixelsAreCountedByDomain) {
  const Grid<float> real = GridOf({{0.0f, 1.0f, 2.0f, 3.0f}});
  const Grid<float> simulated = GridOf({{3.0f, 3.0f, 0.4f, 2.6f}});  // read as 3, 3, 0, 3
  const LevelHistograms levels =
      CountLevels(real, simulated, 3.0, MaskOf({"##.."}), MaskOf({".##."}), kNoEcho);
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
      CountLevels(GridOf({{0.0f, 0.0f}}), GridOf({{255.0f, 255.0f}}), 255.0, all, none, kNoEcho);
  EXPECT_DOUBLE_EQ(levels.Over(LevelDomain::kWhole).Distances().wasserstein.value(), 1.0);
  EXPECT_DOUBLE_EQ(levels.Over(LevelDomain::kWhole).Distances().l1_half.value(), 1.0);
  EXPECT_FALSE(levels.Over(LevelDomain::kOverlap).Distances().l1_half);
  EXPECT_FALSE(levels.Over(LevelDomain::kObjects).Distances().hellinger) << "one side has no object";
}

// Mean distance of sorted values: the earth mover's distance of two samples of one size.
double SortedDistance(const Grid<float>& real, const Grid<float>& simulated) {
  std::vector<float> a(real.values().begin(), real.values().end());
  std::vector<float> b(simulated.values().begin(), simulated.values().end());
  std::ranges::sort(a);
  std::ranges::sort(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

TEST(LevelHistogramsTest, TheEarthMoversDistanceOfShiftedLevelsIsTheShift) {
  const Grid<float> real = GridOf({{10, 20, 30, 90, 95}});
  Grid<float> shifted = real;
  for (float& value : shifted.values()) value += 51.0F;
  const Mask none = MaskOf({"....."});
  LevelHistograms levels = CountLevels(real, shifted, 255.0, none, none, kNoEcho);
  EXPECT_FALSE(levels.Distances()[1].emd_db) << "the display states no dB";
  levels.span_db = 80.0;
  EXPECT_NEAR(levels.Distances()[static_cast<int>(LevelDomain::kWhole)].emd_db.value(), 16.0, 1e-12);
}

TEST(LevelHistogramsTest, TheEarthMoversDistanceIsThatOfSortedValues) {
  const Grid<float> real = testing::SpeckledBlock(1, 40.0).value;
  const Grid<float> simulated = testing::SpeckledBlock(2, 43.0).value;
  const Mask none(real.rows(), real.cols());
  LevelHistograms levels = CountLevels(real, simulated, 255.0, none, none, kNoEcho);
  levels.span_db = 80.0;
  EXPECT_NEAR(levels.Distances()[static_cast<int>(LevelDomain::kWhole)].emd_db.value(),
              SortedDistance(real, simulated) * 80.0 / 255.0, 1e-9);
}

TEST(LevelHistogramsTest, EchoesAreReadInEachImage) {
  const Mask none = MaskOf({"....."});
  LevelHistograms levels =
      CountLevels(GridOf({{0, 0, 50, 50, 50}}), GridOf({{60, 0, 0, 0, 40}}), 100.0, none, none, 40.0);
  levels.span_db = 50.0;
  EXPECT_NEAR(levels.Distances()[static_cast<int>(LevelDomain::kEchoes)].emd_db.value(), 5.0, 1e-12);
  LevelHistograms other = levels;
  other.span_db = 60.0;
  other += levels;
  EXPECT_FALSE(other.span_db) << "frames of different displays";
  LevelHistograms pooled;
  pooled += levels;
  EXPECT_EQ(pooled.span_db, 50.0);
}

TEST(LevelHistogramsTest, PooledFramesAreOneImage) {
  const Mask mask = MaskOf({"##"});
  LevelHistograms pooled = CountLevels(GridOf({{0, 9}}), GridOf({{9, 0}}), 9.0, mask, mask, kNoEcho);
  EXPECT_DOUBLE_EQ(pooled.Over(LevelDomain::kUnion).Distances().l1_half.value(), 0.0)
      << "places do not count";
  pooled += CountLevels(GridOf({{0, 0}}), GridOf({{9, 9}}), 9.0, mask, mask, kNoEcho);
  EXPECT_DOUBLE_EQ(pooled.Over(LevelDomain::kUnion).Distances().l1_half.value(), 0.5);
  EXPECT_THROW(pooled += CountLevels(GridOf({{0, 0}}), GridOf({{1, 1}}), 1.0, mask, mask, kNoEcho),
               DataError);
}

TEST(LevelHistogramsTest, FineDisplaysAreReadIn4096Classes) {
  const Mask mask = MaskOf({"#"});
  const LevelHistograms levels =
      CountLevels(GridOf({{0.0f}}), GridOf({{65535.0f}}), 65535.0, mask, mask, kNoEcho);
  EXPECT_EQ(levels.Over(LevelDomain::kWhole).real.size(), 4096U);
  EXPECT_DOUBLE_EQ(levels.Over(LevelDomain::kWhole).Distances().wasserstein.value(), 1.0);
}

}  // namespace
}  // namespace sonarcal::metrics
