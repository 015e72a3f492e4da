// Case studies as data: cases/NAME/case.json says which recording is studied, what is known beforehand and
// where that comes from, what is fitted and what is held out (docs/reference/cases.md lists all keys).
//
//   const CasePlan plan = FindCase("bomb");
//   if (const auto* target = std::get_if<TargetCase>(&plan.study)) ...
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "calib/poses/target_pose.h"
#include "calib/target_fit.h"
#include "core/types/parameters.h"
#include "core/types/scene.h"
#include "core/types/sonar_model.h"
#include "data_io/pictures/fan_geometry.h"
#include "metrics/segmentation/segmentation_options.h"
#include "sim/scenes/environments.h"

namespace sonarcal::reproduce {

// Something that is used but not found by the program, and its origin.
struct KnownBeforehand {
  std::string what;
  std::string source;
};

// Two frames of one target in a static scene, whose shape is known. One frame is fitted, the other is held
// out. An optional fan picture shows the target in another pose.
struct TargetCase {
  std::string recording;  // folder of the images, below the recordings folder
  int fitted_frame = 0;
  int held_out_frame = 1;
  std::optional<Water> water;  // absent: that of the recording, or the default
  double azimuth_beam_width_deg = 0.0;
  double elevation_span_deg = 0.0;  // rays reach beyond the nominal field of view
  Scene scene;
  calib::TargetPose pose;  // in the fitted and in the held-out frame, as `sonarcal locate` finds it
  ParameterSet start;      // acoustic model; the background of the image gives the display
  calib::TargetFitOptions fit;
  metrics::SegmentationOptions segmentation;

  struct OtherView {
    std::string picture;  // file in the folder `recording`
    data_io::FanGeometry fan;
    double db_span = 0.0;     // level difference between black and white
    calib::TargetPose start;  // start of the fit of the pose
  };
  std::optional<OtherView> other;

  // Texts of the report.
  std::string heading;
  std::string about;
  std::string limit;  // what the held-out frame cannot show
};

// Pings in which a person marked the first return of a surface that is not known otherwise.
struct MarkedSurfaceCase {
  std::string recording;   // folder below the recordings folder, of the four that follow
  std::string pings;       // recording in any format
  std::string background;  // recording without a target, for the noise
  std::string marks;       // pictures of the marks, named STEM of the ping + marks_suffix
  std::string marks_suffix;
  int frames_used = 2;            // the first marked pings
  int frames_held_out = 1;        // the marked pings after these
  int blind_bins = 0;             // range bins at the sonar that hold no measurement
  double apart_m = 0.0;           // distance between the made-up positions of the pings
  std::vector<double> leans_deg;  // leans of the surface that are tried
  std::string material;
  ParameterSet start;  // display, noise and beam come from the recordings
  metrics::SegmentationMethod segmentation = metrics::SegmentationMethod::kBackgroundSigma;
};

// A published comparison whose recordings are replaced by a simulation with another image formation.
struct SyntheticCase {
  std::string sonar;  // name of a preset
  const sim::Environment* environment = nullptr;
  sim::EnvironmentOptions scene;       // sizes as published
  sim::EnvironmentOptions text_scene;  // sizes of the text of the publication, if they differ
  ParameterSet truth;                  // coherent model
  ParameterSet acoustic_start;
  std::string object_material;     // of the objects to find
  std::vector<int> fitted_frames;  // frames are counted through all data sets; all others are held out
  int recorder_cols_per_beam = 2;
  int recorder_rows = 1000;
  int max_iterations = 40;
  double function_tolerance = 1e-5;

  // Published figures of a data set, and its poses.
  struct DataSet {
    int pose_set = 1;  // of the environment
    double ns_over_nr = 0.0;
    double na_over_ns = 0.0;
    double na_over_nr = 0.0;
    double intensity_fan = 0.0;
    double intensity_polar = 0.0;
    double simulation_time_s = 0.0;
  };
  std::vector<DataSet> data_sets;

  // Texts of the report.
  std::string heading;
  std::string about;
  std::string stand_in;  // what the synthetic recording can show
  // Recordings that are shown and not compared: title and path below the recordings folder.
  std::vector<std::pair<std::string, std::string>> also_shown;
};

struct CasePlan {
  std::string name;              // of the folder
  std::filesystem::path folder;  // of the plan
  std::string title;             // beside each picture
  std::string label;             // short, for figures
  std::vector<KnownBeforehand> known;
  std::vector<std::string> caveats;  // a sentence each
  std::variant<TargetCase, MarkedSurfaceCase, SyntheticCase> study;
};

// Throws DataError with file, line and key for unknown keys and values out of range, and for missing files.
CasePlan ReadCase(const std::filesystem::path& folder);

// $SONARCAL_CASES; else share/sonarcal/cases beside the program's folder, cases/ of the source tree, or the
// installed cases. Throws DataError if there is none.
std::filesystem::path CasesFolder();

// Names of the cases in `cases`, sorted.
std::vector<std::string> CaseNames(const std::filesystem::path& cases);

// Reads the case of this name in CasesFolder(). A hyphen stands for an underscore. Throws UsageError that
// lists the names for an unknown one.
CasePlan FindCase(std::string_view name);

// "length: published, ...": each known thing with its origin.
std::vector<std::string> KnownSentences(const CasePlan& plan);

}  // namespace sonarcal::reproduce
