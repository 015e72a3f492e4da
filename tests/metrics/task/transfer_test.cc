#include "metrics/task/transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "core/types/error.h"
#include "tests/metrics/human_masks.h"
#include "tests/metrics/metrics_testing.h"
#include "tests/support/recordings.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using testing::MaskOf;

// A speckled frame with a brighter block.
LabelledFrame BlockFrame(std::uint64_t seed, double level_db = 20.0) {
  LabelledFrame frame{.value = testing::SpeckledBlock(seed, level_db).value, .object = Mask(120, 40)};
  for (int row = 30; row < 60; ++row) {
    for (int col = 10; col < 25; ++col) frame.object(row, col) = 1;
  }
  return frame;
}

// Average precision by its definition: one step per distinct score.
double SlowAveragePrecision(const std::vector<std::pair<int, bool>>& pixels) {
  double objects = 0.0;
  for (const auto& [score, is_object] : pixels) objects += is_object;
  double sum = 0.0, before = 0.0;
  for (int threshold = kScoreClasses; threshold >= 0; --threshold) {
    double found = 0.0, detected = 0.0;
    for (const auto& [score, is_object] : pixels) {
      detected += score >= threshold;
      found += score >= threshold && is_object;
    }
    if (detected > 0.0) sum += (found / objects - before) * found / detected;
    before = found / objects;
  }
  return sum;
}

TEST(DetectionScoresTest, AveragePrecisionAgreesWithItsDefinition) {
  std::mt19937_64 random(5);
  ScoreCounts counts;
  std::vector<std::pair<int, bool>> pixels;
  for (int i = 0; i < 400; ++i) {
    const bool is_object = random() % 4 == 0;
    const int score = static_cast<int>(random() % (is_object ? 1000 : 700));
    pixels.emplace_back(score, is_object);
    ++(is_object ? counts.object : counts.other)[score];
  }
  EXPECT_NEAR(counts.average_precision().value(), SlowAveragePrecision(pixels), 1e-12);
}

// scikit-learn's example: labels 0 0 1 1, scores .1 .4 .35 .8 give .8333.
TEST(DetectionScoresTest, AveragePrecisionOfAPublishedExample) {
  const ScoreCounts counts = CountScores(GridOf({{0.1F, 0.4F, 0.35F, 0.8F}}), MaskOf({"..##"}));
  EXPECT_NEAR(counts.average_precision().value(), 5.0 / 6.0, 1e-12);
  EXPECT_DOUBLE_EQ(counts.object_share(), 0.5);
}

TEST(DetectionScoresTest, TheCurveHasTheDetectionsAtFallingScores) {
  const PrecisionRecall curve = CountScores(GridOf({{0.1F, 0.4F, 0.35F, 0.8F}}), MaskOf({"..##"})).Curve();
  EXPECT_EQ(curve.recall, (std::vector<double>{0.5, 1.0, 1.0}));
  EXPECT_EQ(curve.precision, (std::vector<double>{1.0, 2.0 / 3.0, 0.5}));
  EXPECT_TRUE(ScoreCounts().Curve().recall.empty());
  EXPECT_EQ(CountScores(GridOf({{0.5F}}), MaskOf({"#"})).Curve().recall, (std::vector<double>{1.0}));
  ScoreCounts even;
  even.object.fill(1);
  even.other.fill(1);
  EXPECT_LE(even.Curve().recall.size(), 201U) << "points nearer than kRecallStep are left out";
  EXPECT_GT(even.Curve().recall.size(), 160U);
}

TEST(DetectionScoresTest, CountsAboveAThreshold) {
  const ScoreCounts counts = CountScores(GridOf({{0.1F, 0.4F, 0.35F, 0.8F}}), MaskOf({"..##"}));
  const Detection detection = counts.From(300);
  EXPECT_DOUBLE_EQ(detection.precision().value(), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(detection.recall().value(), 1.0);
  EXPECT_DOUBLE_EQ(detection.iou().value(), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(counts.From(counts.BestClass()).iou().value(), 2.0 / 3.0);
  EXPECT_EQ(DetectedFrom(GridOf({{0.1F, 0.4F, 0.35F, 0.8F}}), 350), MaskOf({".###"}));
  EXPECT_FALSE(ScoreCounts().average_precision());
  EXPECT_FALSE(Detection().iou());
}

// Every pixel asked one by one, at every class.
TEST(DetectionScoresTest, CountsAndTheBestClassAgreeWithAskingEveryPixel) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 20; ++trial) {
    ScoreCounts counts;
    std::vector<std::pair<int, bool>> pixels;
    for (int i = 0; i < 12; ++i) {
      const std::array<int, 5> classes = {0, 1, 500, 998, 999};
      pixels.emplace_back(classes[random() % 5], random() % 2 == 0);
      ++(pixels.back().second ? counts.object : counts.other)[pixels.back().first];
    }
    double best = -1.0;
    int best_class = 0;
    for (int lowest = 0; lowest < kScoreClasses; ++lowest) {
      std::int64_t tp = 0, fp = 0, fn = 0;
      for (const auto& [score, is_object] : pixels) {
        tp += is_object && score >= lowest;
        fp += !is_object && score >= lowest;
        fn += is_object && score < lowest;
      }
      const Detection detection = counts.From(lowest);
      ASSERT_EQ(detection.true_positives, tp);
      ASSERT_EQ(detection.false_positives, fp);
      ASSERT_EQ(detection.false_negatives, fn);
      const double iou =
          tp + fp + fn == 0 ? 0.0 : static_cast<double>(tp) / static_cast<double>(tp + fp + fn);
      ASSERT_EQ(detection.iou().value_or(0.0), iou);
      if (iou > best) {
        best = iou;
        best_class = lowest;
      }
    }
    EXPECT_EQ(counts.BestClass(), best_class);
    EXPECT_NEAR(counts.average_precision().value(), SlowAveragePrecision(pixels), 1e-12);
  }
  EXPECT_EQ(ScoreCounts().BestClass(), 0);
  EXPECT_EQ(ScoreCounts().object_share(), 0.0);
}

TEST(DetectionScoresTest, AShareOfOnePixelIsAValue) {
  const Detection one{.true_positives = 0, .false_positives = 1, .false_negatives = 0};
  EXPECT_EQ(one.precision(), 0.0);
  EXPECT_EQ(one.iou(), 0.0);
  EXPECT_FALSE(one.recall());
}

TEST(DetectionScoresTest, ScoresFallIntoEvenClassesAndTheLastHoldsOne) {
  const ScoreCounts counts =
      CountScores(GridOf({{0.0F, 0.0009F, 0.0011F, 0.9995F, 1.0F, 1.5F, -0.5F}}), MaskOf({"#.#.#.#"}));
  EXPECT_EQ(counts.object[0], 2);
  EXPECT_EQ(counts.other[0], 1);
  EXPECT_EQ(counts.object[1], 1);
  EXPECT_EQ(counts.other[999], 2);
  EXPECT_EQ(counts.object[999], 1);
}

TEST(DetectionScoresTest, DetectionsOfFramesAddUp) {
  Detection sum{.true_positives = 6, .false_positives = 2, .false_negatives = 1};
  sum += Detection{.true_positives = 2, .false_positives = 1, .false_negatives = 3};
  EXPECT_DOUBLE_EQ(sum.precision().value(), 8.0 / 11.0);
  EXPECT_DOUBLE_EQ(sum.recall().value(), 8.0 / 12.0);
  EXPECT_DOUBLE_EQ(sum.iou().value(), 8.0 / 15.0);
}

TEST(PixelDetectorTest, FeaturesAreBoxMeansAndSpreads) {
  const Grid<float> value = testing::SpeckledBlock(3).value;
  const Grid<float> features = PixelFeatures(value, 255.0);
  Grid<float> brighter = value;
  for (float& pixel : brighter.values()) pixel += 40.0F;
  const Grid<float> of_brighter = PixelFeatures(brighter, 255.0);
  std::vector<float> sorted(value.values().begin(), value.values().end());
  std::ranges::sort(sorted);
  const double median = 0.5 * (sorted[sorted.size() / 2 - 1] + sorted[sorted.size() / 2]);
  for (const auto& [row, col] : {std::pair{50, 20}, std::pair{0, 0}, std::pair{119, 39}}) {
    const auto box = [&, row = row, col = col](int half) {
      double sum = 0.0, square = 0.0, count = 0.0;
      for (int r = std::max(0, row - half); r <= std::min(119, row + half); ++r) {
        for (int c = std::max(0, col - half); c <= std::min(39, col + half); ++c) {
          const double share = (value(r, c) - median) / 255.0;
          sum += share;
          square += share * share;
          ++count;
        }
      }
      return std::pair{sum / count, std::sqrt(square / count - sum / count * sum / count)};
    };
    const int pixel = row * 40 + col;
    EXPECT_NEAR(features(pixel, 0), (value(row, col) - median) / 255.0, 1e-6);
    EXPECT_NEAR(features(pixel, 1), box(1).first, 1e-6);
    EXPECT_NEAR(features(pixel, 2), box(1).first - box(4).first, 1e-6);
    EXPECT_NEAR(features(pixel, 3), box(4).first - box(13).first, 1e-6);
    EXPECT_NEAR(features(pixel, 4), box(13).first, 1e-6);
    EXPECT_NEAR(features(pixel, 5), box(4).second, 1e-6);
    EXPECT_NEAR(features(pixel, 6), box(13).second, 1e-6);
    for (int f = 0; f < kPixelFeatures; ++f) EXPECT_NEAR(features(pixel, f), of_brighter(pixel, f), 1e-5);
  }
}

TEST(PixelDetectorTest, NeedsBothClasses) {
  LabelledFrame empty = BlockFrame(1);
  std::ranges::fill(empty.object.values(), std::uint8_t{0});
  EXPECT_THROW(PixelDetector({&empty}, "training"), DataError);
}

TEST(TransferTest, TestFramesWithoutABackgroundAreNamed) {
  std::vector<LabelledFrame> training, test;
  for (int i = 0; i < 2; ++i) training.push_back(BlockFrame(i + 1));
  for (int i = 0; i < 2; ++i) test.push_back(BlockFrame(i + 101));
  for (LabelledFrame& frame : test) std::ranges::fill(frame.object.values(), std::uint8_t{1});
  try {
    MeasureTransfer(training, test);
    FAIL() << "expected a refusal";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("1 test frames have"));
  }
}

TEST(TransferTest, FramesOfOneLawTrainAsWellAsEachOther) {
  std::vector<LabelledFrame> training, test;
  for (int i = 0; i < 6; ++i) training.push_back(BlockFrame(i + 1));
  for (int i = 0; i < 6; ++i) test.push_back(BlockFrame(i + 101));
  const Transfer transfer = MeasureTransfer(training, test);
  EXPECT_EQ(transfer.blocks, 5);
  EXPECT_NEAR(transfer.object_share, 450.0 / 4800.0, 1e-12);
  EXPECT_GT(transfer.simulated.average_precision.value.value(), 0.9);
  EXPECT_GT(transfer.reference.iou.value.value(), 0.7);
  EXPECT_NEAR(transfer.difference.average_precision.value.value(), 0.0, 0.03);
  EXPECT_TRUE(transfer.difference.iou.ci);
  EXPECT_TRUE(transfer.shown.empty());
  const Transfer again = MeasureTransfer(training, test);
  EXPECT_EQ(again.simulated.average_precision.value, transfer.simulated.average_precision.value);
  EXPECT_EQ(again.difference.iou.ci, transfer.difference.iou.ci);
}

TEST(TransferTest, ShownFramesHaveTheDetectionsOfTheFigures) {
  std::vector<LabelledFrame> training, test;
  for (int i = 0; i < 3; ++i) training.push_back(BlockFrame(i + 1));
  for (int i = 0; i < 4; ++i) test.push_back(BlockFrame(i + 101));
  const Transfer transfer = MeasureTransfer(training, test, {0, 1, 2, 3});
  Detection pooled, reference;
  for (const ShownDetection& shown : transfer.shown) {
    pooled += shown.of_simulated;
    reference += shown.of_reference;
    EXPECT_EQ(CountSet(Both(shown.by_simulated, test[shown.frame].object)),
              shown.of_simulated.true_positives);
    EXPECT_EQ(CountSet(shown.by_reference),
              shown.of_reference.true_positives + shown.of_reference.false_positives);
  }
  EXPECT_EQ(transfer.shown.size(), 4U);
  EXPECT_EQ(pooled.iou(), transfer.simulated.iou.value);
  EXPECT_EQ(reference.recall(), transfer.reference.recall.value);
  EXPECT_EQ(pooled.precision(), transfer.simulated.precision.value);
  EXPECT_EQ(transfer.simulated_curve.recall.back(), 1.0);
  EXPECT_DOUBLE_EQ(transfer.simulated_curve.precision.back(), transfer.object_share);
  EXPECT_GT(transfer.reference_curve.precision.front(), 0.9);
}

TEST(TransferTest, TwoTestFramesGiveFiguresAndThreeGiveIntervals) {
  const std::vector<LabelledFrame> training = {BlockFrame(1)};
  std::vector<LabelledFrame> test = {BlockFrame(101), BlockFrame(102)};
  const Transfer two = MeasureTransfer(training, test);
  EXPECT_EQ(two.blocks, 2);
  EXPECT_TRUE(two.difference.iou.value);
  EXPECT_FALSE(two.difference.iou.ci);
  test.push_back(BlockFrame(103));
  int calls = 0;
  const Transfer three = MeasureTransfer(training, test, {}, [&](int done, int total) {
    EXPECT_EQ(done, ++calls);
    EXPECT_EQ(total, 4);
  });
  EXPECT_EQ(calls, 4);
  EXPECT_TRUE(three.simulated.iou.ci);
  EXPECT_DOUBLE_EQ(three.difference.recall.value.value(),
                   three.simulated.recall.value.value() - three.reference.recall.value.value());
}

// Frames that are found well and as many that are not, in runs of two or of twelve. The figures of all frames
// are the same. In longer runs fewer frames tell something new.
TEST(TransferTest, RunsOfAlikeFramesGiveAWiderInterval) {
  const std::vector<LabelledFrame> training = {BlockFrame(1), BlockFrame(2)};
  const auto measured = [&](int run, bool has_times) {
    std::vector<LabelledFrame> test;
    for (int i = 0; i < 48; ++i) {
      test.push_back(BlockFrame(i % 2 + 101, i / run % 2 == 0 ? 20.0 : 8.0));
      if (has_times) test.back().time_s = 0.1 * i;
    }
    return MeasureTransfer(training, test).simulated.iou;
  };
  const auto width = [](const TransferFigure& figure) { return figure.ci.value().hi - figure.ci.value().lo; };
  const TransferFigure mixed = measured(2, true);
  const TransferFigure in_runs = measured(12, true);
  EXPECT_NEAR(mixed.value.value(), in_runs.value.value(), 1e-12);
  EXPECT_GT(width(in_runs), 1.5 * width(mixed));
  EXPECT_NEAR(width(measured(12, false)), width(measured(2, false)), 1e-2) << "without times";
}

TEST(TransferTest, WrongLabelsTrainWorse) {
  std::vector<LabelledFrame> training, test;
  for (int i = 0; i < 4; ++i) {
    training.push_back(BlockFrame(i + 1));
    std::ranges::reverse(training.back().object.values());
    test.push_back(BlockFrame(i + 101));
  }
  const Transfer transfer = MeasureTransfer(training, test);
  EXPECT_LT(transfer.difference.average_precision.ci.value().hi, -0.3);
  EXPECT_THROW(MeasureTransfer(training, {test[0]}), DataError);
}

// The recorded water-tank pictures with masks that people drew: a detector trained on other pictures finds
// more than guessing does.
TEST(TransferTest, RecordedObjectsAreFoundByADetectorOfOtherPictures) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_watertank");
  std::vector<LabelledFrame> synthetic, test;
  for (int i = 0; i < 6; ++i) synthetic.push_back(BlockFrame(i + 1));
  for (const testing::HumanMask& picture : testing::ReadHumanMasks(folder)) {
    LabelledFrame frame{.value = picture.image.value,
                        .object = Mask(picture.image.value.rows(), picture.image.value.cols())};
    for (std::size_t i = 0; i < picture.polar_index.size(); ++i) {
      if (picture.object[i] != 0) frame.object.values()[picture.polar_index[i]] = 1;
    }
    test.push_back(std::move(frame));
  }
  const Transfer transfer = MeasureTransfer(synthetic, test);
  EXPECT_GT(transfer.reference.average_precision.ci.value().lo, 2.0 * transfer.object_share);
  EXPECT_LT(transfer.difference.average_precision.ci.value().hi, 0.0)
      << "blocks of speckle are poor training data";
}

}  // namespace
}  // namespace sonarcal::metrics
