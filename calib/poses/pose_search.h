// Finds the pose of a target from one recorded polar image, when nothing but a rough window is known.
//
// The image is predicted by the acoustic model (power over a noise floor through beam and pulse: the paper's
// sum of decibels is too far from a real image to find a pose by), smoothed like the recorded one, and
// compared grey level by grey level. A coarse sweep over headings and pitches gives starts; the best of them
// are refined with Ceres (Levenberg-Marquardt, central differences: every evaluation traces the scene again),
// first on a coarse image, then the best on the full one. The strength of the target's echo is solved for at
// the same time.
//
// One image leaves things open, and the result says which: the mirror image in the plane of the beams, the
// ridge along elevation, and the roll of a body of revolution.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/poses/target_pose.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

struct PoseSearchOptions {
  double smooth_bins = 2.0;  // standard deviation of the smoothing of both images
  double smooth_beams = 1.0;
  int yaw_steps = 24;                             // of the sweep, over the full circle
  std::vector<double> pitches_deg = {0.0, 25.0};  // of the sweep; negative ones are mirror images
  int refined_starts = 4;                         // of the sweep, refined on the coarse image
  int coarse_factor = 3;  // range bins and rays of the coarse image are fewer by this factor
  int cols_per_beam = 2;
  double ray_height_deg = 0.05;
  double elevation_span_deg = 28.0;   // targets are seen outside the nominal vertical field of view
  double elevation_limit_deg = 10.0;  // bounds of the refinement
  double pitch_limit_deg = 60.0;
  std::vector<double> ridge_elevations_deg = {-6.0, -3.0, 0.0, 3.0, 6.0};  // at which the cost is compared
  int max_iterations = 20;
  std::function<void(const std::string&)> progress;

  // Throws DataError naming field, value and limit.
  void Check() const;
};

// A place where a refinement ended.
struct PoseCandidate {
  TargetPose pose;
  double gain_db = 0.0;  // of the echo, against the parameters given
  double cost = 0.0;     // mean squared difference of the smoothed images, of full scale 1
};

struct PoseSearchResult {
  PoseCandidate best;
  std::vector<PoseCandidate> starts;  // refined on the coarse image, best first
  std::vector<PoseCandidate> ridge;   // refined with the elevation held, in the order of ridge_elevations_deg
  std::vector<std::string> open;      // what this image does not tell, in words
  long rays_cast = 0;
};

// `measured` holds grey levels; `parameters` gives display, noise floor, beam and pulse, and a backscatter
// curve for the target. Throws DataError where no object stands out of the background.
PoseSearchResult SearchPose(const Scene& target, const SonarModel& sonar, const Water& water,
                            const PolarImage& measured, const ParameterSet& parameters,
                            const PoseSearchOptions& options = {});

}  // namespace sonarcal::calib
