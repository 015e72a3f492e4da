// The ghosts behind each pixel of a frame through a fixed point spread function, as
// sim/gathered/pixel_echoes.h has its direct echoes: a pixel's mean power is again a short sum, now by way,
// material and part of its curve,
//
//   S(r, b) = sum over ways of 10^(-(losses of the way's reflections) / 10)
//               sum over entries of weight x sigma_material,part(angle),
//
// so that a fit of losses, curves and receiver casts no ray. Between two directions the peaks of a curve go
// by the tilt of facets and the rest by the geometric mean of two cosines (GsabBetweenPower,
// sim/physics/gsab.h): two parts, each by an angle of its own, on nodes coarser than those of direct echoes.
// Joined by straight lines in power, a peak of half-width 3 degrees is within 0.4 % of its top, one of 1
// degree within 4 %; a cosine of any exponent up to 2 within 2 % up to 80 degrees, up to 4 within 12 %. What
// is less than kNegligibleGhost of a pixel's ghosts is left out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/gathered/pixel_echoes.h"
#include "sim/ghosts/ghost_trace.h"

namespace sonarcal::sim {

inline constexpr double kNegligibleGhost = 1e-5;

// The mirrors that an echo goes by there and back: materials, one for each reflection, in rising order.
using GhostWay = std::vector<std::uint16_t>;

enum class CurvePart { kPeaks = 0, kSlow = 1 };
inline constexpr int kCurveParts = 2;

struct GhostEchoes {
  std::vector<GhostWay> ways;
  int materials = 0;
  // Of ways x materials x kCurveParts in place of materials, in this order.
  PixelEchoes pixels = {};

  bool empty() const { return pixels.entries.empty(); }
};

// By which an echo comes.
GhostWay WayOf(const GhostEcho& echo);

// "floor twice", "floor" or "floor and wall": what a way goes by, in words.
std::string WayName(const GhostWay& way, const std::vector<std::string>& material_names);

// The ways that a list has, in their order.
std::vector<GhostWay> WaysOf(const GhostList& ghosts);

// A list, traced before, through beam and pulse of the parameters; losses and curves count for nothing.
GhostEchoes GatherGhostEchoes(const Simulator& simulator, const GhostList& ghosts,
                              const ParameterSet& parameters);

}  // namespace sonarcal::sim
