// Echoes of a frame, gathered while its rays are cast: equals GatherEchoPower (sim/gathered/echo_power.h) of
// the same rays, without a list of echoes and their sort.
//
// Nodes are those of CoarseIncidenceDeg (sim/gathered/pixel_echoes.h). Where a beam is much wider than a
// column of rays, an echo is shared between the two nearest of fewer columns: at least kColumnsOfBeam per
// half-power width. SharpenedForShares corrects the weights of a beam for that on average. What remains of a
// single echo, with n = kColumnsOfBeam:
//
//   at its peak              1 / 12 x 8 ln 2 / n^2 = 0.4 %
//   up to 40 dB down a flank 0.16 dB
#pragma once

#include <vector>

#include "sim/gathered/echo_power.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

inline constexpr double kColumnsOfBeam = 11.0;

// Requires a fan with the sampling `beams`; uses normals of the mesh. The result does not depend on the
// number of threads. Materials and levels of the parameters are not used.
EchoPower CastEchoPower(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                        const AcousticGeometry& geometry, const ParameterSet& parameters);

// Number of neighbouring columns of a fan that CastEchoPower joins; 1 for a beam pattern given as a table.
int ColumnsTogether(const RayFan& fan, const AcousticGeometry& geometry, const ParameterSet& parameters);

// Weights for echoes from `together` columns that are shared between two columns each: less the multiple
// (1 - 1 / together^2) / 12 of their second difference, by which linear interpolation at these columns
// differs from the response on average.
std::vector<ResponseWindow> SharpenedForShares(std::vector<ResponseWindow> windows, int together);

}  // namespace sonarcal::sim
