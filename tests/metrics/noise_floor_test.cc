#include "metrics/noise_floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::SpeckledBlock;

TEST(SpeckleFloorTest, SingleLookDifferencesEqualTheirClosedForms) {
  EXPECT_NEAR(SingleLookPairDifferenceDb(), 6.02, 0.005);
  EXPECT_NEAR(SingleLookPairDifferenceDb(), 20.0 * std::log10(2.0), 1e-12);
  EXPECT_NEAR(SingleLookMeanDifferenceDb(), 4.27, 0.005);
}

TEST(SpeckleFloorTest, TheFormulasAgreeWithDrawnSpeckle) {
  std::mt19937_64 random(11);
  std::exponential_distribution<double> power;
  const double mean_db = -10.0 / std::numbers::ln10 * std::numbers::egamma;
  double pair = 0.0, against_mean = 0.0;
  const int count = 1000000;
  for (int i = 0; i < count; ++i) {
    const double a_db = 10.0 * std::log10(power(random));
    const double b_db = 10.0 * std::log10(power(random));
    pair += std::abs(a_db - b_db);
    against_mean += std::abs(a_db - mean_db);
  }
  EXPECT_NEAR(pair / count, SingleLookPairDifferenceDb(), 0.03);  // 6 standard errors
  EXPECT_NEAR(against_mean / count, SingleLookMeanDifferenceDb(), 0.03);
}

TEST(SpeckleFloorTest, IsAShareOfTheDisplaysSpan) {
  ImageScale scale;
  EXPECT_FALSE(SpeckleFloorFor(scale));
  scale.db_span = 80.0;
  EXPECT_NEAR(SpeckleFloorFor(scale)->speckled_simulation, 0.075, 0.0005);
  EXPECT_NEAR(SpeckleFloorFor(scale)->smooth_simulation, 0.053, 0.0005);
  scale.db_min = 80.0;  // both ends win over the span alone
  scale.db_max = 120.0;
  EXPECT_EQ(SpeckleFloorFor(scale)->span_db, 40.0);
  scale.db_max = 80.0;
  EXPECT_THROW(SpeckleFloorFor(scale), DataError);
}

Frame FrameAt(std::uint64_t seed, std::optional<double> x_m) {
  Frame frame{{fmt::format("frame {}", seed), {}, {}}, SpeckledBlock(seed, 40.0)};
  if (x_m) frame.info.world_from_sonar = Pose{Eigen::Quaterniond::Identity(), {*x_m, 0.0, 0.0}};
  return frame;
}

TEST(RealAgainstRealTest, IndependentSpeckleReachesTheTheoreticalFloor) {
  // At 40 dB of an 80 dB display next to nothing is clipped.
  const MemoryRecording recording({}, {FrameAt(1, {}), FrameAt(2, {}), FrameAt(3, {}), FrameAt(4, {})});
  const RealAgainstReal floor = CompareRealWithReal(recording, {});
  ASSERT_EQ(floor.pairs.size(), 3u);
  EXPECT_EQ(floor.pairs[1].index, 1);
  EXPECT_EQ(floor.pairs[1].name, "frame 2 and frame 3");
  EXPECT_EQ(floor.notes.size(), 1u);
  EXPECT_NEAR(*floor.aggregate.micro.polar.Over(IntensityDomain::kWhole).mean_absolute.value, 0.0753, 0.002);
}

TEST(RealAgainstRealTest, OnlyFramesOfOnePoseAreCompared) {
  const MemoryRecording recording({}, {FrameAt(1, 0.0), FrameAt(2, 1.0), FrameAt(3, 1.0), FrameAt(4, 2.0)});
  const RealAgainstReal floor = CompareRealWithReal(recording, {});
  ASSERT_EQ(floor.pairs.size(), 1u);
  EXPECT_EQ(floor.pairs[0].index, 1);
  EXPECT_TRUE(floor.notes.empty());
}

TEST(RealAgainstRealTest, APoseOfOneFrameDoesNotTellWhetherTheSonarMoved) {
  for (const bool first : {true, false}) {
    const MemoryRecording recording({}, {FrameAt(1, first ? std::optional(0.0) : std::nullopt),
                                         FrameAt(2, first ? std::nullopt : std::optional(0.0))});
    const RealAgainstReal floor = CompareRealWithReal(recording, {});
    EXPECT_EQ(floor.pairs.size(), 1U);
    EXPECT_TRUE(floor.assumed_still);
  }
}

TEST(RealAgainstRealTest, TheReasonIsGivenWhereThereIsNoPair) {
  EXPECT_EQ(CompareRealWithReal(MemoryRecording({}, {FrameAt(1, 0.0)}), {}).absent_reason,
            "1 real frame, two are needed");
  EXPECT_EQ(CompareRealWithReal(MemoryRecording({}, {FrameAt(1, 0.0), FrameAt(2, 1.0)}), {}).absent_reason,
            "no two consecutive real frames share a pose");
  EXPECT_EQ(
      CompareRealWithReal(MemoryRecording({}, {FrameAt(1, 0.0), FrameAt(2, 0.0)}), {}, {{1, PixelBox{}}})
          .absent_reason,
      "no two consecutive real frames of one pose have a box");
}

TEST(RealAgainstRealTest, NoMorePairsThanAsked) {
  const MemoryRecording recording({}, {FrameAt(1, {}), FrameAt(2, {}), FrameAt(3, {})});
  EXPECT_EQ(CompareRealWithReal(recording, {}, {}, 1).pairs.size(), 1u);
}

}  // namespace
}  // namespace sonarcal::metrics
