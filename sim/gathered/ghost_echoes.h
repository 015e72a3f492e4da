// Multipath echoes of each pixel of a frame through a fixed point spread function;
// sim/gathered/pixel_echoes.h does the same for direct echoes. The mean power of a pixel is a short sum by
// path, material and part of the curve,
//
//   S(r, b) = sum over paths of 10^(-(losses of the path's reflections) / 10)
//               sum over entries of weight x sigma_material,part(angle),
//
// so a fit of losses, curves and receiver casts no ray.
//
// For scattering between two directions, the peaks of a curve depend on the tilt of facets, the rest on the
// geometric mean of two cosines (GsabBetweenPower, sim/physics/gsab.h). Each of these two parts has its own
// angle, on nodes coarser than those of direct echoes. Interpolation is linear in power. Its errors:
//
//   peak of half-width 3 degrees               0.4 % of its top
//   peak of half-width 1 degree                4 %
//   cosine of exponent up to 2, to 80 degrees  2 %
//   cosine of exponent up to 4, to 80 degrees  12 %
//
// Entries below kNegligibleGhost of a pixel's multipath power are omitted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/gathered/pixel_echoes.h"
#include "sim/ghosts/ghost_trace.h"

namespace sonarcal::sim {

inline constexpr double kNegligibleGhost = 1e-5;

// Mirrors on an echo's path there and back: the material of each reflection, in ascending order.
using GhostWay = std::vector<std::uint16_t>;

enum class CurvePart { kPeaks = 0, kSlow = 1 };
inline constexpr int kCurveParts = 2;

struct GhostEchoes {
  std::vector<GhostWay> ways;
  int materials = 0;
  // Indexed by paths x materials x kCurveParts instead of materials, in this order.
  PixelEchoes pixels = {};

  bool empty() const { return pixels.entries.empty(); }
};

// Path of an echo.
GhostWay WayOf(const GhostEcho& echo);

// Text for a path: "floor twice", "floor" or "floor and wall".
std::string WayName(const GhostWay& way, const std::vector<std::string>& material_names);

// Paths of a list, sorted.
std::vector<GhostWay> WaysOf(const GhostList& ghosts);

// Applies beam and pulse of the parameters to a list that was traced before. Losses and curves have no
// effect.
GhostEchoes GatherGhostEchoes(const Simulator& simulator, const GhostList& ghosts,
                              const ParameterSet& parameters);

}  // namespace sonarcal::sim
