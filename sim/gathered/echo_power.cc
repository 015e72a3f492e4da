#include "sim/gathered/echo_power.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_pattern.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"

namespace sonarcal::sim {
namespace {

// Shares of each echo for the cells and nodes around it.
std::vector<EchoShare> Shares(const EchoList& echoes, const PolarAxes& axes, const EchoPowerOptions& options,
                              int rows) {
  const double step_m = axes.range_bin_m() / options.range_steps;
  std::vector<EchoShare> shares;
  shares.reserve(4 * echoes.size());
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const double range_m = echoes.range_m[echo];
    const double incidence_rad = echoes.incidence_rad[echo];
    const double area_m2 = PatchAreaM2(range_m, echoes.solid_angle_sr[echo], std::cos(incidence_rad));
    double power = PowerFromDb(-2.0 * TransmissionLossDb(range_m, options.absorption_db_per_m)) * area_m2;
    power *= options.elevation.Power(echoes.elevation_rad[echo]);
    const double position = (range_m - axes.range_min_m) / step_m - 0.5;
    const int row = static_cast<int>(std::floor(position));
    const double along = position - row;
    const double angle = DegFromRad(incidence_rad) / kIncidenceStepDeg;
    const int node = std::clamp(static_cast<int>(angle), 0, kIncidenceNodes - 2);
    const double between = std::clamp(angle - node, 0.0, 1.0);
    const auto first_node = static_cast<std::uint32_t>(echoes.material[echo] * kIncidenceNodes + node);
    const std::uint32_t col = echoes.ray[echo] % echoes.cols;
    for (const int side : {0, 1}) {
      if (row + side < 0 || row + side >= rows) continue;
      const auto cell = static_cast<std::uint32_t>(row + side) * echoes.cols + col;
      const double of_row = power * (side == 0 ? 1.0 - along : along);
      shares.push_back({cell, first_node, static_cast<float>(of_row * (1.0 - between))});
      shares.push_back({cell, first_node + 1, static_cast<float>(of_row * between)});
    }
  }
  return shares;
}

}  // namespace

EchoPower SumShares(EchoPower frame, const std::vector<EchoShare>& shares) {
  EchoPower gathered = std::move(frame);
  // Counting sort by cell, then by node within a cell.
  const std::size_t cell_count = static_cast<std::size_t>(gathered.rows) * gathered.cols;
  std::vector<std::uint32_t> start(cell_count + 1, 0);
  for (const EchoShare& share : shares) ++start[share.cell + 1];
  for (std::size_t cell = 0; cell < cell_count; ++cell) start[cell + 1] += start[cell];
  std::vector<EchoPower::Entry> sorted(shares.size());
  {
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (const EchoShare& share : shares) sorted[next[share.cell]++] = {share.node, share.power};
  }
  for (std::size_t cell = 0; cell < cell_count; ++cell) {
    const auto begin = sorted.begin() + start[cell];
    const auto end = sorted.begin() + start[cell + 1];
    if (begin == end) continue;
    std::sort(begin, end, [](const auto& a, const auto& b) { return a.node < b.node; });
    const auto first_entry = static_cast<std::uint32_t>(gathered.entries.size());
    for (auto it = begin; it != end; ++it) {
      if (it->power == 0.0F) continue;
      if (gathered.entries.size() > first_entry && gathered.entries.back().node == it->node) {
        gathered.entries.back().power += it->power;
      } else {
        gathered.entries.push_back(*it);
      }
    }
    const auto last_entry = static_cast<std::uint32_t>(gathered.entries.size());
    if (last_entry == first_entry) continue;
    gathered.cells.push_back({.row = static_cast<std::int32_t>(cell / gathered.cols),
                              .col = static_cast<std::int32_t>(cell % gathered.cols),
                              .first_entry = first_entry,
                              .last_entry = last_entry});
  }
  gathered.entries.shrink_to_fit();
  return gathered;
}

EchoPower GatherEchoPower(const EchoList& echoes, const RayFan& fan, const PolarAxes& axes,
                          const EchoPowerOptions& options) {
  SONARCAL_CHECK(options.range_steps >= 1, "{} rows a range bin", options.range_steps);
  EchoPower frame;
  frame.range_steps = options.range_steps;
  frame.rows = axes.range_bins * options.range_steps;
  frame.cols = echoes.cols;
  frame.materials = static_cast<int>(echoes.material_names.size());
  for (int col = 0; col < fan.cols(); ++col) frame.column_azimuth_rad.push_back(fan.AzimuthRad(col));
  const std::vector<EchoShare> shares = Shares(echoes, axes, options, frame.rows);
  return SumShares(std::move(frame), shares);
}

}  // namespace sonarcal::sim
