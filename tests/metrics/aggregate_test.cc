#include "metrics/aggregate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sonarcal::metrics {
namespace {

FrameMetrics FrameOf(Occupancy occupancy, const std::vector<double>& union_differences = {}) {
  FrameMetrics frame;
  frame.polar.occupancy = occupancy;
  for (const double difference : union_differences) frame.polar.intensity.union_region.Add(0.0, difference);
  frame.fan = frame.polar;
  return frame;
}

std::vector<FrameMetrics> RandomFrames(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> size(50, 5000);
  std::uniform_real_distribution<double> share(0.2, 1.0);
  std::normal_distribution<double> difference(0.05, 0.1);
  std::vector<FrameMetrics> frames;
  for (int i = 0; i < count; ++i) {
    const std::int64_t ns = size(random);
    const std::int64_t nr = size(random);
    const auto na = static_cast<std::int64_t>(share(random) * static_cast<double>(std::min(ns, nr)));
    frames.push_back(FrameOf({ns, nr, na}, {difference(random), difference(random)}));
  }
  return frames;
}

TEST(AggregateTest, MacroAndMicroComputedByHand) {
  const std::vector<FrameMetrics> frames = {FrameOf({.ns = 100, .nr = 50, .na = 40}, {0.1}),
                                            FrameOf({.ns = 300, .nr = 400, .na = 280}, {0.2, -0.4, 0.6})};
  const Aggregate aggregate = AggregateFrames(frames);
  EXPECT_EQ(aggregate.frame_count, 2);
  EXPECT_DOUBLE_EQ(*aggregate.macro.polar.At("ns_over_nr").value, (2.0 + 0.75) / 2.0);
  EXPECT_DOUBLE_EQ(*aggregate.micro.polar.At("ns_over_nr").value, 400.0 / 450.0);
  EXPECT_DOUBLE_EQ(*aggregate.macro.polar.At("na_over_nr").value, (0.8 + 0.7) / 2.0);
  EXPECT_DOUBLE_EQ(*aggregate.micro.polar.At("na_over_nr").value, 320.0 / 450.0);
  EXPECT_DOUBLE_EQ(*aggregate.micro.polar.At("iou").value, 320.0 / (400.0 + 450.0 - 320.0));
  EXPECT_NEAR(*aggregate.macro.polar.Over(IntensityDomain::kUnion).mean_absolute.value, (0.1 + 0.4) / 2.0,
              1e-12);
  EXPECT_NEAR(*aggregate.micro.polar.Over(IntensityDomain::kUnion).mean_absolute.value, 1.3 / 4.0, 1e-12);
  EXPECT_NEAR(*aggregate.micro.fan.Over(IntensityDomain::kUnion).bias.value, 0.5 / 4.0, 1e-12);
  EXPECT_EQ(aggregate.pooled_polar.occupancy, (Occupancy{400, 450, 320}));
}

TEST(AggregateTest, ARootMeanSquareIsTheRootOfTheMeanSquare) {
  const Aggregate aggregate = AggregateFrames({FrameOf({}, {0.1}), FrameOf({}, {0.2, -0.4, 0.6})});
  EXPECT_NEAR(*aggregate.macro.polar.Over(IntensityDomain::kUnion).rmse.value,
              std::sqrt((0.01 + 0.56 / 3.0) / 2.0), 1e-12);
  EXPECT_NEAR(*aggregate.micro.polar.Over(IntensityDomain::kUnion).rmse.value, std::sqrt(0.57 / 4.0), 1e-12);
}

TEST(AggregateTest, MicroRatiosSatisfyTheIdentityAndMacroRatiosNeedNot) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Aggregate aggregate = AggregateFrames(RandomFrames(20, seed));
    const ViewSummary& micro = aggregate.micro.polar;
    EXPECT_NEAR(*micro.At("na_over_nr").value, *micro.At("na_over_ns").value * *micro.At("ns_over_nr").value,
                1e-12);
    const ViewSummary& macro = aggregate.macro.polar;
    EXPECT_GT(std::abs(*macro.At("na_over_nr").value -
                       *macro.At("na_over_ns").value * *macro.At("ns_over_nr").value),
              1e-3);
  }
}

TEST(AggregateTest, AnUndefinedRatioIsLeftOutAndCounted) {
  const Aggregate aggregate =
      AggregateFrames({FrameOf({.ns = 10, .nr = 0, .na = 0}), FrameOf({.ns = 8, .nr = 4, .na = 3})});
  EXPECT_EQ(aggregate.macro.polar.At("ns_over_nr").value, 2.0);
  EXPECT_EQ(aggregate.macro.polar.At("ns_over_nr").frames_used, 1);
  EXPECT_EQ(aggregate.macro.polar.At("ns_over_nr").frames_left_out, 1);
  EXPECT_EQ(aggregate.macro.polar.At("na_over_ns").frames_left_out, 0);
  EXPECT_EQ(aggregate.micro.polar.At("ns_over_nr").value, 18.0 / 4.0);
  EXPECT_EQ(aggregate.micro.polar.At("ns_over_nr").frames_left_out, 0);
  EXPECT_EQ(aggregate.macro.polar.Over(IntensityDomain::kOverlap).mean_absolute.value, std::nullopt);
}

TEST(AggregateTest, NoFramesGiveNoValues) {
  const Aggregate aggregate = AggregateFrames({});
  EXPECT_EQ(aggregate.macro.polar.At("iou").value, std::nullopt);
  EXPECT_EQ(aggregate.micro.fan.At("iou").value, std::nullopt);
  EXPECT_EQ(aggregate.no_interval_reason, "0 frames, an interval needs at least 3");
}

TEST(AggregateTest, IntervalsNeedThreeFramesThatDefineTheRatio) {
  std::vector<FrameMetrics> frames = RandomFrames(2, 1);
  Aggregate two = AggregateFrames(frames);
  EXPECT_EQ(two.macro.polar.At("iou").ci, std::nullopt);
  EXPECT_EQ(two.no_interval_reason, "2 frames, an interval needs at least 3");

  frames.push_back(FrameOf({.ns = 10, .nr = 0, .na = 0}));
  const Aggregate three = AggregateFrames(frames);
  EXPECT_EQ(three.no_interval_reason, "");
  EXPECT_TRUE(three.macro.polar.At("iou").ci);          // 0 in the third frame
  EXPECT_FALSE(three.macro.polar.At("ns_over_nr").ci);  // undefined in the third frame
  EXPECT_FALSE(three.micro.polar.At("ns_over_nr").ci);
}

// Draws that hold the one frame with an object all pool to the same figure.
TEST(AggregateTest, AnObjectInOneOfManyFramesGivesNoInterval) {
  std::vector<FrameMetrics> frames(19, FrameOf({}));
  frames.push_back(FrameOf({.ns = 80, .nr = 100, .na = 60}));
  const Aggregate aggregate = AggregateFrames(frames);
  for (const char* figure : {"iou", "ns_over_nr"}) {
    EXPECT_TRUE(aggregate.micro.polar.At(figure).value) << figure;
    EXPECT_FALSE(aggregate.macro.polar.At(figure).ci) << figure;
    EXPECT_FALSE(aggregate.micro.polar.At(figure).ci) << figure;
  }
}

TEST(AggregateTest, IntervalsHoldTheirValueAndAreTheSameEveryTime) {
  const Aggregate a = AggregateFrames(RandomFrames(12, 4));
  const Aggregate b = AggregateFrames(RandomFrames(12, 4));
  for (const auto views : {&Aggregate::macro, &Aggregate::micro}) {
    const Statistic& iou = (a.*views).polar.At("iou");
    ASSERT_TRUE(iou.ci);
    EXPECT_LT(iou.ci->lo, *iou.value);
    EXPECT_GT(iou.ci->hi, *iou.value);
    EXPECT_EQ(iou.ci, (b.*views).polar.At("iou").ci);
  }
}

// An error that keeps three quarters of itself from frame to frame.
std::vector<FrameMetrics> FramesThatResembleEachOther(int count, std::uint64_t seed, bool timed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> fresh(0.0, 0.05);
  std::vector<FrameMetrics> frames;
  double error = 0.0;
  for (int i = 0; i < count; ++i) {
    error = 0.75 * error + fresh(random);
    frames.push_back(FrameOf({}, {0.5 + error}));
    if (timed) frames.back().time_s = 0.1 * i;
  }
  return frames;
}

TEST(AggregateTest, FramesThatFollowInTimeAreDrawnInBlocks) {
  const auto statistic = [](const std::vector<FrameMetrics>& frames) {
    return AggregateFrames(frames).macro.polar.Over(IntensityDomain::kUnion).bias;
  };
  const Statistic alone = statistic(FramesThatResembleEachOther(200, 5, false));
  const Statistic in_blocks = statistic(FramesThatResembleEachOther(200, 5, true));
  EXPECT_EQ(alone.block_frames, 1);
  EXPECT_GT(in_blocks.block_frames, 5);
  EXPECT_EQ(*alone.value, *in_blocks.value);
  // In the limit sqrt((1 + .75) / (1 - .75)) = 2.6 times as wide.
  EXPECT_GT(in_blocks.ci->hi - in_blocks.ci->lo, 1.8 * (alone.ci->hi - alone.ci->lo));

  std::vector<FrameMetrics> shuffled = FramesThatResembleEachOther(200, 5, true);
  std::swap(shuffled[3].time_s, shuffled[4].time_s);
  EXPECT_FALSE(AggregateFrames(shuffled).in_time);
  std::vector<FrameMetrics> two = FramesThatResembleEachOther(2, 5, true);
  EXPECT_TRUE(AggregateFrames(two).in_time);
  two[1].time_s = two[0].time_s;
  EXPECT_FALSE(AggregateFrames(two).in_time) << "of one time";
  two[1].time_s.reset();
  EXPECT_FALSE(AggregateFrames(two).in_time);
  EXPECT_FALSE(AggregateFrames(FramesThatResembleEachOther(1, 5, true)).in_time);
}

TEST(AggregateTest, EqualFramesHaveAnIntervalOfNoWidth) {
  const Aggregate aggregate = AggregateFrames(std::vector(5, FrameOf({.ns = 8, .nr = 4, .na = 2}, {0.25})));
  EXPECT_EQ(aggregate.macro.polar.At("ns_over_nr").ci, (Interval{2.0, 2.0}));
  EXPECT_EQ(aggregate.micro.polar.At("ns_over_nr").ci, (Interval{2.0, 2.0}));
}

TEST(AggregateTest, TheIntervalOfAMeanHasTheWidthTheCentralLimitTheoremGives) {
  std::vector<FrameMetrics> frames;
  std::mt19937_64 random(9);
  std::normal_distribution<double> difference(0.3, 0.05);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double d = difference(random);
    frames.push_back(FrameOf({}, {d}));
    sum += d;
    squares += d * d;
  }
  const double mean = sum / 200.0;
  const double standard_error = std::sqrt((squares / 200.0 - mean * mean) / 200.0);
  const Interval ci = AggregateFrames(frames).macro.polar.Over(IntensityDomain::kUnion).bias.ci.value();
  EXPECT_NEAR(ci.lo, mean - 1.96 * standard_error, 0.25 * standard_error);
  EXPECT_NEAR(ci.hi, mean + 1.96 * standard_error, 0.25 * standard_error);
}

}  // namespace
}  // namespace sonarcal::metrics
