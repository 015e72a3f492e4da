// What the power expected in each pixel comes from: one image for each cause, which together are the acoustic
// model's expected power.
//
//   material        echoes of it through the beams' main lobes
//   elevation lobe  echoes of a material through a side lobe of the elevation pattern
//   azimuth lobe    echoes of any material through side lobes in azimuth; of which beam's cell, LobeOf says
//   ghost           by way of one mirror, there or back or both; or of several
//   noise           the receiver's floor
//
// A main lobe ends where the response first stops falling away from its peak. Ghosts are counted whole,
// through whatever lobe they come.
#pragma once

#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/simulator.h"

namespace sonarcal::sim {

enum class CauseKind { kMaterial, kElevationLobe, kAzimuthLobe, kGhost, kNoise };

struct EchoCause {
  CauseKind kind = CauseKind::kNoise;
  std::string name;    // "floor", "ghost by the wall", "noise": in words, unique
  Grid<double> power;  // range_bins x beams
};

struct EchoCauses {
  std::vector<EchoCause> causes;  // noise first; those of no power anywhere are left out
  // Beam whose direction gives most of what comes through side lobes in azimuth, range_bins x beams; -1 where
  // nothing does. Empty where there are no side lobes.
  Grid<int> lobe_of;

  // Index of the largest cause of each pixel.
  Grid<int> Largest() const;
};

// Traces the pose. Throws DataError as Simulator::RenderExpected does.
EchoCauses CausesOf(const Simulator& simulator, const Pose& world_from_sonar, const ParameterSet& parameters);

}  // namespace sonarcal::sim
