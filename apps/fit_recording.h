// A fit of the paper or the acoustic model to a recording, start to end: trace, fit, and judge on frames the
// fit did not see. What `fit` writes as files, and other commands report.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/compare_recordings.h"
#include "apps/comparison_pictures.h"
#include "apps/ray_options.h"
#include "apps/report/frame_viewer.h"
#include "apps/still_poses.h"
#include "calib/fit.h"
#include "calib/selection/model_choice.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "data_io/pose_io.h"

namespace sonarcal {

struct FitRecordingOptions {
  RayOptions rays;  // without a sampling: that of the recording, where it states one, else beams
  FitConfig config;
  FitOptions fit;
  // With `object`, all figures, also those before the fit, search the boxes of the poses after the fit.
  CompareOptions comparison;
  // Pixels the fit looks at, range_bins x beams; absent: all. For what the scene does not contain.
  std::optional<Mask> pixels = {};
  // Acoustic model: what is chosen by the likelihood of the held-out frames before the fit, in this order.
  std::vector<ChoiceAxis> choose = {};
  // The parameters that a simulated recording was made with, set beside the fitted ones; absent: those that
  // ReadTruth finds.
  std::optional<ParameterSet> truth = {};
  bool pictures = true;                                                   // of a few frames
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
  FitResult fit;           // its report complete: frames, rays, times
  ParameterSet initial;
  // Of every frame of the recording, where the fit moved poses; empty: as recorded.
  std::vector<TimedPose> poses = {};
  std::map<std::string, IncidenceRange> seen;  // by material; absent: not seen
  // Expected images against recorded ones, with the initial and the fitted parameters. Of the held-out
  // frames; of the frames used where none is held out.
  bool judged_on_held_out = true;
  MetricsReport before;
  MetricsReport after;
  // The same of a speckled sample in place of the expected image, which no detector finds grain in: what
  // occupancy and distributions are to be read from. The acoustic model only.
  std::optional<MetricsReport> sample_before = {};
  std::optional<MetricsReport> sample_after = {};
  // Two speckled samples with the fitted parameters against each other, on a few of the frames judged:
  // the agreement that a recording of the model itself would reach. The acoustic model only.
  std::optional<MetricsReport> sample_pair = {};
  std::optional<ModelChoice> choice = {};  // where one was asked for
  // Of poses shown more than once, whether fitted or held out: what they tell by themselves, beside the fit.
  // The acoustic model only.
  StillPoses still = {};
  // What the scene does not explain: by frame used, one weight a pixel; empty: all counted in full.
  std::vector<Grid<float>> weights = {};
  std::vector<FramePictures> pictures_before;  // of the same frames as those after
  std::vector<FramePictures> pictures_after;
  FrameViewer viewer = {};  // of frames after the fit; empty where no pictures were asked for
};

// The display a recording states wins over that of the parameters: levels are read through it. Returns what
// to say of that, or nothing.
std::string TakeDisplay(const ImageScale& scale, ParameterSet& parameters);

// Of the rays that the acoustic model wants, as many as are asked for; images that are not expected ones are
// speckled samples.
SimulationOptions AcousticSimulation(const RayOptions& rays, const SonarModel& sonar, const Water& water,
                                     const ParameterSet& parameters);

// Throws DataError where frames of the split were made with other settings than the rest, and would be taken
// for other echoes.
void CheckSettings(const RecordingSource& recording, const FrameSplit& split);

// Pixels of a recording that hold a measurement, 1 or 0; empty: all.
std::vector<std::uint8_t> ValidPixels(const RecordingInfo& info, const std::optional<Mask>& pixels = {});

// Needs a pose with every frame. Throws DataError where the recording, the scene or the parameters can't be
// used for a fit; an end without a usable solution is no error but `fit.usable`, and is not judged.
RecordingFit FitRecording(const RecordingSource& recording, const Scene& scene, const ParameterSet& initial,
                          const FitRecordingOptions& options);

}  // namespace sonarcal
