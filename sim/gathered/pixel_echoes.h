// The echoes behind each pixel of a frame through a fixed point spread function: sim/gathered/echo_power.h
// after sim/gathered/power_response.h. A pixel's mean power is then a short sum over incidence nodes,
//
//   S(r, b) = sum over entries of weight x sigma_material(incidence),
//
// and a fit of backscatter curves and receiver needs nothing else: no ray and no blur.
//
// Nodes are coarser than those of EchoPower where curves are smooth: half a degree up to 20 degrees, one up
// to 40, two beyond. Joined by straight lines in power, a Gaussian of half-width 3 degrees is within 0.02 dB,
// one of 1 degree within 0.14 dB; a cosine of any exponent up to 4 within 0.02 dB up to 80 degrees. What is
// less than kNegligibleShare of a pixel's sum is left out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/gathered/echo_power.h"
#include "sim/gathered/power_response.h"
#include "sim/simulator.h"

namespace sonarcal::sim {

inline constexpr double kNegligibleShare = 1e-6;

// Angles of the coarse nodes, degrees.
const std::vector<double>& CoarseIncidenceDeg();

struct PixelEchoes {
  struct Entry {
    std::uint32_t node = 0;  // material x CoarseIncidenceDeg().size() + node
    float weight = 0.0F;
  };
  int materials = 0;
  std::vector<std::uint32_t> start;  // first entry of each pixel, range bin by range bin; pixels + 1 values
  std::vector<Entry> entries;
};

PixelEchoes GatherPixelEchoes(const EchoPower& echoes, const PowerResponse& response,
                              double negligible_share = kNegligibleShare);

// The same from a pose: traces the simulator's fan, gathers its echoes by the elevation response, and sends
// them through beam and pulse of the parameters; and the two steps of it one by one.
EchoPower EchoesOfPose(const Simulator& simulator, const Pose& world_from_sonar,
                       const ParameterSet& parameters);
PixelEchoes ThroughBeamAndPulse(const Simulator& simulator, const EchoPower& echoes,
                                const ParameterSet& parameters);
PixelEchoes GatherPixelEchoes(const Simulator& simulator, const Pose& world_from_sonar,
                              const ParameterSet& parameters);

// (above - below) x scale, entry by entry.
PixelEchoes Difference(const PixelEchoes& above, const PixelEchoes& below, double scale);

// What a pixel needs to know of a curve at a node: its power, and the derivatives by A, B, C, D, E and F.
inline constexpr int kCurveTerms = 7;
inline constexpr int kCurveStride = 8;  // in a table: aligned for vector instructions

// Adds a pixel's echoes, material by material: `sums` holds kCurveStride values for each material, `curves`
// as many for each node of each material. Of materials that the pixel does not show, nothing is touched.
inline void AddCurves(const PixelEchoes& echoes, std::size_t pixel, std::span<const double> curves,
                      std::span<double> sums) {
  const auto nodes = static_cast<std::uint32_t>(CoarseIncidenceDeg().size());
  std::uint32_t e = echoes.start[pixel];
  const std::uint32_t last = echoes.start[pixel + 1];
  while (e < last) {
    const std::uint32_t material = echoes.entries[e].node / nodes;
    const std::uint32_t next_material = (material + 1) * nodes;
    std::array<double, kCurveStride> of{};
    for (; e < last && echoes.entries[e].node < next_material; ++e) {
      const double weight = echoes.entries[e].weight;
      const double* at = &curves[std::size_t{kCurveStride} * echoes.entries[e].node];
      for (int k = 0; k < kCurveStride; ++k) of[k] += weight * at[k];
    }
    for (int k = 0; k < kCurveStride; ++k) sums[std::size_t{kCurveStride} * material + k] += of[k];
  }
}

}  // namespace sonarcal::sim
