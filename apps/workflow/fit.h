// Fits the parameters of an image model to a recording with poses.
//
//   const RecordingFit fit = Fit(*recording, scene, parameters, {.free = {"materials"}});
//   if (fit.fit.usable) data_io::WriteParameters("params.json", fit.fit.parameters);
//
// Traces, fits the paper's or the acoustic model and evaluates on held-out frames. `fit` writes the result as
// files, other commands report it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/workflow/compare.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/frame_choice.h"
#include "apps/workflow/listener.h"
#include "apps/workflow/materials/material_options.h"
#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/still_poses.h"
#include "calib/fit.h"
#include "calib/parameters/fit_config.h"
#include "calib/selection/model_choice.h"
#include "core/sonars/sonar_geometry.h"
#include "core/types/frame_list.h"
#include "core/types/option.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "core/types/words.h"
#include "data_io/pose_io.h"

namespace sonarcal::workflow {

// Whether the beams of a frame have the poses of their pings, if they are known.
enum class PingUse { kUse, kIgnore };
constexpr auto WordsOf(std::type_identity<PingUse>) {
  return Words<PingUse, 2>{{{"use", PingUse::kUse}, {"ignore", PingUse::kIgnore}}};
}
inline constexpr const char* kPingUseHelp =
    "Poses of the pings that make a frame, if the recording states pings and motion: use (each beam has the "
    "pose of its ping; acoustic model) or ignore (all beams have the pose of the frame)";

struct FitRecordingOptions {
  RayOptions rays;  // without a sampling: that of the recording if it states one, else beams
  calib::FitConfig config;
  calib::FitOptions fit;
  // With `object`, all figures use the boxes at the fitted poses, also those before the fit.
  metrics::CompareOptions comparison;
  // Pixels that the fit uses, range_bins x beams; absent: all. Excludes objects that the scene does not
  // contain.
  std::optional<Mask> pixels = {};
  // Acoustic model: properties that the likelihood of the held-out frames selects before the fit, in this
  // order.
  std::vector<calib::ChoiceAxis> choose = {};
  // True parameters of a simulated recording, reported beside the fitted ones. Absent: those of ReadTruth.
  std::optional<ParameterSet> truth = {};
  PingUse pings = PingUse::kUse;
  bool keep_images = true;  // keeps images of at most 16 compared frames for pictures
  std::function<void(int frames_done, int frames_in_all)> on_trace = {};  // after each frame
  std::function<void(const std::string& sentence)> on_note = {};          // messages for the user
};

// Incidence angles at which a material is seen in the frames used, without the rarest 0.1 % at either end.
struct IncidenceRange {
  double low_deg = 0.0;
  double high_deg = 0.0;
};

struct RecordingFit {
  RayGridSize rays;        // as cast
  RayOptions ray_options;  // with a sampling and a weight
  calib::FitResult fit;    // with a complete report: frames, rays, times
  ParameterSet initial;
  // Poses of all frames of the recording if the fit moved poses. Empty: as recorded.
  std::vector<data_io::TimedPose> poses = {};
  SonarGeometry geometry = {};                 // as declared if not free
  std::optional<Scene> scene = {};             // with objects where they were found; absent if none was free
  std::map<std::string, IncidenceRange> seen;  // per material; absent: not seen
  // Metrics of the expected images with the initial and the fitted parameters, on the held-out frames. If no
  // frame is held out, on the frames used.
  bool judged_on_held_out = true;
  metrics::MetricsReport before;
  metrics::MetricsReport after;
  // As `before` and `after`, for a speckled sample instead of the expected image. Occupancy and distributions
  // are read from these, because a detector needs speckle to behave as on a recording. Acoustic model only.
  std::optional<metrics::MetricsReport> sample_before = {};
  std::optional<metrics::MetricsReport> sample_after = {};
  // Metrics of two speckled samples of the fitted model against each other, on a few of the evaluated frames:
  // the agreement that a recording of the model itself would reach. Acoustic model only.
  std::optional<metrics::MetricsReport> sample_pair = {};
  std::optional<calib::ModelChoice> choice = {};  // absent if no choice was requested
  // Levels of repeated poses, fitted or held out, beside those of the fit. Acoustic model only.
  StillPoses still = {};
  // Weights of pixels that do not match the scene: per frame used, one weight per pixel. Empty: all weights
  // are 1.
  std::vector<Grid<float>> weights = {};
  PolarAxes axes = {};  // of the weights
  // First frames with streaks of a saturated receiver, by index. Empty without
  // FitRecordingOptions::keep_images.
  std::map<int, PolarImage> streaked_frames = {};
  // Images and metrics of compared frames: at most three examples before the fit; these and others after it.
  // Empty without FitRecordingOptions::keep_images.
  std::vector<ComparedFrame> frames_before = {};
  std::vector<ComparedFrame> frames_after = {};
};

// Replaces the display in `parameters` by the one that the recording states, if any. Returns a message about
// the change, or an empty text.
std::string TakeDisplay(const ImageScale& scale, ParameterSet& parameters);

// Simulation options with the rays of the acoustic model, in the number that `rays` asks for. Images are
// speckled samples unless the expected image is requested.
sim::SimulationOptions AcousticSimulation(const RayOptions& rays, const SonarModel& sonar, const Water& water,
                                          const ParameterSet& parameters);

// Throws DataError if frames of the split have different sonar settings, because the fit would attribute the
// difference to echoes.
void CheckSettings(const RecordingSource& recording, const calib::FrameSplit& split);

// Pixels of a recording that hold a measurement, 1 or 0; empty: all.
std::vector<std::uint8_t> ValidPixels(const RecordingInfo& info, const std::optional<Mask>& pixels = {});

// Each frame needs a pose. Throws DataError if the recording, the scene or the parameters cannot be used for
// a fit. A fit without a usable solution is no error: `fit.usable` is false and there is no evaluation.
RecordingFit FitRecording(const RecordingSource& recording, const Scene& scene, const ParameterSet& initial,
                          FitRecordingOptions options);

struct FitOptions {
  FromFile<calib::FitConfig> config = {};
  // Each of these overrides the member of `config` if it is not empty.
  FrameList held_out = {};
  std::vector<std::string> free = {};
  std::vector<std::string> fixed = {};
  MaterialOptions materials = {};
  std::vector<calib::ChoiceAxis> choose = {};
  FrameList frames = {};
  FrameLimits limits = {};
  bool trust_all = false;
  PingUse pings = PingUse::kUse;
  RayOptions rays = {};
  int max_iterations = 100;
  int starts = 4;
  ComparisonOptions comparison = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "config",
                     .help = "Free parameters, their bounds and priors, and the held-out frames"},
          self.config);
    visit(OptionInfo{.name = "held_out",
                     .help =
                         "Frames that are not fitted but evaluated, counted from 0; also ranges A:B, up to, "
                         "but not including, B, A: up to the last frame, and :B",
                     .by_default = "the last third; of a long recording, frames away from the fitted ones"},
          self.held_out);
    visit(OptionInfo{.name = "frames",
                     .help = "Frames to use, fitted or held out, as for held-out; 'all' for every frame",
                     .by_default = "all; of a recording with more than max-frames and max-held-out together, "
                                   "those that are expected to determine the parameters best"},
          self.frames);
    FrameLimits::Visit(self.limits, visit);
    visit(
        OptionInfo{.name = "free",
                   .help = "Parameters to fit: materials, noise, psf, mirrors, pose, mount, geometry, "
                           "object:NODE, outline:NODE, display, jitter, source_level, or names with *",
                   .by_default = "materials; with the paper's model display.db_max and the range and azimuth "
                                 "errors; with the acoustic model receiver.noise_db, mirrors and, if not "
                                 "given, pulse.length_m and with mirrors beam.transmit_end_deg"},
        self.free);
    visit(OptionInfo{.name = "fixed",
                     .help = "Parameters to keep, although they are among the free ones",
                     .by_default = "none"},
          self.fixed);
    MaterialOptions::Visit(self.materials, visit);
    visit(OptionInfo{.name = "choose",
                     .help =
                         "Acoustic model: model parts that are chosen before the fit, in this order, by the "
                         "likelihood of the held-out frames: azimuth pattern, elevation pattern, lobes of "
                         "mirrors, looks, trend of the noise with range, display",
                     .by_default = "none"},
          self.choose);
    visit(OptionInfo{.name = "trust_all",
                     .help = "Acoustic model: gives all pixels full weight, also those that do not match the "
                             "scene"},
          self.trust_all);
    visit(OptionInfo{.name = "pings", .help = kPingUseHelp}, self.pings);
    RayOptions::Visit(self.rays, visit);
    visit(OptionInfo{.name = "max_iterations",
                     .help = "Max number of iterations of each solver run",
                     .min = 1,
                     .max = 100000},
          self.max_iterations);
    visit(OptionInfo{.name = "starts",
                     .help = "Number of start curves, of which the best result is kept",
                     .min = 1,
                     .max = 100},
          self.starts);
    ComparisonOptions::Visit(self.comparison, visit);
  }
};

// Returns free parameters, bounds and frames from the options, the model of `start`, the materials of `scene`
// and the number of frames of the recording. Frames of a long recording are chosen by Fit.
calib::FitConfig ResolveFitConfig(const FitOptions& options, const ParameterSet& start, const Scene& scene,
                                  int frame_count);

// Each frame needs a pose. Throws UsageError for options that contradict each other, DataError if the
// recording, the scene or the parameters cannot be used, calib::FitStopped if the listener stops the fit. A
// fit without a usable solution is no error, see RecordingFit::fit.
RecordingFit Fit(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                 const FitOptions& options = {}, const Listener& listener = {});

}  // namespace sonarcal::workflow
