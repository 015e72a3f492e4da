// Contributions to the expected power of each pixel: one image per cause. Their sum is the acoustic model's
// expected power.
//
//   material        its echoes through the beams' main lobes
//   elevation lobe  echoes of a material through a side lobe of the elevation pattern
//   azimuth lobe    echoes of any material through side lobes in azimuth; lobe_of gives their direction
//   ghost           multipath echoes by one mirror, on one leg or both; or by several mirrors
//   noise           noise floor of the receiver
//
// A main lobe ends where the response first stops falling away from its peak. Columns of equal response share
// the peak, such as those on both sides of a beam's centre. Multipath echoes are counted as a whole, through
// whichever lobe they arrive.
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
  std::string name;    // unique text: "floor", "ghost by the wall", "noise"
  Grid<double> power;  // range_bins x beams
};

struct EchoCauses {
  std::vector<EchoCause> causes;  // noise first; causes without power are omitted
  // Direction, as a beam index, that contributes most power through side lobes in azimuth; range_bins x
  // beams. -1 in pixels without such power. Empty if there are no side lobes.
  Grid<int> lobe_of;

  // Index of the largest cause of each pixel.
  Grid<int> Largest() const;
};

// Traces the pose. Throws DataError as Simulator::RenderExpected does.
EchoCauses CausesOf(const Simulator& simulator, const Pose& world_from_sonar, const ParameterSet& parameters);

}  // namespace sonarcal::sim
