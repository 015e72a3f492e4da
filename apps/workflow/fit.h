// Fits the parameters of an image model to a recording with poses.
//
//   const RecordingFit fit = Fit(*recording, scene, parameters, {.free = {"materials"}});
//   if (fit.fit.usable) data_io::WriteParameters("params.json", fit.fit.parameters);
//
// A fit of the paper or the acoustic model to a recording, start to end: trace, fit, and judge on frames the
// fit did not see. What `fit` writes as files, and other commands report.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/workflow/compare.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/listener.h"
#include "apps/workflow/ray_options.h"
#include "apps/workflow/still_poses.h"
#include "calib/fit.h"
#include "calib/parameters/fit_config.h"
#include "calib/selection/model_choice.h"
#include "core/types/option.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "data_io/pose_io.h"

namespace sonarcal::workflow {

struct FitRecordingOptions {
  RayOptions rays;  // without a sampling: that of the recording, where it states one, else beams
  calib::FitConfig config;
  calib::FitOptions fit;
  // With `object`, all figures, also those before the fit, search the boxes of the poses after the fit.
  metrics::CompareOptions comparison;
  // Pixels the fit looks at, range_bins x beams; absent: all. For what the scene does not contain.
  std::optional<Mask> pixels = {};
  // Acoustic model: what is chosen by the likelihood of the held-out frames before the fit, in this order.
  std::vector<calib::ChoiceAxis> choose = {};
  // The parameters that a simulated recording was made with, set beside the fitted ones; absent: those that
  // ReadTruth finds.
  std::optional<ParameterSet> truth = {};
  bool keep_images = true;  // of at most 16 compared frames, for pictures
  std::function<void(int frames_done, int frames_in_all)> on_trace = {};  // after each frame
  std::function<void(const std::string& sentence)> on_note = {};          // what a user should not miss
};

// Incidence angles at which a material is seen in the frames used, but for its rarest 0.1 % at either end.
struct IncidenceRange {
  double low_deg = 0.0;
  double high_deg = 0.0;
};

struct RecordingFit {
  RayGridSize rays;        // as cast
  RayOptions ray_options;  // with a sampling
  calib::FitResult fit;    // its report complete: frames, rays, times
  ParameterSet initial;
  // Of every frame of the recording, where the fit moved poses; empty: as recorded.
  std::vector<data_io::TimedPose> poses = {};
  std::map<std::string, IncidenceRange> seen;  // by material; absent: not seen
  // Expected images against recorded ones, with the initial and the fitted parameters. Of the held-out
  // frames; of the frames used where none is held out.
  bool judged_on_held_out = true;
  metrics::MetricsReport before;
  metrics::MetricsReport after;
  // The same of a speckled sample in place of the expected image, which no detector finds grain in: what
  // occupancy and distributions are to be read from. The acoustic model only.
  std::optional<metrics::MetricsReport> sample_before = {};
  std::optional<metrics::MetricsReport> sample_after = {};
  // Two speckled samples with the fitted parameters against each other, on a few of the frames judged:
  // the agreement that a recording of the model itself would reach. The acoustic model only.
  std::optional<metrics::MetricsReport> sample_pair = {};
  std::optional<calib::ModelChoice> choice = {};  // where one was asked for
  // Of poses shown more than once, whether fitted or held out: what they tell by themselves, beside the fit.
  // The acoustic model only.
  StillPoses still = {};
  // What the scene does not explain: by frame used, one weight a pixel; empty: all counted in full.
  std::vector<Grid<float>> weights = {};
  // Images and metrics of compared frames: at most three examples before the fit, these and others after it.
  // Empty without FitRecordingOptions::keep_images.
  std::vector<ComparedFrame> frames_before = {};
  std::vector<ComparedFrame> frames_after = {};
};

// The display a recording states wins over that of the parameters: levels are read through it. Returns what
// to say of that, or nothing.
std::string TakeDisplay(const ImageScale& scale, ParameterSet& parameters);

// Of the rays that the acoustic model wants, as many as are asked for; images that are not expected ones are
// speckled samples.
sim::SimulationOptions AcousticSimulation(const RayOptions& rays, const SonarModel& sonar, const Water& water,
                                          const ParameterSet& parameters);

// Throws DataError where frames of the split were made with other settings than the rest, and would be taken
// for other echoes.
void CheckSettings(const RecordingSource& recording, const calib::FrameSplit& split);

// Pixels of a recording that hold a measurement, 1 or 0; empty: all.
std::vector<std::uint8_t> ValidPixels(const RecordingInfo& info, const std::optional<Mask>& pixels = {});

// Needs a pose with every frame. Throws DataError where the recording, the scene or the parameters can't be
// used for a fit; an end without a usable solution is no error but `fit.usable`, and is not judged.
RecordingFit FitRecording(const RecordingSource& recording, const Scene& scene, const ParameterSet& initial,
                          const FitRecordingOptions& options);

struct FitOptions {
  FromFile<calib::FitConfig> config = {};
  // Each overrides the member of `config`, if it is not empty.
  std::vector<int> held_out = {};
  std::vector<std::string> free = {};
  std::vector<std::string> fixed = {};
  std::vector<calib::ChoiceAxis> choose = {};
  bool trust_all = false;
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
                     .help = "Frames that are not fitted but evaluated, counted from 0",
                     .by_default = "the last third"},
          self.held_out);
    visit(
        OptionInfo{.name = "free",
                   .help = "Parameters to fit: materials, noise, psf, mirrors, pose, mount, display, jitter, "
                           "source_level, or names with *",
                   .by_default = "materials; with the paper's model display.db_max and the range and azimuth "
                                 "errors; with the acoustic model receiver.noise_db, mirrors and, if not "
                                 "given, pulse.length_m and with mirrors beam.transmit_end_deg"},
        self.free);
    visit(OptionInfo{.name = "fixed",
                     .help = "Parameters to keep, although they are among the free ones",
                     .by_default = "none"},
          self.fixed);
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

// Free parameters, bounds and held-out frames by the options, the model of `start` and the scene's materials.
calib::FitConfig ResolveFitConfig(const FitOptions& options, const ParameterSet& start, const Scene& scene);

// Needs a pose with each frame. Throws UsageError for options that contradict each other, DataError if the
// recording, the scene or the parameters cannot be used, calib::FitStopped if the listener stops the fit. A fit
// without a usable solution is no error, see RecordingFit::fit.
RecordingFit Fit(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                 const FitOptions& options = {}, const Listener& listener = {});

}  // namespace sonarcal::workflow
