// A frame's echoes, gathered by where they arrive: the power that a patch of unit backscattering strength
// would return there, by its incidence on its material. The mean power of the acoustic model is linear in the
// backscatter curves, so this is all that a fit of materials, beam, pulse and receiver needs of the geometry:
// no ray is cast while it runs.
//
// Cells are fine rows of range (an echo is shared between the two nearest, so that power changes smoothly
// with range) times columns of the ray fan. Incidence is kept on the grid of sim/paper/echo_histogram.h; a
// curve is its values at the nodes, joined by straight lines in power.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types/sonar_model.h"
#include "sim/paper/echo_histogram.h"
#include "sim/physics/beam_pattern.h"
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
    std::uint32_t node = 0;  // material * kIncidenceNodes + node
    float power = 0.0F;      // sum of 10^(-(40 log10 R + 2 alpha R) / 10) R^2 dOmega / cos(delta) el(phi)
  };

  int range_steps = 0;  // rows a range bin
  int rows = 0;         // range_steps x range bins
  int cols = 0;
  int materials = 0;
  std::vector<double> column_azimuth_rad;
  std::vector<Cell> cells;  // by row, then column
  std::vector<Entry> entries;
};

struct EchoPowerOptions {
  double absorption_db_per_m = 0.0;
  ElevationResponse elevation{ElevationPattern::kGaussian, 0.0, 0.0};  // none
  int range_steps = 4;                                                 // at least 4 a pulse length
};

// What one echo gives to a node of one cell, row * cols + col.
struct EchoShare {
  std::uint32_t cell;
  std::uint32_t node;
  float power;
};

// Sums shares by cell and node; the rest of `frame`, all but cells and entries, is kept.
EchoPower SumShares(EchoPower frame, const std::vector<EchoShare>& shares);

EchoPower GatherEchoPower(const EchoList& echoes, const RayFan& fan, const PolarAxes& axes,
                          const EchoPowerOptions& options);

}  // namespace sonarcal::sim
