#include "sim/paper/echo_histogram.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

// Cells and entries of a few rows, counted from the first of them.
struct RowCells {
  std::vector<std::uint32_t> row_start;  // first cell of each row
  std::vector<EchoHistogram::Cell> cells;
  std::vector<EchoHistogram::Entry> entries;
};

// `order`: echoes sorted by cell; `start`: first of each cell.
RowCells CellsOfRows(const EchoList& echoes, const PolarAxes& axes, const std::vector<double>& edges_rad,
                     const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& order,
                     int first_row, int last_row) {
  const int beams = axes.beam_count();
  const double step_m = axes.range_bin_m() / kRangeSteps;
  RowCells of;
  // Dense weights of one cell, cleared through the list of nodes that it touched.
  std::vector<double> node_weight(echoes.material_names.size() * kIncidenceNodes, 0.0);
  std::vector<std::uint32_t> touched;
  const auto add = [&](std::uint32_t node, double weight) {
    if (weight == 0.0) return;
    if (node_weight[node] == 0.0) touched.push_back(node);
    node_weight[node] += weight;
  };

  for (int row = first_row; row < last_row; ++row) {
    of.row_start.push_back(static_cast<std::uint32_t>(of.cells.size()));
    for (int col = 0; col < beams; ++col) {
      const std::size_t index = static_cast<std::size_t>(row) * beams + col;
      if (start[index] == start[index + 1]) continue;
      EchoHistogram::Cell cell{.row = row, .col = col};
      double range_sum = 0.0;
      double azimuth_sum = 0.0;
      for (std::uint32_t i = start[index]; i < start[index + 1]; ++i) {
        const std::uint32_t echo = order[i];
        const double weight = echoes.Weight(echo) / echoes.rays_per_beam[col];
        const double range_m = echoes.range_m[echo];
        cell.weight += weight;
        range_sum += weight * ((range_m - axes.range_min_m) / step_m - (row + 0.5));
        azimuth_sum += weight * (echoes.azimuth_rad[echo] - 0.5 * (edges_rad[col] + edges_rad[col + 1]));
        cell.log_range += weight * 40.0 * std::log10(range_m);
        cell.two_way_range_m += weight * 2.0 * range_m;
        const double position = DegFromRad<double>(echoes.incidence_rad[echo]) / kIncidenceStepDeg;
        const int node = std::clamp(static_cast<int>(position), 0, kIncidenceNodes - 2);
        const double fraction = std::clamp(position - node, 0.0, 1.0);
        const auto first = static_cast<std::uint32_t>(echoes.material[echo] * kIncidenceNodes + node);
        add(first, weight * (1.0 - fraction));
        add(first + 1, weight * fraction);
      }
      if (cell.weight == 0.0) continue;  // rays of weight 0
      // Clamps an echo of an outer margin, or one rounded across a border, to the cell's border.
      const double width_rad = edges_rad[col + 1] - edges_rad[col];
      cell.range_offset = static_cast<float>(std::clamp(range_sum / cell.weight, -0.5, 0.5));
      cell.azimuth_offset = static_cast<float>(std::clamp(azimuth_sum / cell.weight / width_rad, -0.5, 0.5));
      std::sort(touched.begin(), touched.end());
      cell.first_entry = static_cast<std::uint32_t>(of.entries.size());
      for (const std::uint32_t node : touched) {
        of.entries.push_back({node, static_cast<float>(node_weight[node])});
        node_weight[node] = 0.0;
      }
      cell.last_entry = static_cast<std::uint32_t>(of.entries.size());
      touched.clear();
      of.cells.push_back(cell);
    }
  }
  return of;
}

}  // namespace

EchoHistogram GatherEchoes(const EchoList& echoes, const PolarAxes& axes) {
  EchoHistogram histogram;
  histogram.rows = axes.range_bins * kRangeSteps;
  histogram.beams = axes.beam_count();
  histogram.materials = static_cast<int>(echoes.material_names.size());
  const double step_m = axes.range_bin_m() / kRangeSteps;
  const std::vector<double> edges_rad = axes.BeamEdgesRad();
  const std::size_t cells = static_cast<std::size_t>(histogram.rows) * histogram.beams;

  // Counting sort of echoes by cell.
  std::vector<std::uint32_t> cell_of_echo(echoes.size());
  std::vector<std::uint32_t> start(cells + 1, 0);
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const int row = std::clamp(static_cast<int>((echoes.range_m[echo] - axes.range_min_m) / step_m), 0,
                               histogram.rows - 1);
    cell_of_echo[echo] = static_cast<std::uint32_t>(row * histogram.beams + echoes.Beam(echo));
    ++start[cell_of_echo[echo] + 1];
  }
  for (std::size_t cell = 0; cell < cells; ++cell) start[cell + 1] += start[cell];
  std::vector<std::uint32_t> order(echoes.size());
  {
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
      order[next[cell_of_echo[echo]]++] = static_cast<std::uint32_t>(echo);
    }
  }

  // Cells of a few rows at a time, on all cores; joined in the order of the rows.
  constexpr int kRowsTogether = 16;
  const int parts = (histogram.rows + kRowsTogether - 1) / kRowsTogether;
  std::vector<RowCells> cells_of(parts);
  tbb::parallel_for(0, parts, [&](int part) {
    const int first_row = part * kRowsTogether;
    cells_of[part] = CellsOfRows(echoes, axes, edges_rad, start, order, first_row,
                                 std::min(first_row + kRowsTogether, histogram.rows));
  });
  for (const RowCells& of : cells_of) {
    const auto first_cell = static_cast<std::uint32_t>(histogram.cells.size());
    const auto first_entry = static_cast<std::uint32_t>(histogram.entries.size());
    for (const std::uint32_t at : of.row_start) histogram.row_start.push_back(first_cell + at);
    for (EchoHistogram::Cell cell : of.cells) {
      cell.first_entry += first_entry;
      cell.last_entry += first_entry;
      histogram.cells.push_back(cell);
    }
    histogram.entries.insert(histogram.entries.end(), of.entries.begin(), of.entries.end());
  }
  histogram.row_start.push_back(static_cast<std::uint32_t>(histogram.cells.size()));
  return histogram;
}

}  // namespace sonarcal::sim
