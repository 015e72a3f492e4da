// Echoes of a frame, gathered by where they arrive: the power that a patch of unit backscattering strength
// would return, by its incidence on its material. The mean power of the acoustic model is linear in the
// backscatter curves. A fit of materials, beam, pulse and receiver therefore needs no other geometry and
// casts no ray.
//
// Cells are fine rows of range times columns of the ray fan, or fewer columns
// (sim/gathered/cast_echo_power.h). An echo is shared between the two nearest rows, so power changes smoothly
// with range. Incidence uses the grid of sim/paper/echo_histogram.h. A curve is piecewise linear in power
// between its values at the nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types/parameters.h"
#include "sim/paper/echo_histogram.h"
#include "sim/physics/echo_power_model.h"
#include "sim/rays/trace.h"

namespace sonarcal::sim {

struct EchoPower {
  struct Cell {
    std::int32_t row = 0;
    std::int32_t col = 0;
    std::uint32_t first_entry = 0;
    std::uint32_t last_entry = 0;  // one past
  };
  struct Entry {
    std::uint32_t node = 0;  // material * nodes + node
    float power = 0.0F;      // sum of 10^(-(40 log10 R + 2 alpha R) / 10) R^2 dOmega / cos(delta) el(phi)
  };

  int range_steps = 0;  // rows per range bin
  int rows = 0;         // range_steps x range bins
  int cols = 0;
  int materials = 0;
  int nodes = kIncidenceNodes;  // per material; or those of CoarseIncidenceDeg (sim/gathered/pixel_echoes.h)
  // Columns of the fan per column here. Above 1, an echo is shared between the two nearest ones.
  int columns_together = 1;
  std::vector<double> column_azimuth_rad;
  std::vector<Cell> cells;  // by row, then column; a cell may occur twice
  std::vector<Entry> entries;
};

// Share of one echo for a node of one cell, row * cols + col.
struct EchoShare {
  std::uint32_t cell;
  std::uint32_t node;
  float power;
};

// Sums shares by cell and node. Keeps the other members of `frame`.
EchoPower SumShares(EchoPower frame, const std::vector<EchoShare>& shares);

// Gathers the echoes of a fan. Materials and levels of the parameters are not used.
EchoPower GatherEchoPower(const EchoList& echoes, const RayFan& fan, const AcousticGeometry& geometry,
                          const ParameterSet& parameters);

}  // namespace sonarcal::sim
