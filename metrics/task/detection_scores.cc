#include "metrics/task/detection_scores.h"

#include <algorithm>

namespace sonarcal::metrics {
namespace {

std::optional<double> KnownShare(std::int64_t part, std::int64_t of) {
  if (of == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(of);
}

int ClassOf(float score) {
  return std::clamp(static_cast<int>(score * kScoreClasses), 0, kScoreClasses - 1);
}

}  // namespace

std::optional<double> Detection::precision() const {
  return KnownShare(true_positives, true_positives + false_positives);
}

std::optional<double> Detection::recall() const {
  return KnownShare(true_positives, true_positives + false_negatives);
}

std::optional<double> Detection::iou() const {
  return KnownShare(true_positives, true_positives + false_positives + false_negatives);
}

Detection& Detection::operator+=(const Detection& other) {
  true_positives += other.true_positives;
  false_positives += other.false_positives;
  false_negatives += other.false_negatives;
  return *this;
}

std::optional<double> ScoreCounts::average_precision() const {
  std::int64_t objects = 0;
  for (const std::int64_t count : object) objects += count;
  if (objects == 0) return std::nullopt;
  double sum = 0.0;
  std::int64_t found = 0;
  std::int64_t detected = 0;
  for (int i = kScoreClasses - 1; i >= 0; --i) {
    found += object[i];
    detected += object[i] + other[i];
    if (object[i] > 0) {
      sum += static_cast<double>(object[i]) * static_cast<double>(found) / static_cast<double>(detected);
    }
  }
  return sum / static_cast<double>(objects);
}

double ScoreCounts::object_share() const {
  const Detection all = From(0);
  return all.precision().value_or(0.0);
}

Detection ScoreCounts::From(int lowest_class) const {
  Detection detection;
  for (int i = 0; i < kScoreClasses; ++i) {
    if (i >= lowest_class) {
      detection.true_positives += object[i];
      detection.false_positives += other[i];
    } else {
      detection.false_negatives += object[i];
    }
  }
  return detection;
}

int ScoreCounts::BestClass() const {
  int best = 0;
  double highest = -1.0;
  for (int i = 0; i < kScoreClasses; ++i) {
    const double iou = From(i).iou().value_or(0.0);
    if (iou > highest) {
      highest = iou;
      best = i;
    }
  }
  return best;
}

PrecisionRecall ScoreCounts::Curve() const {
  PrecisionRecall curve;
  const Detection all = From(0);
  if (all.true_positives == 0) return curve;
  std::int64_t found = 0;
  std::int64_t detected = 0;
  for (int i = kScoreClasses - 1; i >= 0; --i) {
    if (object[i] + other[i] == 0) continue;
    found += object[i];
    detected += object[i] + other[i];
    const double recall = static_cast<double>(found) / static_cast<double>(all.true_positives);
    const bool is_last = detected == all.true_positives + all.false_positives;
    if (!curve.recall.empty() && recall < curve.recall.back() + kRecallStep && !is_last) continue;
    curve.recall.push_back(recall);
    curve.precision.push_back(static_cast<double>(found) / static_cast<double>(detected));
  }
  return curve;
}

ScoreCounts& ScoreCounts::operator+=(const ScoreCounts& counts) {
  for (int i = 0; i < kScoreClasses; ++i) {
    object[i] += counts.object[i];
    other[i] += counts.other[i];
  }
  return *this;
}

ScoreCounts CountScores(const Grid<float>& score, const Mask& object) {
  ScoreCounts counts;
  for (std::size_t i = 0; i < score.size(); ++i) {
    ++(object.values()[i] != 0 ? counts.object : counts.other)[ClassOf(score.values()[i])];
  }
  return counts;
}

Mask DetectedFrom(const Grid<float>& score, int lowest_class) {
  Mask detected(score.rows(), score.cols());
  std::ranges::transform(score.values(), detected.values().begin(), [lowest_class](float value) {
    return std::uint8_t{ClassOf(value) >= lowest_class};
  });
  return detected;
}

}  // namespace sonarcal::metrics
