// Ablation study: evaluates the parts of the acoustic model one after the other on held-out frames.
//
// Adds to calib/selection/explanation.h the figures that `compare` reports, and a map of the causes of the
// bright pixels in the held-out frames (sim/gathered/echo_causes.h).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/workflow/compare.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/listener.h"
#include "apps/workflow/rays/ray_options.h"
#include "calib/parameters/fit_config.h"
#include "calib/selection/explanation.h"
#include "core/types/frame_list.h"
#include "core/types/option.h"
#include "core/types/recording.h"
#include "core/types/scene.h"

namespace sonarcal::workflow {

struct ExplainRecordingOptions {
  RayOptions rays{sim::Sampling::kBeams};
  std::optional<std::vector<int>> held_out = {};  // absent: the last third
  calib::FitOptions fit = {};
  metrics::CompareOptions comparison = {};
  bool hold_noise = false;  // as in ExplainOptions
  bool poses = false;
  std::function<void(const std::string& sentence)> on_note = {};
  std::function<void(calib::ExplainedPart)> on_step = {};
};

// Margin around the object found in the recorded image, in pixels.
inline constexpr int kAboutBins = 20;
inline constexpr int kAboutBeams = 4;

// Agreement of one step with held-out frames. Errors are mean absolute differences between the expected image
// and the recorded one, as fractions of full scale:
//
//   intensity_error  whole polar image
//   about_error      around the object found in the recorded image, the same pixels for all steps
//   union_error      object found in either image
//   overlap_error    object found in both images
//
// Occupancy uses the expected image, and from step `speckle` on a speckled sample.
struct StepFigures {
  std::optional<double> intensity_error = {};
  std::optional<double> about_error = {};
  std::optional<double> union_error = {};
  std::optional<double> overlap_error = {};
  std::optional<double> iou = {};  // pooled over frames
  std::optional<double> ns_over_nr = {};
};

// Evaluation of the steps on some of the held-out frames. Vectors have one element per step.
struct JudgedSteps {
  std::vector<int> frames;
  std::vector<StepFigures> figures = {};
  std::vector<double> nats_per_pixel = {};
  std::vector<calib::LikelihoodDifference> gain = {};
  // Error of the median image (full scale 1), and its change by a step. A verdict must not contradict it.
  std::vector<double> median_error = {};
  std::vector<calib::LikelihoodDifference> error_change = {};
  std::vector<calib::Verdict> verdict = {};
  // Difference between a speckled sample of the last step's model and its expected image, over the whole
  // image and around the object: the error that remains because of speckle and noise.
  std::optional<double> floor_error = {};
  std::optional<double> about_floor_error = {};
};

// Causes of the recorded pixels of a frame, as indices into ExplainedRecording::cause_names.
struct CauseMap {
  int index = 0;             // frame index
  Grid<std::uint8_t> cause;  // range_bins x beams
  Grid<int> lobe_of;         // EchoCauses::lobe_of where `cause` is a side lobe in azimuth, else -1
  PolarImage recorded;
};

struct ExplainedRecording {
  RayGridSize rays;
  calib::FrameSplit split;
  calib::Explanation explanation;
  JudgedSteps judged;  // over all held-out frames together
  // Metrics of the last step on these frames, as `compare` computes them: of its expected image, and of a
  // speckled sample if the step models speckle.
  std::optional<metrics::MetricsReport> metrics_after = {};
  std::optional<metrics::MetricsReport> sample_metrics_after = {};
  std::vector<JudgedSteps> by_frame;  // per held-out frame
  // The first two names belong to kNotBright and kUnexplained.
  std::vector<std::string> cause_names;
  std::vector<CauseMap> maps;        // per held-out frame
  std::vector<double> cause_shares;  // share of the bright pixels of all maps, per name; the first is 0
};

inline constexpr std::uint8_t kNotBright = 0;
inline constexpr std::uint8_t kUnexplained = 1;

// Classes of pixels, from power averaged over a box of three widths of beam and pulse. Bright: the recorded
// mean exceeds kBrightRatio times the noise floor. Unexplained: bright, and the recorded mean exceeds
// kUnexplainedRatio times the expected mean. All other bright pixels have the cause with the largest expected
// power.
inline constexpr double kBrightRatio = 2.0;
inline constexpr double kUnexplainedRatio = 3.0;

// Throws DataError if the recording, the scene or the parameters cannot be used.
ExplainedRecording ExplainRecording(const RecordingSource& recording, const Scene& scene,
                                    const ParameterSet& given, const ExplainRecordingOptions& options);

struct ExplainOptions {
  FrameList held_out = {};  // empty: the last third
  bool hold_noise = false;
  bool poses = false;
  int max_iterations = 60;
  RayOptions rays{sim::Sampling::kBeams};
  ComparisonOptions comparison = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "held_out",
                     .help =
                         "Frames that are not fitted but evaluated, counted from 0; also ranges A:B, up to, "
                         "but not including, B, A: up to the last frame, and :B",
                     .by_default = "the last third"},
          self.held_out);
    visit(OptionInfo{.name = "hold_noise",
                     .help = "Keeps the noise floor of the parameters, such as fit --noise-only found it, "
                             "instead of fitting its level"},
          self.hold_noise);
    visit(OptionInfo{.name = "poses", .help = "Refines the pose of each frame as the last part; slow"},
          self.poses);
    RayOptions::Visit(self.rays, visit);
    visit(OptionInfo{.name = "max_iterations",
                     .help = "Max number of iterations of each solver run",
                     .min = 1,
                     .max = 100000},
          self.max_iterations);
    ComparisonOptions::Visit(self.comparison, visit);
  }

  // Options of ExplainRecording, for images with these axes.
  ExplainRecordingOptions For(const RecordingSource& recording) const;
};

// Throws UsageError for options that contradict each other, DataError if the recording, the scene or the
// parameters cannot be used, calib::FitStopped if the listener stops it.
ExplainedRecording Explain(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                           const ExplainOptions& options = {}, const Listener& listener = {});

}  // namespace sonarcal::workflow
