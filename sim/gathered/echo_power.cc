#include "sim/gathered/echo_power.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/units.h"
#include "sim/physics/fine_rows.h"
#include "sim/physics/patch.h"

namespace sonarcal::sim {
namespace {

// Shares of each echo for the cells and nodes around it.
std::vector<EchoShare> Shares(const EchoList& echoes, const RayFan& fan, const EchoPowerModel& model,
                              const FineRows& rows) {
  std::vector<EchoShare> shares;
  shares.reserve(4 * echoes.size());
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const double range_m = echoes.range_m[echo];
    const double incidence_rad = echoes.incidence_rad[echo];
    const double power =
        EchoPowerModel::UnitPower(model.StraightBack(range_m, incidence_rad, echoes.solid_angle_sr[echo],
                                                     model.elevation().Power(echoes.elevation_rad[echo])));
    const double angle = DegFromRad(incidence_rad) / kIncidenceStepDeg;
    const int node = std::clamp(static_cast<int>(angle), 0, kIncidenceNodes - 2);
    const double between = std::clamp(angle - node, 0.0, 1.0);
    const auto first_node = static_cast<std::uint32_t>(echoes.material[echo] * kIncidenceNodes + node);
    const auto row_of_ray = static_cast<int>(echoes.ray[echo] / echoes.cols);
    const auto col = static_cast<int>(echoes.ray[echo] % echoes.cols);
    const double depth_m =
        PatchDepthM(range_m, fan.SpreadHeightRad(row_of_ray, col), std::cos(incidence_rad));
    rows.Spread(range_m, depth_m, power, [&](int row, double of_row) {
      const auto cell = static_cast<std::uint32_t>(row * echoes.cols + col);
      shares.push_back({cell, first_node, static_cast<float>(of_row * (1.0 - between))});
      shares.push_back({cell, first_node + 1, static_cast<float>(of_row * between)});
    });
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

EchoPower GatherEchoPower(const EchoList& echoes, const RayFan& fan, const AcousticGeometry& geometry,
                          const ParameterSet& parameters) {
  EchoPower frame;
  frame.range_steps = RangeStepsFor(geometry.sonar, parameters);
  const FineRows rows(geometry.sonar.axes, frame.range_steps, PulseLengthM(geometry.sonar, parameters));
  frame.rows = rows.count;
  frame.cols = echoes.cols;
  frame.materials = static_cast<int>(echoes.material_names.size());
  for (int col = 0; col < fan.cols(); ++col) frame.column_azimuth_rad.push_back(fan.AzimuthRad(col));
  const std::vector<EchoShare> shares = Shares(echoes, fan, EchoPowerModel(geometry, parameters, {}), rows);
  return SumShares(std::move(frame), shares);
}

}  // namespace sonarcal::sim
