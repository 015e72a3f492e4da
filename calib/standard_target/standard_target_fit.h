// Calibrates a sonar with a sphere of known material: absolute level, responses and sensitivity of the beams.
// Needs no scene and no poses.
//
//   const StandardTargetFit fit = FitStandardTarget(*recording, initial, water, absorption_db_per_m,
//                                                   {.sphere = {.material = "wc", .diameter_m = 0.02}});
//
// Each frame in which the sphere stands alone above the noise (calib/standard_target/target_sighting.h) gives
// its range, azimuth and level. A fit of all frames (calib/standard_target/point_echo_fit.h) gives the level
// of the sphere at 1 m, the response in azimuth and range, and what the data determine beyond:
//
// - The law of the gain with range, if the ranges differ by more than a quarter.
// - The sensitivity of the beams that the sphere was in, if it moved over three beam widths. Other beams take
//   that of the nearest.
// - The width of the response in elevation, if poses show where the sphere stands (target_position.h) and it
//   moved through it. Without poses the sphere is taken to be on the axis in elevation.
//
// Source level plus gain is the level minus the sphere's target strength (sphere_strength.h).
// Protocol: Foote et al., Protocols for calibrating multibeam sonar, J. Acoust. Soc. Am. 117(4), 2005.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/standard_target/display_slope.h"
#include "calib/standard_target/point_echo_fit.h"
#include "calib/standard_target/sphere_strength.h"
#include "calib/standard_target/target_position.h"
#include "calib/standard_target/target_sighting.h"
#include "calib/standard_target/target_windows.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/sonar_model.h"

namespace sonarcal::calib {

struct StandardTargetOptions {
  StandardSphere sphere;
  TargetSearch search = {};
  std::vector<int> frames = {};  // empty: all
  // Relative standard error of the display's span (display_slope.h).
  double display_sigma_share = 0.0;
  // Called with done = 0 at the start of each step.
  std::function<void(const std::string& step, int done, int total)> progress = {};
};

struct TargetFrame {
  int frame = 0;
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  std::optional<double> elevation_rad = {};
  // Source level plus gain as this frame alone shows it, and its standard error without those that all frames
  // share.
  double level_db = 0.0;
  double level_sigma_db = 0.0;
  double noise_db = 0.0;  // as received, time-varied gain included
};

struct StandardTargetFit {
  FitReport report;         // its parameters and warnings
  ParameterSet parameters;  // the initial ones with what was fitted
  bool usable = false;
  SphereStrength strength;
  double level_db = 0.0;         // source level plus gain
  double level_sigma_db = 0.0;   // with that of the sphere's target strength
  double received_db = 0.0;      // level at which the sphere is shown, in the frame of the median level
  double level_spread_db = 0.0;  // standard deviation of the frames' levels; 0: not estimated
  double reference_range_m = 0.0;
  std::vector<TargetFrame> frames;
  std::vector<FrameLeftOut> left_out;
  std::optional<TargetPosition> position = {};
  std::string elevation_unknown = {};              // why, if no level is corrected for it
  std::vector<int> beams_determined = {};          // beams with a sensitivity of their own
  std::optional<double> grey_levels_per_db = {};   // display law log
  std::optional<DisplaySlope> display_slope = {};  // of the display as given, if a second target tells it
  // For pictures: the sphere in the frame used whose level is the median.
  EchoWindow shown;
  std::vector<double> shown_model;  // expected power of its pixels
};

// `initial` gives the display, and the shapes of the responses; its levels and widths are not used. Throws
// DataError if no frame shows the sphere, with the reason that most frames give, and for what
// StrengthOfSphere refuses.
StandardTargetFit FitStandardTarget(const RecordingSource& recording, const ParameterSet& initial,
                                    const Water& water, double absorption_db_per_m,
                                    const StandardTargetOptions& options);

}  // namespace sonarcal::calib
