// Ablation study: evaluates the parts of the acoustic model one after the other on held-out frames.
//
// What each part of the acoustic model is worth for a recording (calib/selection/explanation.h), in the
// figures that `compare` has, and what the bright cells of the frames held out come from
// (sim/gathered/echo_causes.h).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/workflow/compare.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/listener.h"
#include "apps/workflow/ray_options.h"
#include "calib/parameters/fit_config.h"
#include "calib/selection/explanation.h"
#include "core/types/option.h"
#include "core/types/recording.h"
#include "core/types/scene.h"

namespace sonarcal::workflow {

struct ExplainRecordingOptions {
  RayOptions rays{sim::Sampling::kBeams};
  std::optional<std::vector<int>> held_out = {};  // absent: the last third
  calib::FitOptions fit = {};
  metrics::CompareOptions comparison = {};
  bool hold_noise = false;  // as ExplainOptions has it
  bool poses = false;
  std::function<void(const std::string& sentence)> on_note = {};
  std::function<void(calib::ExplainedPart)> on_step = {};
};

// About the object as found in the recorded image: this far beyond it, in pixels.
inline constexpr int kAboutBins = 20;
inline constexpr int kAboutBeams = 4;

// A step's agreement with frames held out. Errors are mean absolute differences of the expected image, of
// full scale: over the whole polar image; about the object as found in the recorded image, the same pixels
// for all steps; and over the object as found in either image or in both. Occupancy is that of the expected
// image too, from `speckle` on of a draw.
struct StepFigures {
  std::optional<double> intensity_error = {};
  std::optional<double> about_error = {};
  std::optional<double> union_error = {};
  std::optional<double> overlap_error = {};
  std::optional<double> iou = {};  // pooled over frames
  std::optional<double> ns_over_nr = {};
};

// The steps as some of the frames held out judge them; vectors are by step.
struct JudgedSteps {
  std::vector<int> frames;
  std::vector<StepFigures> figures = {};
  std::vector<double> nats_per_pixel = {};
  std::vector<calib::LikelihoodDifference> gain = {};
  // Error of the median image (full scale 1), and its change by a step. A verdict must not contradict it.
  std::vector<double> median_error = {};
  std::vector<calib::LikelihoodDifference> error_change = {};
  std::vector<calib::Verdict> verdict = {};
  // What a draw of the last step's model itself differs from its expected image by, over the whole image and
  // about the object: the error that is left to speckle and noise.
  std::optional<double> floor_error = {};
  std::optional<double> about_floor_error = {};
};

// What the recorded cells of a frame come from, as indices into ExplainedRecording::cause_names.
struct CauseMap {
  int index = 0;             // of the frame
  Grid<std::uint8_t> cause;  // range_bins x beams
  Grid<int> lobe_of;         // EchoCauses::lobe_of where `cause` is a side lobe in azimuth, else -1
  PolarImage recorded;
};

struct ExplainedRecording {
  RayGridSize rays;
  calib::FrameSplit split;
  calib::Explanation explanation;
  JudgedSteps judged;  // by all frames held out together
  // Metrics of the last step on these frames, as `compare` computes them: of its expected image, and of a
  // speckled sample if the step models speckle.
  std::optional<metrics::MetricsReport> metrics_after = {};
  std::optional<metrics::MetricsReport> sample_metrics_after = {};
  std::vector<JudgedSteps> by_frame;  // by each alone
  // The first two are kNotBright and kUnexplained.
  std::vector<std::string> cause_names;
  std::vector<CauseMap> maps;        // of the frames held out
  std::vector<double> cause_shares;  // of the bright cells of all maps, by name; the first is 0
};

inline constexpr std::uint8_t kNotBright = 0;
inline constexpr std::uint8_t kUnexplained = 1;

// Bright is a pixel about which, over three widths of beam and pulse, the recorded power is on average twice
// the noise floor; unexplained one of these about which it is `kUnexplainedRatio` times what is expected. All
// others have the cause that gives most of what is expected there.
inline constexpr double kBrightRatio = 2.0;
inline constexpr double kUnexplainedRatio = 3.0;

// Throws DataError where the recording, the scene or the parameters can't be used.
ExplainedRecording ExplainRecording(const RecordingSource& recording, const Scene& scene,
                                    const ParameterSet& given, const ExplainRecordingOptions& options);

struct ExplainOptions {
  std::vector<int> held_out = {};  // empty: the last third
  bool hold_noise = false;
  bool poses = false;
  int max_iterations = 60;
  RayOptions rays{sim::Sampling::kBeams};
  ComparisonOptions comparison = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "held_out",
                     .help = "Frames that are not fitted but evaluated, counted from 0",
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
  ExplainRecordingOptions For(const PolarAxes& axes) const;
};

// Throws UsageError for options that contradict each other, DataError if the recording, the scene or the
// parameters cannot be used, calib::FitStopped if the listener stops it.
ExplainedRecording Explain(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                           const ExplainOptions& options = {}, const Listener& listener = {});

}  // namespace sonarcal::workflow
