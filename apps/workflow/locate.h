// Finds the pose of a target in frames of a recording, from its mesh alone (calib/poses/pose_search.h).
//
//   const Location location = Locate(*recording, {.mesh = mesh}, {0}, {});
//   for (const LocatedFrame& frame : location.frames) frame.search.best().WorldFromSonar();
//
// The world is the frame of the mesh. Each frame has its own pose, unless all frames share one.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/workflow/listener.h"
#include "calib/poses/pose_search.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "data_io/pose_io.h"
#include "metrics/compare.h"

namespace sonarcal::workflow {

struct LocateOptions {
  FromFile<ParameterSet> params = {};
  std::optional<Interval> region_range = {};
  std::optional<Interval> region_azimuth = {};
  bool one_pose = false;
  std::optional<double> floor = {};
  std::string floor_material = {};
  double spacing = calib::PoseSearchOptions().start_spacing_deg;
  int starts = calib::PoseSearchOptions().refined_starts;
  double elevation_limit = calib::PoseSearchOptions().elevation_limit_deg;
  int max_iterations = calib::PoseSearchOptions().max_iterations;
  double ray_height = calib::PoseSearchOptions().ray_height_deg;
  int threads = 0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "params",
                     .help = "Parameters of the acoustic model",
                     .by_default = "display and noise from the recording, a general backscatter curve"},
          self.params);
    visit(OptionInfo{.name = "region_range",
                     .help = "Ranges between which the middle of the target lies",
                     .unit = "m",
                     .by_default = "around the brightest spot"},
          self.region_range);
    visit(OptionInfo{.name = "region_azimuth",
                     .help = "Azimuths between which the middle of the target lies",
                     .unit = "deg",
                     .by_default = "around the brightest spot"},
          self.region_azimuth);
    visit(OptionInfo{.name = "one_pose", .help = "All frames show the target from one pose"}, self.one_pose);
    visit(OptionInfo{.name = "floor",
                     .help = "Adds a level floor this far below the lowest point of the mesh",
                     .unit = "m",
                     .by_default = "no floor",
                     .min = 0.0,
                     .max = 1000.0},
          self.floor);
    visit(OptionInfo{.name = "floor_material",
                     .help = "Material of the mesh that is its floor",
                     .by_default = "none",
                     .type = "NAME"},
          self.floor_material);
    visit(OptionInfo{.name = "spacing",
                     .help = "Angle between the directions of the target that are tried",
                     .unit = "deg",
                     .min = 2.0,
                     .max = 90.0},
          self.spacing);
    visit(
        OptionInfo{
            .name = "starts", .help = "Number of tried directions that are refined", .min = 1, .max = 100},
        self.starts);
    visit(OptionInfo{.name = "elevation_limit",
                     .help = "Max elevation of the middle of the target, up and down",
                     .unit = "deg",
                     .min = 0.0,
                     .max = 80.0},
          self.elevation_limit);
    visit(
        OptionInfo{
            .name = "max_iterations", .help = "Max number of steps of a refinement", .min = 1, .max = 1000},
        self.max_iterations);
    visit(OptionInfo{.name = "ray_height",
                     .help = "Elevation between two rays of the full image",
                     .unit = "deg",
                     .min = 0.005,
                     .max = 2.0},
          self.ray_height);
    visit(OptionInfo{.name = "threads", .help = "Threads to use, 0 for all cores", .min = 0, .max = 1024},
          self.threads);
  }
};

// A frame with its images at a candidate.
struct CandidateImages {
  PolarImage expected;                // whole grey levels
  PolarImage sample;                  // with speckle and receiver noise
  metrics::FrameMetrics of_expected;  // against the recorded frame, with masks
  metrics::FrameMetrics of_sample;
};

struct LocatedFrame {
  int frame = 0;  // number in the recording
  calib::PoseSearchResult search;
  std::vector<CandidateImages> images;  // of the first candidates, at most kShownCandidates
};

inline constexpr int kShownCandidates = 3;

struct Location {
  std::vector<LocatedFrame> frames;
  Scene scene;              // mesh, and floor if there is one
  ParameterSet parameters;  // of the search, with the gain found for the best candidate of the first frame
  // The located frames with their best poses, in the given order.
  std::unique_ptr<MemoryRecording> recording;
  bool interrupted = false;  // stopped by the listener: holds only the frames that were finished

  // Poses of the located frames, with their candidates.
  std::vector<data_io::TimedPose> Poses() const;
};

// Display law as the background of `image` shows it: all pixels farther than 20 bins and 8 beams from the
// object that `segmentation` finds (calib/noise/background_display.h). The noise is at 0 dB.
DisplayParameters<double> DisplayOfBackground(const PolarImage& image,
                                              const metrics::SegmentationOptions& segmentation);

// Parameters for a search without any: display and noise from `image`, a general curve for each material, a
// gain that puts an echo of one resolution cell 20 dB above the noise. `notes` receives a sentence for each
// assumption.
ParameterSet ParametersForSearch(const RecordingInfo& info, const Water& water, const PolarImage& image,
                                 const Scene& scene, std::vector<std::string>& notes);

// `start`: a pose for each frame, or one for all, that is refined in place of a search; empty: none. Throws
// UsageError for options that contradict each other, DataError if a frame shows no target.
Location Locate(const RecordingSource& recording, const Scene& mesh, const std::vector<int>& frames,
                const LocateOptions& options = {}, const std::vector<data_io::TimedPose>& start = {},
                const Listener& listener = {});

}  // namespace sonarcal::workflow
