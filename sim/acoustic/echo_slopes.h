// Slopes of the mean power of echoes along small moves of the sonar, from one trace.
//
// A patch of the scene keeps its place and its area while the sonar moves. So its range, azimuth, elevation
// and incidence change as those of any point do, and the responses of pulse and beams tell what that changes
// in a pixel. Besides, patches appear and disappear at edges. An edge with the inverse range q_near crosses
// the patches behind it, with the inverse range q_far, at the angle (q_near - q_far) m per metre that the
// sonar moves across it. Each pair of neighbouring rays on either side of an edge contributes that share of
// the far patch. Turns of the sonar hide and show nothing.
//
// The same holds for a part of the scene that moves alone. Besides, the line where it touches another part
// moves.
//
// A difference of two images needs two traces per move and contains the rays that an edge happens to pass.
// Tests compare both.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/acoustic/acoustic_image.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

// Moves of the sonar along its axes (right, ahead, up), m, and turns about them, rad.
inline constexpr int kSonarMoves = 6;

using AlongMoves = std::array<Grid<float>, kSonarMoves>;

struct EchoSlopes {
  Grid<double> power;               // EchoPowerImage of the same rays
  AlongMoves along;                 // change of `power` per move of the sonar
  Grid<float> farther;              // change per metre by which all echoes arrive farther away
  std::vector<AlongMoves> of_part;  // change per move of a part of the scene, about the sonar along its axes
};

// Parts of a scene that move alone.
struct SceneParts {
  int count = 0;
  std::span<const std::int16_t> of_triangle;  // 0 .. count - 1; -1: none. May be empty if there are none.
};

// Requires a fan with the sampling `beams`; uses normals of the mesh. Echoes without multipath. The result
// does not depend on the number of threads.
EchoSlopes SlopesAlongMoves(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                            const AcousticGeometry& geometry, const ParameterSet& parameters,
                            const SceneParts& parts = {});

}  // namespace sonarcal::sim
