#include "sim/acoustic/acoustic_frame.h"

#include <tbb/enumerable_thread_specific.h>

#include "core/types/error.h"
#include "sim/acoustic/patch_shader.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/patch.h"

namespace sonarcal::sim {

ScatterMap CastScatterMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                          const AcousticGeometry& geometry, const ParameterSet& parameters) {
  SONARCAL_CHECK(fan.sampling() == Sampling::kBeams, "a pinhole's rays are shaded one at a time");
  const PolarAxes& axes = geometry.sonar.axes;
  ScatterMap scatter = EmptyScatterMap(fan, geometry, parameters);
  const PatchShader shader(fan, EchoPowerModel(geometry, parameters, caster.material_names()),
                           ElevationWidthDeg(geometry.sonar, parameters.beam));
  const FineRows rows = scatter.RowsOf(axes);
  const auto nearest_m = static_cast<float>(axes.range_min_m);
  const auto farthest_m = static_cast<float>(axes.range_max_m);
  tbb::enumerable_thread_specific<PatchShader::Buffers> locals;
  caster.CastColumns(fan, world_from_sonar, axes.range_max_m, [&](const RowHits& hits) {
    if (hits.count == 0) return;
    PatchShader::Buffers& of = locals.local();
    shader.Shade(hits, of);
    for (int i = 0; i < hits.count; ++i) {
      const float range_m = hits.range_m[i];
      // A ray that starts on a surface hits it at range 0, where the transmission loss is undefined.
      if (!(range_m > 0.0F && range_m >= nearest_m && range_m < farthest_m)) continue;
      const double square = double{hits.half_tangent[i]} * hits.half_tangent[i];
      const double depth_m =
          PatchDepthM(range_m, fan.SpreadHeightRad(hits.row, 0), (1.0 - square) / (1.0 + square));
      scatter.Add(rows, range_m, depth_m, hits.col[i], shader.factor() * of.power[i]);
    }
  });
  return scatter;
}

ScatterMap ScatterFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                       const AcousticGeometry& geometry, const ParameterSet& parameters,
                       const TraceOptions& options) {
  if (fan.sampling() == Sampling::kBeams && options.normals == NormalSource::kGeometric)
    return CastScatterMap(caster, fan, world_from_sonar, geometry, parameters);
  return MakeScatterMap(Trace(caster, fan, world_from_sonar, geometry.sonar.axes, options), fan, geometry,
                        parameters);
}

}  // namespace sonarcal::sim
