#include "metrics/task/detection_scores.h"

#include <algorithm>

namespace sonarcal::metrics {
namespace {

std::optional<double> Share(std::int64_t part, std::int64_t of) {
  if (of == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(of);
}

}  // namespace

std::optional<double> Detection::precision() const {
  return Share(true_positives, true_positives + false_positives);
}

std::optional<double> Detection::recall() const {
  return Share(true_positives, true_positives + false_negatives);
}

std::optional<double> Detection::iou() const {
  return Share(true_positives, true_positives + false_positives + false_negatives);
}

Detection& Detection::operator+=(const Detection& detection) {
  true_positives += detection.true_positives;
  false_positives += detection.false_positives;
  false_negatives += detection.false_negatives;
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
    const int in = std::clamp(static_cast<int>(score.values()[i] * kScoreClasses), 0, kScoreClasses - 1);
    ++(object.values()[i] != 0 ? counts.object : counts.other)[in];
  }
  return counts;
}

}  // namespace sonarcal::metrics
