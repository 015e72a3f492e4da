// Trains a detector on labelled recordings and tests it on others (metrics/task/transfer.h;
// docs/guide/transfer.md).
//
//   const RecordingTransfer result = Transfer({.training = {simulated.get()}, .training_masks = {},
//                                              .test = {real.get()}, .test_masks = {masks.get()}},
//                                             {.object = "mockup"});
//   result.transfer.difference.iou.value
#pragma once

#include <string>
#include <vector>

#include "apps/workflow/listener.h"
#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/option.h"
#include "core/types/recording.h"
#include "metrics/task/transfer.h"

namespace sonarcal::workflow {

struct TransferOptions {
  std::string object = {};  // empty: masks label the training frames

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "object",
                     .help = "Material of the object, which the scene of each training recording labels",
                     .by_default = "masks label the training frames",
                     .type = "MATERIAL"},
          self.object);
  }
};

// Recordings, which the caller keeps. Masks: one recording for each of the others.
struct TransferRecordings {
  std::vector<const RecordingSource*> training;
  std::vector<const RecordingSource*> training_masks = {};  // empty with an object
  std::vector<const RecordingSource*> test;
  std::vector<const RecordingSource*> test_masks;
};

// Test frame with what is labelled and what is found.
struct TestedFrame {
  std::string recording;
  int frame = 0;  // of that recording
  PolarImage image;
  Mask object;
  metrics::ShownDetection found;
};

struct RecordingTransfer {
  std::vector<std::string> training;  // names of the recordings
  std::vector<std::string> test;
  bool training_is_synthetic = false;  // all of its recordings are
  bool test_is_synthetic = false;      // one of its recordings or more is
  metrics::Transfer transfer;
  std::vector<TestedFrame> shown;  // at most kShownTestFrames with an object, evenly spread
};

inline constexpr int kShownTestFrames = 3;

// Throws UsageError if masks or object lack or contradict each other, DataError if recordings cannot be used.
RecordingTransfer Transfer(const TransferRecordings& recordings, const TransferOptions& options,
                           const Listener& listener = {});

}  // namespace sonarcal::workflow
