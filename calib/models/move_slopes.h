// Slopes of the mean power of a frame's echoes along moves of the sonar, of its range axis and of objects, in
// the units of the parameters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/parameters/object_placement.h"
#include "calib/parameters/pose_step.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/acoustic/echo_slopes.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

// range_bins x beams each.
struct MoveSlopes {
  // Slope along a component of the step of a placement, for the object that is `part` of the scene and stands
  // at `placement`.
  Grid<float> AlongPlacement(int part, const PlaceableObject& object, const ObjectPlacement& placement,
                             int component, const Pose& world_from_sonar) const;

  Grid<double> power;                         // mean power of the echoes at the pose
  std::array<Grid<float>, kPoseSteps> along;  // change of `power` per component of a PoseStep, m or degree
  Grid<float> range_offset;                   // per metre of geometry.range_offset_m
  std::vector<sim::AlongMoves> of_part;       // sim::EchoSlopes::of_part
};

// Rows and columns of rays divided by `decimation`, or by less if fewer than 400 rows or four columns per
// width of a beam would remain.
sim::RayFanOptions Decimated(const SonarModel& sonar, const sim::RayFanOptions& fan, int decimation);

// Echoes at the axes of the simulator's sonar. Those of mirrors are included, except along moves of objects.
//
// Slopes need far fewer rays than an image, because edges are followed and not sampled
// (sim/acoustic/echo_slopes.h).
MoveSlopes SlopesOfMoves(const sim::Simulator& simulator, const Pose& world_from_sonar,
                         const ParameterSet& parameters, const sim::SceneParts& parts = {});

}  // namespace sonarcal::calib
