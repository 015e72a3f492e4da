#include "calib/bomb_fit.h"

#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr double kBeamDeg = 0.35;
// Chosen with frame 1 in sight: 1.0, 0.6 and 0.4 were tried (docs/studies/bomb.md).
constexpr double kTaper = 0.6;
constexpr double kElevationBeamDeg = 30.0;
constexpr double kPulseBins = 3.0;

}  // namespace

TargetPose BombPose() {
  return {.range_m = 1.267,
          .azimuth_rad = RadFromDeg(-5.118),
          .elevation_rad = RadFromDeg(0.738),
          .yaw_rad = RadFromDeg(130.832),
          .pitch_rad = RadFromDeg(30.320)};
}

TargetPose BombOtherPose() {
  return {.range_m = 1.569,
          .azimuth_rad = RadFromDeg(1.74),
          .elevation_rad = RadFromDeg(-9.0),
          .yaw_rad = RadFromDeg(32.4),
          .pitch_rad = RadFromDeg(30.6)};
}

data_io::FanGeometry BombOtherPoseFan() {
  return {.apex_x_px = 361.9,
          .apex_y_px = 1343.0,
          .radius_min_px = 309.0,
          .radius_max_px = 1340.0,
          .half_angle_deg = 15.13};
}

ParameterSet BombInitial(const DisplayParameters<double>& display, const SonarModel& sonar) {
  ParameterSet initial;
  initial.model = EchoModel::kAcoustic;
  initial.source_level_db = 0.0;
  initial.display = display;
  initial.receiver = {.gain_db = 80.0, .noise_db = 0.0};  // the level is the material's to carry
  initial.beam.azimuth_width_deg = kBeamDeg;
  initial.beam.azimuth_taper = kTaper;
  initial.beam.elevation_width_deg = kElevationBeamDeg;
  initial.pulse.length_m = kPulseBins * sonar.axes.range_bin_m();
  initial.materials["body"].gsab = {.a = 1e-7, .b_deg = 4.0, .c = 0.02, .d = 0.8, .e = 0.1, .f_deg = 20.0};
  return initial;
}

TargetFitOptions BombFitOptions() {
  TargetFitOptions options;
  options.free_pose = false;
  options.fit.starts = 1;
  options.fit.function_tolerance = 1e-6;
  return options;
}

}  // namespace sonarcal::calib
