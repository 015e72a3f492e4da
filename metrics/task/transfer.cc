#include "metrics/task/transfer.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

// Outcome of a detector on one test frame.
struct TestedFrame {
  ScoreCounts scores;
  Detection detection;
};

struct TrainedDetector {
  PixelDetector detector;
  int lowest_class = 0;
};

TrainedDetector Train(const std::vector<const LabelledFrame*>& frames, std::string_view use) {
  TrainedDetector trained{.detector = PixelDetector(frames, use)};
  ScoreCounts scores;
  for (const LabelledFrame* frame : frames)
    scores += CountScores(trained.detector.Score(*frame), frame->object);
  trained.lowest_class = scores.BestClass();
  return trained;
}

// `detected` receives the pixels found; null: not wanted.
TestedFrame Test(const TrainedDetector& trained, const LabelledFrame& frame, Mask* detected) {
  const Grid<float> score = trained.detector.Score(frame);
  const ScoreCounts scores = CountScores(score, frame.object);
  if (detected != nullptr) *detected = DetectedFrom(score, trained.lowest_class);
  return {.scores = scores, .detection = scores.From(trained.lowest_class)};
}

ScoreCounts Pooled(const std::vector<TestedFrame>& frames) {
  ScoreCounts pooled;
  for (const TestedFrame& frame : frames) pooled += frame.scores;
  return pooled;
}

using Values = std::array<std::optional<double>, 4>;

Values ValuesOf(const std::vector<TestedFrame>& frames, std::span<const int> indices) {
  ScoreCounts scores;
  Detection detection;
  for (const int i : indices) {
    scores += frames[i].scores;
    detection += frames[i].detection;
  }
  return {scores.average_precision(), detection.iou(), detection.precision(), detection.recall()};
}

Values Difference(const Values& a, const Values& b) {
  Values difference;
  for (std::size_t i = 0; i < difference.size(); ++i) {
    if (a[i] && b[i]) difference[i] = *a[i] - *b[i];
  }
  return difference;
}

// Consecutive frames that a draw keeps together. A frame without an object has no IoU if nothing is found.
int BlockFrames(const std::vector<TestedFrame>& simulated, const std::vector<TestedFrame>& reference) {
  std::array<std::vector<double>, 3> series;
  for (std::size_t i = 0; i < simulated.size(); ++i) {
    const std::optional<double> by_simulated = simulated[i].detection.iou();
    const std::optional<double> by_reference = reference[i].detection.iou();
    if (by_simulated) series[0].push_back(*by_simulated);
    if (by_reference) series[1].push_back(*by_reference);
    if (by_simulated && by_reference) series[2].push_back(*by_simulated - *by_reference);
  }
  int frames = 1;
  for (const std::vector<double>& each : series) frames = std::max(frames, PolitisWhiteBlockLength(each));
  return frames;
}

// Values over all frames, and over draws of frames.
struct DrawnValues {
  Values all;
  std::vector<Values> draws;

  TransferFigure Figure(std::size_t figure) const {
    TransferFigure result{.value = all[figure], .ci = {}};
    std::vector<double> values;
    for (const Values& draw : draws) {
      if (draw[figure]) values.push_back(*draw[figure]);
    }
    if (result.value && !values.empty()) result.ci = PercentileInterval95(std::move(values));
    return result;
  }
  DetectorFigures Figures() const { return {Figure(0), Figure(1), Figure(2), Figure(3)}; }
};

}  // namespace

Transfer MeasureTransfer(const std::vector<LabelledFrame>& training, const std::vector<LabelledFrame>& test,
                         const std::vector<int>& shown,
                         const std::function<void(int done, int total)>& progress) {
  const int count = static_cast<int>(test.size());
  if (count < 2) throw DataError("{} test frames, expected 2 or more: one to train on, one to test", count);
  Transfer transfer;
  transfer.training_frames = static_cast<int>(training.size());
  transfer.test_frames = count;
  transfer.blocks = std::min(kTransferBlocks, count);
  for (const int frame : shown) transfer.shown.push_back({.frame = frame});
  const auto shown_at = [&](int frame, Mask ShownDetection::*mask) -> Mask* {
    const auto found = std::ranges::find(transfer.shown, frame, &ShownDetection::frame);
    return found == transfer.shown.end() ? nullptr : &((*found).*mask);
  };
  int done = 0;
  const auto report = [&] {
    if (progress) progress(++done, transfer.blocks + 1);
  };

  std::vector<const LabelledFrame*> of_training;
  for (const LabelledFrame& frame : training) of_training.push_back(&frame);
  const TrainedDetector by_training = Train(of_training, "training");
  std::vector<TestedFrame> simulated;
  for (int i = 0; i < count; ++i)
    simulated.push_back(Test(by_training, test[i], shown_at(i, &ShownDetection::by_simulated)));
  report();

  std::vector<TestedFrame> reference;
  for (int block = 0; block < transfer.blocks; ++block) {
    const int begin = block * count / transfer.blocks;
    const int end = (block + 1) * count / transfer.blocks;
    std::vector<const LabelledFrame*> others;
    for (int i = 0; i < count; ++i) {
      if (i < begin || i >= end) others.push_back(&test[i]);
    }
    const TrainedDetector by_others = Train(others, "test");
    for (int i = begin; i < end; ++i)
      reference.push_back(Test(by_others, test[i], shown_at(i, &ShownDetection::by_reference)));
    report();
  }

  std::vector<int> all(test.size());
  for (int i = 0; i < count; ++i) all[i] = i;
  DrawnValues of_simulated{ValuesOf(simulated, all), {}};
  DrawnValues of_reference{ValuesOf(reference, all), {}};
  DrawnValues of_difference{Difference(of_simulated.all, of_reference.all), {}};
  const bool in_time =
      std::ranges::all_of(test, [](const LabelledFrame& frame) { return frame.time_s.has_value(); });
  FrameResampler resampler(count, in_time ? BlockFrames(simulated, reference) : 1);
  for (int draw = 0; count >= kBootstrapMinFrames && draw < kBootstrapDraws; ++draw) {
    const std::span<const int> indices = resampler.Next();
    of_simulated.draws.push_back(ValuesOf(simulated, indices));
    of_reference.draws.push_back(ValuesOf(reference, indices));
    of_difference.draws.push_back(Difference(of_simulated.draws.back(), of_reference.draws.back()));
  }
  const ScoreCounts scores = Pooled(simulated);
  transfer.object_share = scores.object_share();
  transfer.simulated_curve = scores.Curve();
  transfer.reference_curve = Pooled(reference).Curve();
  for (ShownDetection& each : transfer.shown) {
    each.of_simulated = simulated[each.frame].detection;
    each.of_reference = reference[each.frame].detection;
  }
  transfer.simulated = of_simulated.Figures();
  transfer.reference = of_reference.Figures();
  transfer.difference = of_difference.Figures();
  return transfer;
}

}  // namespace sonarcal::metrics
