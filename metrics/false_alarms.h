// Realised false-alarm rates: the share of the pixels of target-free pings that a segmentation takes for
// object, beside the rate that the method states. No region is tidied, so each pixel counts for itself.
//
//   FalseAlarmCounter counter({.background_law = law}, {0.1, 0.01, 0.001});
//   for (const PolarImage& ping : pings) counter.Add(ping, nullptr);
//   for (const FalseAlarmRate& rate : counter.Rates()) ...
//
// Methods that state a rate are counted at each of the rates, the others at their settings in the options.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/bootstrap.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

struct FalseAlarmRate {
  SegmentationMethod method = SegmentationMethod::kBackgroundSigma;
  std::optional<double> stated = {};  // absent: the method states none
  std::int64_t pixels = 0;
  std::int64_t alarms = 0;
  // 95 %, bootstrap over pings in blocks (metrics/bootstrap.h); none with fewer than kBootstrapMinFrames
  // pings. Pings are taken to follow each other in time.
  std::optional<Interval> ci = {};

  double realised() const;  // 0 without pixels
};

class FalseAlarmCounter {
 public:
  // All methods in the order of SegmentationMethod, likelihood_ratio only if the options have a law. Throws
  // DataError for an option or a rate out of range.
  FalseAlarmCounter(SegmentationOptions options, const std::vector<double>& rates);

  // `region`: pixels that are tested, in the shape of the image; null: all. Throws DataError as Segment does
  // (metrics/segmentation/segmentation.h).
  void Add(const PolarImage& ping, const Mask* region);

  std::vector<FalseAlarmRate> Rates() const;

 private:
  struct Row {
    SegmentationMethod method;
    std::optional<double> stated;
    std::vector<std::int64_t> alarms;  // per ping
  };

  SegmentationOptions options_;
  std::vector<Row> rows_;
  std::vector<std::int64_t> pixels_;  // per ping
};

}  // namespace sonarcal::metrics
