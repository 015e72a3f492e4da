// The rays that the acoustic model wants where nobody asks for others.
//
// Beams have flanks: the fan reaches beyond the outer beams, and in elevation to where a beam of this width
// hears next to nothing. With side lobes that is nowhere: the floor right below a sonar returns its echo from
// straight on, and without it a noise floor comes out 0.3 dB too high. Rows crowd about the horizon, so that
// a floor far away has no combs. Rays are staggered both ways: a likelihood goes up and down from one pose to
// the next as rays come and go at edges, and staggered it does so by a fifth of what it would.
#pragma once

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/rays/ray_fan.h"

namespace sonarcal::sim {

// Throws DataError where neither parameters nor sonar know the beam's width.
RayFanOptions AcousticFanOptions(const SonarModel& sonar, const ParameterSet& parameters);

}  // namespace sonarcal::sim
