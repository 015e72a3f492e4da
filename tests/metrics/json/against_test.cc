#include "metrics/json/against.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string_view>

#include <nlohmann/json.hpp>

#include "metrics/json/metrics_json.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Frames whose errors differ widely from frame to frame, and by `step` and a little noise from run to run.
MetricsReport RunOf(int count, double step, std::uint64_t noise_seed, int first = 0) {
  std::mt19937_64 hard(99), noise(noise_seed);
  std::uniform_real_distribution<double> hardness(0.1, 0.5), little(-0.004, 0.004);
  MetricsReport report;
  report.real = "tank";
  for (int i = 0; i < first + count; ++i) {
    const double error = hardness(hard) + step + little(noise);
    if (i < first) continue;
    FrameMetrics frame;
    frame.index = i;
    frame.name = fmt::format("frame {}", i);
    frame.polar.occupancy = {.ns = 100, .nr = 100, .na = static_cast<int>(100.0 - 100.0 * error)};
    frame.polar.intensity.union_region.Add(0.0, error);
    frame.fan = frame.polar;
    report.frames.push_back(std::move(frame));
  }
  report.aggregate = AggregateFrames(report.frames);
  return report;
}

const FigureChange& ChangeOf(const Against& against, std::string_view path, bool fan = false) {
  for (const FigureChange& change : against.figures) {
    if (change.path == path && change.fan == fan) return change;
  }
  throw std::logic_error(std::string(path));
}

constexpr const char* kError = "intensity.union.mean_absolute";

// One frame on each side: no interval, and a check must not pass by that.
TEST(AgainstTest, AWorseRunOfTooFewFramesIsNotCalledUnchanged) {
  const MetricsReport one = RunOf(1, 0.0, 1);
  const Against against = CompareAgainst(RunOf(1, 0.4, 2), MetricsJson(one), "then.json");
  const FigureChange& change = ChangeOf(against, kError);
  EXPECT_GT(change.worsening, 0.1);
  EXPECT_FALSE(change.is_judged);
  EXPECT_FALSE(against.unknown.empty());
  EXPECT_THAT(against.notes, ::testing::Contains(HasSubstr("nothing tells whether")));
  EXPECT_TRUE(CompareAgainst(one, MetricsJson(one), "then.json").unknown.empty()) << "equal";
}

TEST(AgainstTest, AnEqualRunIsTheSameByEveryFigure) {
  const MetricsReport run = RunOf(12, 0.0, 1);
  const Against against = CompareAgainst(run, MetricsJson(run), "earlier.json");
  EXPECT_EQ(against.common_frames, 12);
  EXPECT_GT(against.Count(ChangeVerdict::kSame, false), 10);
  EXPECT_EQ(against.Count(ChangeVerdict::kSame, false), static_cast<int>(against.figures.size()));
  EXPECT_EQ(against.Count(ChangeVerdict::kSame, true), 4) << "IoU and intensity error, polar and fan";
  EXPECT_THAT(against.notes, IsEmpty());
}

// The step is a tenth of the spread over frames: their intervals overlap, and pairing alone tells it.
TEST(AgainstTest, PairedFramesDetectASmallStepInEitherDirection) {
  const MetricsReport before = RunOf(16, 0.0, 1);
  const MetricsReport after = RunOf(16, 0.02, 2);
  const Against worse = CompareAgainst(after, MetricsJson(before), "earlier.json");
  EXPECT_EQ(ChangeOf(worse, kError).verdict, ChangeVerdict::kWorse);
  EXPECT_NEAR(ChangeOf(worse, kError).worsening, 0.02, 0.004);
  EXPECT_LT(ChangeOf(worse, kError).worsening_ci->lo, 0.02);
  EXPECT_GT(ChangeOf(worse, kError).worsening_ci->hi, 0.016);
  EXPECT_EQ(ChangeOf(worse, "iou", true).verdict, ChangeVerdict::kWorse);
  EXPECT_EQ(ChangeOf(worse, "intensity.union.rmse").verdict, ChangeVerdict::kWorse);
  EXPECT_EQ(ChangeOf(worse, "intensity.union.psnr_db").verdict, ChangeVerdict::kWorse);
  EXPECT_EQ(worse.Count(ChangeVerdict::kWorse, true), 4);
  EXPECT_EQ(ChangeOf(worse, "ns_over_nr").earlier, 1.0);

  const Against better = CompareAgainst(before, MetricsJson(after), "earlier.json");
  EXPECT_EQ(ChangeOf(better, kError).verdict, ChangeVerdict::kBetter);
  EXPECT_EQ(better.Count(ChangeVerdict::kBetter, true), 4);

  const Interval then = before.aggregate.macro.polar.At(kError).ci.value();
  const Interval now = after.aggregate.macro.polar.At(kError).ci.value();
  EXPECT_GT(then.hi, now.lo);
}

// The truth does not change; 95 % intervals may miss it in one run of twenty.
TEST(AgainstTest, ChangesWithinTheNoiseAreNotReported) {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Against against =
        CompareAgainst(RunOf(16, 0.0, 2 * seed), MetricsJson(RunOf(16, 0.0, 2 * seed + 1)), "earlier.json");
    told += ChangeOf(against, kError).verdict != ChangeVerdict::kNotTold;
  }
  EXPECT_LE(told, 7);  // 2 expected, percentile intervals of 16 frames are a little narrow
}

TEST(AgainstTest, FewFramesOfOneTruthGiveNoVerdict) {
  const Against against = CompareAgainst(RunOf(5, 0.0, 4), MetricsJson(RunOf(5, 0.0, 5)), "earlier.json");
  const FigureChange& change = ChangeOf(against, kError);
  EXPECT_EQ(change.verdict, ChangeVerdict::kNotTold);
  EXPECT_LT(change.worsening_ci->lo, 0.0);
  EXPECT_GT(change.worsening_ci->hi, 0.0);
}

// Files of other programs may leave names out.
TEST(AgainstTest, FramesArePairedByIndexAndName) {
  MetricsReport now = RunOf(6, 0.0, 1);
  const auto common = [&](const std::function<void(nlohmann::json & frame, int i)>& change) {
    nlohmann::json earlier = nlohmann::json::parse(MetricsJson(now));
    for (int i = 0; i < 6; ++i) change(earlier["frames"][i], i);
    return CompareAgainst(now, earlier.dump(), "earlier.json").common_frames;
  };
  EXPECT_EQ(common([](nlohmann::json&, int) {}), 6);
  EXPECT_EQ(common([](nlohmann::json& frame, int i) {
              if (i < 2) frame["name"] = "other";
            }),
            4);
  EXPECT_EQ(common([](nlohmann::json& frame, int i) {
              if (i < 3) frame["index"] = "a text";
            }),
            3);
  EXPECT_EQ(common([](nlohmann::json& frame, int i) {
              if (i < 3) frame = 7;
            }),
            3);
  EXPECT_EQ(common([](nlohmann::json& frame, int i) {
              if (i < 4) frame.erase("index");
            }),
            0)
      << "two frames are too few to be paired";
  for (FrameMetrics& frame : now.frames) frame.name.clear();
  EXPECT_EQ(common([](nlohmann::json& frame, int i) {
              if (i < 3) frame.erase("name");
              if (i > 3) frame["name"] = 3.0;
            }),
            6);
  nlohmann::json earlier = nlohmann::json::parse(MetricsJson(now));
  earlier["frames"] = 3;
  EXPECT_EQ(CompareAgainst(now, earlier.dump(), "earlier.json").common_frames, 0);
  earlier.erase("frames");
  EXPECT_EQ(CompareAgainst(now, earlier.dump(), "earlier.json").common_frames, 0);
}

TEST(AgainstTest, IntervalsThatAreNoneAreNotUsed) {
  const MetricsReport now = RunOf(8, 0.4, 2, 8);
  nlohmann::json earlier = nlohmann::json::parse(MetricsJson(RunOf(8, 0.0, 1)));
  const auto verdict = [&] {
    return ChangeOf(CompareAgainst(now, earlier.dump(), "a.json"), kError).verdict;
  };
  nlohmann::json& ci = earlier["macro"]["intensity"]["union"]["mean_absolute_ci"];
  const nlohmann::json whole = ci;
  EXPECT_EQ(verdict(), ChangeVerdict::kWorse);
  for (const nlohmann::json& wrong :
       {nlohmann::json(), nlohmann::json(3.0), nlohmann::json{whole[0]}, nlohmann::json{whole[0], "x"},
        nlohmann::json{"x", whole[1]}, nlohmann::json{whole[0], whole[1], whole[1]}}) {
    ci = wrong;
    EXPECT_EQ(verdict(), ChangeVerdict::kNotTold) << wrong.dump();
  }
  const double now_lo = now.aggregate.macro.polar.At(kError).ci->lo;
  ci = {whole[0], now_lo};
  EXPECT_EQ(verdict(), ChangeVerdict::kNotTold) << "intervals that touch are not apart";
  ci = {whole[0], std::nextafter(now_lo, 0.0)};
  EXPECT_EQ(verdict(), ChangeVerdict::kWorse);
  const double now_hi = now.aggregate.macro.polar.At(kError).ci->hi;
  ci = {now_hi, 0.95};
  EXPECT_EQ(verdict(), ChangeVerdict::kNotTold);
  // The mean before, and one that is better by as much.
  ci = {0.9, 0.95};
  earlier["macro"]["intensity"]["union"]["mean_absolute"] = 0.93;
  EXPECT_EQ(verdict(), ChangeVerdict::kBetter);
  earlier["macro"]["intensity"]["union"]["mean_absolute"] = *now.aggregate.macro.polar.At(kError).value;
  EXPECT_EQ(verdict(), ChangeVerdict::kSame);
}

TEST(AgainstTest, WithoutCommonFramesTheIntervalsDecide) {
  const MetricsReport before = RunOf(16, 0.0, 1);
  const Against close = CompareAgainst(RunOf(16, 0.02, 2, 16), MetricsJson(before), "earlier.json");
  EXPECT_EQ(close.common_frames, 0);
  EXPECT_EQ(ChangeOf(close, kError).verdict, ChangeVerdict::kNotTold);
  EXPECT_FALSE(ChangeOf(close, kError).worsening_ci);
  const Against far = CompareAgainst(RunOf(16, 0.4, 2, 16), MetricsJson(before), "earlier.json");
  EXPECT_EQ(ChangeOf(far, kError).verdict, ChangeVerdict::kWorse);
}

TEST(AgainstTest, ThreeCommonFramesArePaired) {
  const Against against = CompareAgainst(RunOf(3, 0.1, 1), MetricsJson(RunOf(3, 0.0, 2)), "earlier.json");
  EXPECT_EQ(against.common_frames, 3);
  EXPECT_TRUE(ChangeOf(against, kError).worsening_ci);
}

TEST(AgainstTest, OneFrameGivesNoVerdict) {
  const Against against = CompareAgainst(RunOf(1, 0.3, 1), MetricsJson(RunOf(1, 0.0, 1)), "earlier.json");
  EXPECT_EQ(ChangeOf(against, kError).verdict, ChangeVerdict::kNotTold);
}

TEST(AgainstTest, DifferencesThatHinderAComparisonAreNoted) {
  const MetricsReport before = RunOf(5, 0.0, 1);
  MetricsReport after = before;
  after.real = "harbour";
  after.options.segmentation.sigma_count = 3.0;
  after.frames[0].polar.occupancy.nr = 101;
  const Against against = CompareAgainst(after, MetricsJson(before), "earlier.json");
  nlohmann::json nameless = nlohmann::json::parse(MetricsJson(before));
  nameless.erase("real");
  nameless.erase("segmentation");
  EXPECT_THAT(CompareAgainst(after, nameless.dump(), "earlier.json").notes,
              ElementsAre(HasSubstr("in 1 of 5 common frames")));
  EXPECT_THAT(against.notes, ElementsAre(HasSubstr("with tank, this one is with harbour"),
                                         HasSubstr("segmentation"), HasSubstr("in 1 of 5 common frames")));
}

TEST(AgainstTest, AFileThatIsNoComparisonIsRefused) {
  const MetricsReport run = RunOf(3, 0.0, 1);
  EXPECT_THROW(CompareAgainst(run, "{", "a.json"), DataError);
  EXPECT_THROW(CompareAgainst(run, "[]", "a.json"), DataError);
  EXPECT_THROW(CompareAgainst(run, R"({"format": "sonar-metrics/1"})", "a.json"), DataError);
  EXPECT_THROW(CompareAgainst(run, R"({"format": 3, "macro": {}})", "a.json"), DataError);
  EXPECT_THAT(CompareAgainst(run, R"({"format": "sonar-metrics/1", "macro": 3})", "a.json").figures,
              IsEmpty());
}

TEST(AgainstTest, TheExplainedFractionIsOneAtTheFloor) {
  EXPECT_DOUBLE_EQ(ExplainedFraction(0.3, 0.1, 0.1).value(), 1.0);
  EXPECT_DOUBLE_EQ(ExplainedFraction(0.3, 0.2, 0.1).value(), 0.5);
  EXPECT_DOUBLE_EQ(ExplainedFraction(0.3, 0.4, 0.1).value(), -0.5);
  EXPECT_DOUBLE_EQ(ExplainedFraction(-0.6, -0.8, -0.9).value(), 2.0 / 3.0);  // IoU .6, .8, floor .9
  EXPECT_FALSE(ExplainedFraction(0.1, 0.1, 0.1));

  const MetricsReport before = RunOf(8, 0.2, 1);
  MetricsReport after = RunOf(8, 0.1, 1);
  after.noise_floor.real_against_real.pairs = RunOf(8, 0.0, 1).frames;
  after.noise_floor.real_against_real.aggregate = AggregateFrames(after.noise_floor.real_against_real.pairs);
  const Against against = CompareAgainst(after, MetricsJson(before), "earlier.json");
  EXPECT_NEAR(ChangeOf(against, kError).explained.value(), 0.5, 1e-9);
}

}  // namespace
}  // namespace sonarcal::metrics
