// Finds the pose of a target in one recorded polar image, from a rough window.
//
// The acoustic model predicts the image (power over a noise floor, through beam and pulse), because the
// paper's sum of decibels differs too much from a real image. Both images are smoothed and compared by grey
// levels. A coarse sweep over headings and pitches gives starts. The best starts are refined by
// damped steps (calib/poses/damped_steps.h, slopes by central differences of traced images), first on a coarse
// image, then the best on the full one. The strength of the target's echo is fitted at the same time.
//
// Limit: one image does not determine everything. The result states what is open: the mirror image in the
// plane of the beams, the ridge along elevation, and the roll of a body of revolution.
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
  int yaw_steps = 24;                             // in the sweep, over the full circle
  std::vector<double> pitches_deg = {0.0, 25.0};  // in the sweep; negative ones are mirror images
  int refined_starts = 4;                         // best starts of the sweep, refined on the coarse image
  int coarse_factor = 3;                          // decimation of range bins and rays in the coarse image
  int cols_per_beam = 2;
  double ray_height_deg = 0.05;
  double elevation_span_deg = 28.0;   // targets are visible outside the nominal vertical field of view
  double elevation_limit_deg = 10.0;  // bounds of the refinement
  double pitch_limit_deg = 60.0;
  std::vector<double> ridge_elevations_deg = {-6.0, -3.0, 0.0, 3.0, 6.0};  // for a comparison of the cost
  int max_iterations = 20;
  std::function<void(const std::string&)> progress;

  // Throws DataError with field, value and limit.
  void Check() const;
};

// Result of a refinement.
struct PoseCandidate {
  TargetPose pose;
  double gain_db = 0.0;  // gain of the echo relative to the given parameters
  double cost = 0.0;     // mean squared difference of the smoothed images, full scale 1
};

struct PoseSearchResult {
  PoseCandidate best;
  std::vector<PoseCandidate> starts;  // refined on the coarse image, best first
  std::vector<PoseCandidate> ridge;   // refined with fixed elevation, in the order of ridge_elevations_deg
  std::vector<std::string> open;      // properties that this image does not determine, one sentence each
  long rays_cast = 0;
};

// `measured` holds grey levels. `parameters` gives display, noise floor, beam and pulse, and a backscatter
// curve for the target. Throws DataError if no object exceeds the background.
PoseSearchResult SearchPose(const Scene& target, const SonarModel& sonar, const Water& water,
                            const PolarImage& measured, const ParameterSet& parameters,
                            const PoseSearchOptions& options = {});

}  // namespace sonarcal::calib
