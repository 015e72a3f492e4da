// Echoes of each pixel of a frame through a fixed point spread function: sim/gathered/echo_power.h after
// sim/gathered/power_response.h. The mean power of a pixel is then a short sum over incidence nodes,
//
//   S(r, b) = sum over entries of weight x sigma_material(incidence),
//
// so a fit of backscatter curves and receiver needs no ray and no blur.
//
// Nodes are coarser than those of EchoPower because curves are smooth: every half degree up to 20 degrees,
// every degree up to 40, every two degrees beyond. Interpolation is linear in power. Its errors:
//
//   Gaussian of half-width 3 degrees           0.02 dB
//   Gaussian of half-width 1 degree            0.14 dB
//   cosine of exponent up to 4, to 80 degrees  0.02 dB
//
// Entries below kNegligibleShare of a pixel's sum are omitted.
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

// Share of a node of kIncidenceNodes between two coarse nodes.
struct NodeShare {
  int node = 0;  // this node and the next
  double of_next = 0.0;
};
const std::array<NodeShare, kIncidenceNodes>& CoarseShares();

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

// Traces the simulator's fan from a pose, gathers its echoes with the elevation response, and applies beam
// and pulse of the parameters. EchoesOfPose and ThroughBeamAndPulse are the two steps of GatherPixelEchoes.
EchoPower EchoesOfPose(const Simulator& simulator, const Pose& world_from_sonar,
                       const ParameterSet& parameters);
PixelEchoes ThroughBeamAndPulse(const Simulator& simulator, const EchoPower& echoes,
                                const ParameterSet& parameters);
PixelEchoes GatherPixelEchoes(const Simulator& simulator, const Pose& world_from_sonar,
                              const ParameterSet& parameters);

// (above - below) x scale, entry by entry.
PixelEchoes Difference(const PixelEchoes& above, const PixelEchoes& below, double scale);

// Values of a curve at a node: its power, and the derivatives by A, B, C, D, E and F.
inline constexpr int kCurveTerms = 1 + kGsabMembers;
inline constexpr int kCurveStride = 8;  // stride in a table, aligned for vector instructions

// Adds a pixel's echoes, material by material. `sums` holds kCurveStride values per material, `curves`
// kCurveStride values per node of each material. Leaves materials that do not occur in the pixel unchanged.
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
