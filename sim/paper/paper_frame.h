// Polar image of the paper's model from a pose, in one pass: rays are cast, shaded, displaced and summed row
// by row, and no ray is stored.
//
// Equals RenderPaperImage (sim/paper/paper_image.h, which states the order of the formulas) of the traced
// echoes, in single precision. The same seed gives the same range and azimuth errors. Sums differ by less
// than a hundredth of a grey level of 255, except where rounding moves a ray across a bin's border. Requires
// normals of the mesh; normals of the point cloud need the list of echoes.
//
// The image depends on the seed and the fan, not on the number of threads.
#pragma once

#include "sim/paper/paper_image.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

PolarImage RenderPaperFrame(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                            const SonarModel& sonar, const PaperParameters<double>& parameters,
                            double absorption_db_per_m, const PaperImageOptions& options = {});

}  // namespace sonarcal::sim
