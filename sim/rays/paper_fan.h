// Default rays of the paper's model with the sampling `beams`: columns x rows, staggered.
//
// The number of rows is the smallest, in steps of ten, that keeps 99.9 % of the pixels within one grey level
// of a reference image. The reference has 64 times 1500 x 1200 rays and a display of 60 dB up to the
// brightest echo. The condition holds in each built-in scene; the bridge pier needs the most rows
// (docs/studies/rays.md). Command for the P900-45:
//
//   sonarcal rays --scene paper/SCENE.gltf --sonar p900-45 --params paper/params.json
//     --poses paper/poses_SCENE.json --display-db 60 --sampling beams --rays 512x320 --rays 512x330
//
// For any sonar and any elevation span, fewer than 255 rows draw stripes of more than one level on a floor.
// Edges of pipes need two columns per beam.
#pragma once

#include "core/types/sonar_model.h"
#include "sim/rays/ray_fan.h"

namespace sonarcal::sim {

inline constexpr int kPaperColumnsPerBeam = 2;
inline constexpr int kPaperBeamRows = 330;

inline RayFanOptions PaperFanOptions(const SonarModel& sonar) {
  return {.sampling = Sampling::kBeams,
          .cols = kPaperColumnsPerBeam * sonar.axes.beam_count(),
          .rows = kPaperBeamRows,
          .stagger = true};
}

}  // namespace sonarcal::sim
