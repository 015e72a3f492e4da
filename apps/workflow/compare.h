// Compares a simulated recording with a real one: all metrics, per frame and aggregated.
//
//   const Comparison comparison = Compare(*real, *simulated);
//   std::cout << metrics::MetricsJson(comparison.metrics);
//
// CompareRecordings is the inner part. `compare` writes its result, and `fit` uses it for the evaluation.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/workflow/comparison_options.h"
#include "apps/workflow/listener.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "metrics/json/comparison_part.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::workflow {

struct CompareRecordingsOptions {
  metrics::CompareOptions compare;
  // Compares grey levels as displayed and ignores the dB scales that the recordings state. A fit needs this:
  // the dB range of the paper's model is a fitted parameter, not a property of the recording.
  bool as_displayed = false;
  bool noise_floor = true;  // measures the noise floor by comparing the real recording with itself
  // Frame numbers, the same in both recordings. Empty: all; both recordings must then have the same count.
  std::vector<int> frames = {};
  // With compare.object: search box of the object per frame (apps/workflow/scene_geometry.h, ObjectBox).
  std::map<int, metrics::PixelBox> boxes = {};
  // Measurements of the frames that other runs made. No pair of images is then compared.
  const metrics::ComparisonPart* measured = nullptr;
  std::function<void(int frames_done)> progress = {};
};

// Samples that hold a measurement in both recordings. Absent: all samples do, or the axes differ and the
// recordings cannot be compared.
std::optional<Mask> ValidInBoth(const RecordingInfo& real, const RecordingInfo& simulated);

// Receives each pair after its comparison. `metrics.masks` is set.
using OnComparedFrame = std::function<void(const PolarImage& real, const PolarImage& simulated,
                                           const metrics::FrameMetrics& metrics)>;

// Frames whose search box of the object is needed: those of `compared`, and those that the noise floor
// compares with the next frame, because no recorded poses say that the sonar moved between them.
std::set<int> FramesWithBoxes(const RecordingSource& real, const std::vector<int>& compared);

// Returns the frames that CompareRecordings compares: `asked`, or all if it is empty. Throws DataError if a
// frame is missing in one recording.
std::vector<int> FramesToCompare(const RecordingSource& real, const RecordingSource& simulated,
                                 const std::vector<int>& asked);

// Throws DataError if the recordings have different frames or if a pair cannot be compared.
metrics::MetricsReport CompareRecordings(const RecordingSource& real, const RecordingSource& simulated,
                                         const CompareRecordingsOptions& options,
                                         const OnComparedFrame& on_frame = {});

// A pair of frames with its metrics. `metrics.masks` is set.
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

// Name of a recording for display: its source, and "synthetic" if it is simulated.
std::string RecordingName(const RecordingInfo& info);

// Returns the numbers of at most three representative frames: those with the lowest, the median and the
// highest intensity error in the polar view, in the order of the recording.
std::vector<int> RepresentativeFrames(const metrics::MetricsReport& report);

// Returns at most `count` of `frames`, evenly spread and in their order. Includes the first and the last.
std::vector<int> EvenlySpread(const std::vector<int>& frames, int count);

struct CompareOptions {
  std::vector<int> frames = {};  // same numbers in both; empty: all, and both must have equally many
  ComparisonOptions comparison = {};
  int sweep_steps = 21;
  std::optional<Interval> sweep_range = {};
  bool as_displayed = false;
  FromFile<std::string> against = {};  // text of an earlier metrics.json
  FromFile<ParameterSet> params = {};
  bool whole = true;  // false: a part. Its merge measures the noise floor and compares the poses.
  // All frames, as other runs measured them (metrics/json/comparison_part.h); null: they are compared here.
  const metrics::ComparisonPart* measured = nullptr;

  // Omits `frames`, which on the command line is a text of ranges, and what serves parts of a comparison.
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

// `scene`, may be null: needed for residuals by incidence angle and material (`residuals_by_scene`) and for
// the box of the object. `on_frame` receives each pair of images with masks. Throws UsageError for options
// that contradict each other, DataError if frames are missing or cannot be compared.
Comparison Compare(const RecordingSource& real, const RecordingSource& simulated,
                   const CompareOptions& options = {}, const Scene* scene = nullptr,
                   bool residuals_by_scene = true, const Listener& listener = {},
                   const OnComparedFrame& on_frame = {});

}  // namespace sonarcal::workflow
