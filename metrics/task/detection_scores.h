// Quality of a detector's scores against labels, by histograms of the scores over object pixels and over the
// others. Scores are read in 1000 even classes of 0 .. 1, so counts of frames can be pooled.
//
//   precision, recall     tp / (tp + fp), tp / (tp + fn), where a pixel is detected above a score; both over
//                         falling scores are the precision-recall curve
//   IoU                   tp / (tp + fp + fn)
//   average precision     sum over descending scores of (R_n - R_(n-1)) P_n, without interpolation; equal
//                         scores are one step. The definition of scikit-learn's average_precision_score. The
//                         share of object pixels is what guessing gives.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

inline constexpr int kScoreClasses = 1000;

struct Detection {
  std::int64_t true_positives = 0;
  std::int64_t false_positives = 0;
  std::int64_t false_negatives = 0;

  // None if the denominator is 0.
  std::optional<double> precision() const;
  std::optional<double> recall() const;
  std::optional<double> iou() const;

  Detection& operator+=(const Detection& other);
};

// Points at falling scores, with rising recall.
struct PrecisionRecall {
  std::vector<double> recall;
  std::vector<double> precision;
};

// Min difference in recall of neighbouring points of a curve; only the last point may be nearer.
inline constexpr double kRecallStep = 0.005;

struct ScoreCounts {
  std::array<std::int64_t, kScoreClasses> object = {};
  std::array<std::int64_t, kScoreClasses> other = {};

  std::optional<double> average_precision() const;  // none without object pixels
  double object_share() const;                      // 0 without pixels
  Detection From(int lowest_class) const;           // detects pixels of this class and of higher ones
  int BestClass() const;                            // lowest class of the highest IoU
  PrecisionRecall Curve() const;                    // empty without object pixels
  ScoreCounts& operator+=(const ScoreCounts& counts);
};

// Scores are 0 .. 1; both arrays have one shape.
ScoreCounts CountScores(const Grid<float>& score, const Mask& object);

// Pixels of this class and of higher ones.
Mask DetectedFrom(const Grid<float>& score, int lowest_class);

}  // namespace sonarcal::metrics
