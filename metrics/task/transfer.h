// Figure of a task: a detector trained on simulated frames and tested on recorded ones, beside the same
// detector trained on recorded frames (metrics/task/pixel_detector.h). The nearer the two, the better the
// simulated frames serve as training data.
//
// No frame is tested by a detector that was trained on it. The recorded frames are split into blocks of
// consecutive frames, because neighbours resemble each other. The reference detector of a block is trained on
// all other blocks. The score above which a pixel is detected is the one with the highest IoU on the training
// frames.
//
// Figures pool the pixels of all test frames. Intervals: percentile bootstrap over test frames
// (metrics/bootstrap.h). If every test frame has a time, blocks of consecutive frames are drawn. Their length
// is the longest that the IoU of single frames needs: of each detector, and of their difference. Both
// detectors have the same draws, so intervals of differences are those of pairs. Intervals do not contain the
// variation of training.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "metrics/bootstrap.h"
#include "metrics/task/detection_scores.h"
#include "metrics/task/pixel_detector.h"

namespace sonarcal::metrics {

inline constexpr int kTransferBlocks = 5;  // fewer if there are fewer test frames

struct TransferFigure {
  std::optional<double> value;
  std::optional<Interval> ci;  // 95 %; none with fewer than kBootstrapMinFrames test frames
};

struct DetectorFigures {
  TransferFigure average_precision;
  TransferFigure iou;
  TransferFigure precision;
  TransferFigure recall;
};

// Test frame with the pixels that each detector finds.
struct ShownDetection {
  int frame = 0;  // number among the test frames
  Mask by_simulated = {};
  Mask by_reference = {};
  Detection of_simulated = {};
  Detection of_reference = {};
};

struct Transfer {
  int training_frames = 0;
  int test_frames = 0;
  int blocks = 0;
  double object_share = 0.0;  // of the test pixels: the average precision of guessing
  DetectorFigures simulated;  // trained on the training frames
  DetectorFigures reference;  // trained on other test frames
  // simulated - reference; 0 or more: the training frames serve as well as recorded ones
  DetectorFigures difference;
  PrecisionRecall simulated_curve;
  PrecisionRecall reference_curve;
  std::vector<ShownDetection> shown;
};

// Throws DataError if there are fewer than two test frames or if a detector cannot be trained. `shown`: test
// frames whose detected pixels are kept, in rising order. `progress` may be empty.
Transfer MeasureTransfer(const std::vector<LabelledFrame>& training, const std::vector<LabelledFrame>& test,
                         const std::vector<int>& shown = {},
                         const std::function<void(int done, int total)>& progress = {});

}  // namespace sonarcal::metrics
