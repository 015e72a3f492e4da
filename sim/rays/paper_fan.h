// The rays of `beams` that the paper's model wants where nobody asks for others: columns x rows, staggered.
//
// The fewest, in steps of ten rows, that leave 99.9 % of the pixels within one grey level of an image of 64
// times 1500 x 1200 rays, in each of the program's scenes, on a display of 60 dB up to the brightest echo.
// Found for the P900-45 by
//
//   sonarcal rays --scene paper/SCENE.gltf --sonar p900-45 --params paper/params.json
//     --poses paper/poses_SCENE.json --display-db 60 --sampling beams --rays 512x320 --rays 512x330
//
// of whose scenes the bridge pier asks for most (docs/studies/rays.md). For any sonar: fewer than 255 rows stripe a
// floor by more than a level whatever their span, and two columns are what the edges of pipes take.
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
