// Compares a simulated recording with a real one: all metrics, by frame and together.
//
//   const Comparison comparison = Compare(*real, *simulated);
//   std::cout << metrics::MetricsJson(comparison.metrics);
//
// Two recordings through the metrics, frame by frame: what `compare` writes and what `fit` judges itself by.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/workflow/comparison_options.h"
#include "apps/workflow/listener.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::workflow {

struct CompareRecordingsOptions {
  metrics::CompareOptions compare;
  // Grey levels as displayed, whatever dB the two scales state. A fit needs it: the paper's dB range is one
  // of its parameters, no property of the recording.
  bool as_displayed = false;
  bool noise_floor = true;  // measure it, which compares the real recording with itself
  // To compare, same number in both; empty: all, and both must have as many.
  std::vector<int> frames = {};
  // With compare.object: by frame, where the object is searched (apps/workflow/scene_geometry.h, ObjectBoxes).
  std::map<int, metrics::PixelBox> boxes = {};
  std::function<void(int frames_done)> progress = {};
};

// Samples that hold a measurement in both; absent: all, or the two have other axes, and nothing to compare.
std::optional<Mask> ValidInBoth(const RecordingInfo& real, const RecordingInfo& simulated);

// Told of each pair as it is compared. `metrics.masks` is set.
using OnComparedFrame = std::function<void(const PolarImage& real, const PolarImage& simulated,
                                           const metrics::FrameMetrics& metrics)>;

// The frames that CompareRecordings compares: those asked for, or all. Throws DataError where they are not in
// both.
std::vector<int> FramesToCompare(const RecordingSource& real, const RecordingSource& simulated,
                                 const std::vector<int>& asked);

// Throws DataError where the recordings do not have the same frames, or a pair can't be compared.
metrics::MetricsReport CompareRecordings(const RecordingSource& real, const RecordingSource& simulated,
                                         const CompareRecordingsOptions& options,
                                         const OnComparedFrame& on_frame = {});

// A pair of frames with its metrics, `metrics.masks` set.
struct ComparedFrame {
  PolarImage real;
  PolarImage simulated;
  metrics::FrameMetrics metrics;
};

// Compares the listed frames again and hands each to `on_frame`. `options` are those of the first comparison.
// Images are not kept from the first comparison because memory would grow with the recording.
void CompareAgain(const RecordingSource& real, const RecordingSource& simulated,
                  const CompareRecordingsOptions& options, const std::vector<int>& frames,
                  const OnComparedFrame& on_frame);

// As above, returns the images.
std::vector<ComparedFrame> ComparedFrames(const RecordingSource& real, const RecordingSource& simulated,
                                          const CompareRecordingsOptions& options,
                                          const std::vector<int>& frames);

// Returns the frame numbers of `always` plus others of the report, spread evenly, `count` in all, in
// increasing order. Returns more than `count` if `always` has more.
std::vector<int> SpreadFrames(const metrics::MetricsReport& report, const std::vector<int>& always,
                              std::size_t count);

// A recording's name for people: its source, and that it is synthetic where it is.
std::string RecordingName(const RecordingInfo& info);

// Numbers of a few frames that show a comparison fairly: those with the lowest, the middle and the highest
// intensity error in the polar view, in the order of the recording. At most three.
std::vector<int> TellingFrames(const metrics::MetricsReport& report);

// At most `count` of `frames`, evenly spread and in their order, the first and the last among them.
std::vector<int> EvenlySpread(const std::vector<int>& frames, int count);

struct CompareOptions {
  std::vector<int> frames = {};  // same numbers in both; empty: all, and both must have as many
  ComparisonOptions comparison = {};
  int sweep_steps = 21;
  std::optional<Interval> sweep_range = {};
  bool as_displayed = false;
  FromFile<std::string> against = {};  // text of an earlier metrics.json
  FromFile<ParameterSet> params = {};

  // `frames` is not among them: on the command line it is a text of ranges.
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    ComparisonOptions::Visit(self.comparison, visit);
    visit(OptionInfo{.name = "sweep_steps",
                     .help = "Number of threshold settings for the curves of each ratio; 0 for no curves",
                     .min = 0},
          self.sweep_steps);
    visit(OptionInfo{.name = "sweep_range",
                     .help = "Lowest and highest threshold setting, in the unit of the segmentation method",
                     .by_default = "by method"},
          self.sweep_range);
    visit(OptionInfo{.name = "as_displayed",
                     .help = "Compares grey levels although the recordings state different dB scales"},
          self.as_displayed);
    visit(OptionInfo{.name = "against",
                     .help = "metrics.json of an earlier comparison: states what got better or worse, and "
                             "whether by more than the noise"},
          self.against);
    visit(OptionInfo{.name = "params",
                     .help = "Fitted parameters. Speckle drawn from them around the simulated frames gives a "
                             "noise floor for recordings without repeated frames of a static scene"},
          self.params);
  }
};

struct Comparison {
  CompareRecordingsOptions options;  // as used
  std::vector<int> frames;           // as compared
  metrics::MetricsReport metrics;    // with residuals
};

// `scene`: for residuals by incidence angle and material (`residuals_by_scene`) and for the box of the object;
// may be null. `on_frame` receives each pair of images with masks. Throws UsageError for options that
// contradict each other, DataError if frames are missing or cannot be compared.
Comparison Compare(const RecordingSource& real, const RecordingSource& simulated,
                   const CompareOptions& options = {}, const Scene* scene = nullptr,
                   bool residuals_by_scene = true, const Listener& listener = {},
                   const OnComparedFrame& on_frame = {});

}  // namespace sonarcal::workflow
