// Power that a scene scatters, in one pass over the rays: cast, shaded and summed as they are met, with no
// list of echoes in between. What MakeScatterMap (sim/acoustic/acoustic_image.h) makes of the same rays, to
// single precision; its formulas are stated there.
#pragma once

#include "sim/acoustic/acoustic_image.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

// For fans of the sampling `beams` and normals of the mesh. The same on any number of threads.
ScatterMap CastScatterMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                          const AcousticGeometry& geometry, const ParameterSet& parameters);

// The same by whichever way these rays and normals allow.
ScatterMap ScatterFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                       const AcousticGeometry& geometry, const ParameterSet& parameters,
                       const TraceOptions& options);

}  // namespace sonarcal::sim
