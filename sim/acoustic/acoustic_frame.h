// Power that a scene scatters, in one pass: rays are cast, shaded and summed without a list of echoes. Equals
// MakeScatterMap (sim/acoustic/acoustic_image.h) of the same rays to single precision; the formulas are
// stated there.
#pragma once

#include "sim/acoustic/acoustic_image.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

// Requires a fan with the sampling `beams`; uses normals of the mesh. The result does not depend on the
// number of threads.
ScatterMap CastScatterMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                          const AcousticGeometry& geometry, const ParameterSet& parameters);

// ThroughPulse(CastScatterMap(...)) to single precision, at a lower cost: the map of a block of columns stays
// in the processor's cache.
PulsedMap CastPulsedMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                        const AcousticGeometry& geometry, const ParameterSet& parameters);

// True if CastScatterMap and CastPulsedMap support these rays and normals.
inline bool CastsInOnePass(const RayFan& fan, const TraceOptions& options) {
  return fan.sampling() == Sampling::kBeams && options.normals == NormalSource::kGeometric;
}

// Uses CastScatterMap if the fan and the normals permit it, otherwise traces a list of echoes.
ScatterMap ScatterFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                       const AcousticGeometry& geometry, const ParameterSet& parameters,
                       const TraceOptions& options);

// As ScatterFrom, through the pulse.
PulsedMap PulsedFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                     const AcousticGeometry& geometry, const ParameterSet& parameters,
                     const TraceOptions& options);

}  // namespace sonarcal::sim
