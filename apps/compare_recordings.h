// Two recordings through the metrics, frame by frame: what `compare` writes and what `fit` judges itself by.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/types/recording.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal {

struct CompareRecordingsOptions {
  CompareOptions compare;
  // Grey levels as displayed, whatever dB the two scales state. A fit needs it: the paper's dB range is one
  // of its parameters, no property of the recording.
  bool as_displayed = false;
  bool noise_floor = true;  // measure it, which compares the real recording with itself
  // To compare, same number in both; empty: all, and both must have as many.
  std::vector<int> frames = {};
  // With compare.object: by frame, where the object is searched (apps/scene_geometry.h, ObjectBoxes).
  std::map<int, PixelBox> boxes = {};
  std::function<void(int frames_done)> progress = {};
};

// Samples that hold a measurement in both; absent: all, or the two have other axes, and nothing to compare.
std::optional<Mask> ValidInBoth(const RecordingInfo& real, const RecordingInfo& simulated);

// Told of each pair as it is compared. `metrics.masks` is set.
using OnComparedFrame =
    std::function<void(const PolarImage& real, const PolarImage& simulated, const FrameMetrics& metrics)>;

// The frames that CompareRecordings compares: those asked for, or all. Throws DataError where they are not in
// both.
std::vector<int> FramesToCompare(const RecordingSource& real, const RecordingSource& simulated,
                                 const std::vector<int>& asked);

// Throws DataError where the recordings do not have the same frames, or a pair can't be compared.
MetricsReport CompareRecordings(const RecordingSource& real, const RecordingSource& simulated,
                                const CompareRecordingsOptions& options,
                                const OnComparedFrame& on_frame = {});

// A recording's name for people: its source, and that it is synthetic where it is.
std::string RecordingName(const RecordingInfo& info);

// Numbers of a few frames that show a comparison fairly: those with the lowest, the middle and the highest
// intensity error in the polar view, in the order of the recording. At most three.
std::vector<int> TellingFrames(const MetricsReport& report);

// At most `count` of `frames`, evenly spread and in their order, the first and the last among them.
std::vector<int> EvenlySpread(const std::vector<int>& frames, int count);

}  // namespace sonarcal
