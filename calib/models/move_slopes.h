// Slopes of the mean power of a frame's echoes along moves of the sonar and along its range axis, in the units
// of the parameters.
#pragma once

#include <array>

#include "calib/parameters/pose_step.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

// range_bins x beams each.
struct MoveSlopes {
  Grid<double> power;                           // mean power of the echoes at the pose
  std::array<Grid<float>, kPoseSteps> along;    // change of `power` per component of a PoseStep, m or degree
  Grid<float> range_offset;                     // per metre of geometry.range_offset_m
};

// Rows and columns of rays divided by `decimation`, or by a smaller number if fewer than 250 rows would remain.
sim::RayFanOptions Decimated(sim::RayFanOptions fan, int decimation);

// Fan for slopes: they need far fewer rays than an image, because edges are followed and not sampled
// (sim/acoustic/echo_slopes.h).
sim::RayFan FanOfSlopes(const sim::Simulator& simulator);

// Echoes with those of mirrors, at the axes of the simulator's sonar.
MoveSlopes SlopesOfMoves(const sim::Simulator& simulator, const sim::RayFan& fan, const Pose& world_from_sonar,
                    const ParameterSet& parameters);

}  // namespace sonarcal::calib
