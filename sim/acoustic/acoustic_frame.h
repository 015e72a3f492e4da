// Power that a scene scatters, in one pass: rays are cast, shaded and summed without a list of echoes. Equals
// MakeScatterMap (sim/acoustic/acoustic_image.h) of the same rays to single precision; the formulas are
// stated there.
#pragma once

#include <string>
#include <vector>

#include "sim/acoustic/acoustic_image.h"
#include "sim/acoustic/patch_shader.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

// Requires a fan with the sampling `beams`; uses normals of the mesh. The result does not depend on the
// number of threads.
ScatterMap CastScatterMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                          const AcousticGeometry& geometry, const ParameterSet& parameters);

// Maps ThroughPulse(CastScatterMap(...)) of many poses to single precision, at a lower cost: tables are made
// once, and the map of a block of columns stays in the processor's cache.
class PulsedCaster {
 public:
  // The fan has the sampling `beams`. Fan and sonar must outlive this.
  PulsedCaster(const RayFan& fan, const AcousticGeometry& geometry, const ParameterSet& parameters,
               const std::vector<std::string>& material_names);

  PulsedMap Cast(const RayCaster& caster, const Pose& world_from_sonar) const;

 private:
  const RayFan& fan_;
  const SonarModel& sonar_;
  PatchShader shader_;
  FineRows rows_;
  int steps_;                 // fine rows per range bin
  int first_row_;             // of the pulse, relative to the bin's own first row
  std::vector<float> pulse_;  // weights of fine rows
};

// True if CastScatterMap and PulsedCaster support these rays and normals.
inline bool CastsInOnePass(const RayFan& fan, const TraceOptions& options) {
  return fan.sampling() == Sampling::kBeams && options.normals == NormalSource::kGeometric;
}

// Uses CastScatterMap if the fan and the normals permit it, otherwise traces a list of echoes.
ScatterMap ScatterFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                       const AcousticGeometry& geometry, const ParameterSet& parameters,
                       const TraceOptions& options);

}  // namespace sonarcal::sim
