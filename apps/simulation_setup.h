// How `simulate` samples a scene by its options, for every command whose images are to be those of
// `simulate`.
#pragma once

#include <optional>

#include "apps/ray_options.h"
#include "data_io/types/parameters.h"

namespace sonarcal {

// Rays, trace, absorption and water: those asked for, else those that the parameters' model wants.
// `margin_deg` is the azimuth cast beyond the outer beams; absent: none for the paper's model, three beam
// widths for the others. Throws UsageError for wrong rays, DataError where neither parameters nor sonar know
// the beam's width.
SimulationOptions SimulationFor(const RayOptions& rays, const SonarModel& sonar, const Water& water,
                                const ParameterSet& parameters, std::optional<double> margin_deg = {});

}  // namespace sonarcal
