// The acoustic model fitted to one recorded image of one target whose pose is roughly known (from
// calib/poses/pose_search.h): the slow and the transitional term of its backscatter, noise floor, beam, pulse
// and, where asked for, the pose about the one given.
//
// The display is one that is known, or was read off the background (calib/noise/background_display.h). The
// specular peak stays as given: a target hardly shows it. The world of the fit has its origin in the target's
// and its axes along those of the sonar at the pose given, so that the six numbers of the pose are a shift
// and a turn of the sonar about where it is.
#pragma once

#include "calib/acoustic_fit.h"
#include "calib/poses/target_pose.h"
#include "core/types/mask.h"

namespace sonarcal::calib {

struct TargetFitOptions {
  double ray_height_deg = 0.05;  // half of it, and twice the columns, where the pose is free
  int cols_per_beam = 4;
  double elevation_span_deg = 28.0;  // targets are seen outside the nominal vertical field of view
  double azimuth_margin_deg = 1.5;   // three of the widest beams
  // Bounds; one image trades a wrong outline for a wide beam or a long pulse.
  double beam_width_min_deg = 0.1;
  double beam_width_max_deg = 0.5;
  // In elevation, two-way: a nominal vertical field of view is no half-power width.
  double elevation_width_min_deg = 10.0;
  double elevation_width_max_deg = 60.0;
  double pulse_max_bins = 4.0;
  bool free_model = true;  // curve, noise floor, beam and pulse; else as given
  bool free_pose = true;
  double pose_shift_m = 0.05;  // of the sonar, either way
  double pose_turn_deg = 5.0;
  Mask pixels;  // that count; empty: all
  int threads = 0;
  FitOptions fit;
};

struct TargetFit {
  AcousticFit fit;
  Scene placed;  // the target in the world of the fit
  sim::SimulationOptions simulation;
};

// The target as `pose` shows it, in the world of the fit; and the sonar's pose in it.
Scene PlacedTarget(const Scene& target, const TargetPose& pose);
Pose SonarOfPlaced(const TargetPose& pose);

// `initial` gives display, looks, noise level, beam, pulse and the target's curve. Throws DataError as
// FitAcousticModel does.
TargetFit FitTarget(const Scene& target, const SonarModel& sonar, const Water& water,
                    const PolarImage& recorded, const TargetPose& pose, const ParameterSet& initial,
                    const TargetFitOptions& options = {});

}  // namespace sonarcal::calib
