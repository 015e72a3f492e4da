// The paper's polar image of a pose in one pass: rays are cast, shaded, displaced and summed row by row, and
// nothing of a ray is kept.
//
// The same image as RenderPaperImage (sim/paper/paper_image.h, where the formulas' order is stated) makes of
// the traced echoes, with the same errors of range and azimuth for the same seed, in single precision: sums
// differ by less than a hundredth of a grey level of 255, but where rounding moves a ray across a bin's
// border. For normals of the mesh; those of the point cloud need the echoes.
//
// It depends on the seed and the fan alone, not on the number of threads.
#pragma once

#include "sim/paper/paper_image.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

PolarImage RenderPaperFrame(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                            const SonarModel& sonar, const PaperParameters<double>& parameters,
                            double absorption_db_per_m, const PaperImageOptions& options = {});

}  // namespace sonarcal::sim
