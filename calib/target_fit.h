// Fits the acoustic model to one recorded image of one target with an approximately known pose (from
// calib/poses/pose_search.h): the slow and the transitional term of its backscatter, noise floor, beam, pulse
// and, on request, a correction of the pose.
//
// The display is known or comes from the background (calib/noise/background_display.h). The specular peak
// stays as given, because a target hardly shows it. The world of the fit has its origin in the target's
// origin and its axes along those of the sonar at the given pose. So the six numbers of the pose are a shift
// and a turn of the sonar about its given place.
#pragma once

#include "calib/acoustic_fit.h"
#include "calib/poses/target_pose.h"
#include "core/types/mask.h"

namespace sonarcal::calib {

struct TargetFitOptions {
  double ray_height_deg = 0.05;  // if the pose is free: half of it, and twice the columns
  int cols_per_beam = 4;
  double elevation_span_deg = 28.0;  // targets are visible outside the nominal vertical field of view
  double azimuth_margin_deg = 1.5;   // three of the widest beams
  // Bounds; otherwise one image trades a wrong outline for a wide beam or a long pulse.
  double beam_width_min_deg = 0.1;
  double beam_width_max_deg = 0.5;
  // In elevation, two-way: a nominal vertical field of view is not a half-power width.
  double elevation_width_min_deg = 10.0;
  double elevation_width_max_deg = 60.0;
  double pulse_max_bins = 4.0;
  bool free_model = true;  // frees curve, noise floor, beam and pulse; otherwise as given
  bool free_pose = true;
  double pose_shift_m = 0.05;  // max shift of the sonar to either side
  double pose_turn_deg = 5.0;
  Mask pixels;  // 1 for used pixels; empty: all
  int threads = 0;
  FitOptions fit;
};

struct TargetFit {
  AcousticFit fit;
  Scene placed;  // the target in the world of the fit
  sim::SimulationOptions simulation;
};

// Returns the target at `pose` in the world of the fit, and the pose of the sonar there.
Scene PlacedTarget(const Scene& target, const TargetPose& pose);
Pose SonarOfPlaced(const TargetPose& pose);

// `initial` gives display, looks, noise level, beam, pulse and the target's curve. Throws DataError as
// FitAcousticModel does.
TargetFit FitTarget(const Scene& target, const SonarModel& sonar, const Water& water,
                    const PolarImage& recorded, const TargetPose& pose, const ParameterSet& initial,
                    const TargetFitOptions& options = {});

}  // namespace sonarcal::calib
