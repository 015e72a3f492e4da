// A body in open water before a sonar of few beams, by the acoustic model.
#pragma once

#include "calib/poses/target_pose.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "core/types/units.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::testing {

inline SonarModel CoarseSonar() {
  SonarModel sonar{.name = "coarse",
                   .frequency_hz = 3e6,
                   .axes = {0.8, 2.0, 120, {}},
                   .azimuth_beam_width_deg = 0.6,
                   .elevation_beam_width_deg = 15.0,
                   .sound_speed_m_per_s = 1480.0};
  for (int beam = 0; beam < 56; ++beam)
    sonar.axes.beam_azimuth_rad.push_back(RadFromDeg((beam - 27.5) * 0.5));
  return sonar;
}

inline ParameterSet BodyParameters() {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.source_level_db = 0.0;
  parameters.display = {.db_min = 0.0, .db_max = 40.0};
  parameters.receiver.noise_db = 8.0;
  parameters.receiver.gain_db = 68.0;
  parameters.materials["body"].gsab = {.a = 0.0, .b_deg = 4.0, .c = 1.0, .d = 1.5, .e = 0.0, .f_deg = 10.0};
  return parameters;
}

// A bar with an arm to one side of one end: only its own plane reflects it onto itself.
inline Scene MakeHook() {
  Scene hook = sim::MakeBox({-0.3, -0.05, -0.05}, {0.3, 0.05, 0.05}, 0.05, "body");
  hook.Append(sim::MakeBox({0.2, 0.05, -0.05}, {0.3, 0.25, 0.05}, 0.05, "body"));
  return hook;
}

inline calib::TargetPose BodyPose() {
  return {.range_m = 1.35,
          .azimuth_rad = RadFromDeg(-3.0),
          .elevation_rad = 0.0,
          .yaw_rad = RadFromDeg(130.0),
          .pitch_rad = RadFromDeg(20.0)};
}

}  // namespace sonarcal::testing
