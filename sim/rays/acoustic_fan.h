// Default rays of the acoustic model.
//
// - Margin: the fan reaches beyond the outer beams because beams have flanks.
// - Elevation: the fan ends where a beam of this width has almost no response. With side lobes it has no such
//   end: the floor right below a sonar returns a strong echo at normal incidence. Without that echo an
//   estimated noise floor is 0.3 dB too high.
// - Row crowding: rows are denser at the horizon, so that a distant floor shows no comb pattern.
// - Stagger: rays are staggered in both directions. A likelihood fluctuates from one pose to the next because
//   rays hit or miss edges; staggering reduces this fluctuation to a fifth.
#pragma once

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/rays/ray_fan.h"

namespace sonarcal::sim {

// Throws DataError if neither the parameters nor the sonar give the beam width in azimuth, or in elevation
// for ElevationPattern::kGaussian.
RayFanOptions AcousticFanOptions(const SonarModel& sonar, const ParameterSet& parameters);

}  // namespace sonarcal::sim
