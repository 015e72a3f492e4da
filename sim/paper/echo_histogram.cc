#include "sim/paper/echo_histogram.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/rays/row_math/directions.h"

namespace sonarcal::sim {
namespace {

// Cells and entries of a few rows, counted from the first of them.
struct RowCells {
  std::vector<std::uint32_t> row_start;  // first cell of each row
  std::vector<EchoHistogram::Cell> cells;
  std::vector<EchoHistogram::Entry> entries;
};

// 40 log10 R of the echoes of a row of cells, dB. Ranges near the middle of the row use a series about it,
// which is exact to 1e-9 dB.
class RowLoss {
 public:
  explicit RowLoss(double middle_m)
      : middle_m_(middle_m), per_m_(1.0 / middle_m), at_middle_db_(kScale * std::log(middle_m)) {}

  double Db(double range_m) const {
    const double x = (range_m - middle_m_) * per_m_;
    if (!(std::abs(x) < kReach)) return kScale * std::log(range_m);
    return at_middle_db_ + kScale * x * (1.0 + x * (-0.5 + x / 3.0));
  }

 private:
  static constexpr double kScale = 40.0 / std::numbers::ln10;
  static constexpr double kReach = 3e-3;

  double middle_m_;
  double per_m_;
  double at_middle_db_;
};

// `order`: echoes sorted by cell; `start`: first of each cell.
RowCells CellsOfRows(const EchoList& echoes, const PolarAxes& axes, const std::vector<double>& edges_rad,
                     const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& order,
                     int first_row, int last_row) {
  const int beams = axes.beam_count();
  const double step_m = axes.range_bin_m() / kRangeSteps;
  constexpr double kNodesPerRad = DegFromRad<double>(1.0) / kIncidenceStepDeg;
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
    const double middle_m = axes.range_min_m + (row + 0.5) * step_m;
    const RowLoss loss(middle_m);
    for (int col = 0; col < beams; ++col) {
      const std::size_t index = static_cast<std::size_t>(row) * beams + col;
      if (start[index] == start[index + 1]) continue;
      EchoHistogram::Cell cell{.row = row, .col = col};
      const double middle_rad = 0.5 * (edges_rad[col] + edges_rad[col + 1]);
      const double per_ray = 1.0 / echoes.rays_per_beam[col];
      double range_sum_m = 0.0;
      double azimuth_sum_rad = 0.0;
      for (std::uint32_t i = start[index]; i < start[index + 1]; ++i) {
        const std::uint32_t echo = order[i];
        const double weight = echoes.Weight(echo) * per_ray;
        const double range_m = echoes.range_m[echo];
        cell.weight += weight;
        range_sum_m += weight * (range_m - middle_m);
        azimuth_sum_rad += weight * (echoes.azimuth_rad[echo] - middle_rad);
        cell.log_range += weight * loss.Db(range_m);
        const double position = kNodesPerRad * echoes.incidence_rad[echo];
        const int node = std::clamp(static_cast<int>(position), 0, kIncidenceNodes - 2);
        const double fraction = std::clamp(position - node, 0.0, 1.0);
        const auto first = static_cast<std::uint32_t>(echoes.material[echo] * kIncidenceNodes + node);
        add(first, weight * (1.0 - fraction));
        add(first + 1, weight * fraction);
      }
      if (cell.weight == 0.0) continue;  // rays of weight 0
      cell.two_way_range_m = 2.0 * (cell.weight * middle_m + range_sum_m);
      // Clamps an echo of an outer margin, or one rounded across a border, to the cell's border.
      const double width_rad = edges_rad[col + 1] - edges_rad[col];
      cell.range_offset = static_cast<float>(std::clamp(range_sum_m / cell.weight / step_m, -0.5, 0.5));
      cell.azimuth_offset =
          static_cast<float>(std::clamp(azimuth_sum_rad / cell.weight / width_rad, -0.5, 0.5));
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
  const double steps_per_m = kRangeSteps / axes.range_bin_m();
  const std::vector<double> edges_rad = axes.BeamEdgesRad();
  const std::size_t cells = static_cast<std::size_t>(histogram.rows) * histogram.beams;

  // Counting sort of echoes by cell.
  std::vector<std::uint32_t> cell_of_echo(echoes.size());
  std::vector<std::uint32_t> start(cells + 1, 0);
  std::uint32_t first_of_row = 0;  // ray
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    // A division per row of rays, not per echo.
    if (echoes.ray[echo] - first_of_row >= static_cast<std::uint32_t>(echoes.cols))
      first_of_row = echoes.ray[echo] - echoes.ray[echo] % echoes.cols;
    const int beam = echoes.beam_of_column[echoes.ray[echo] - first_of_row];
    const int row = std::clamp(static_cast<int>((echoes.range_m[echo] - axes.range_min_m) * steps_per_m), 0,
                               histogram.rows - 1);
    cell_of_echo[echo] = static_cast<std::uint32_t>(row * histogram.beams + beam);
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

EchoHistogram CastEchoHistogram(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                                const PolarAxes& axes) {
  const auto cols = static_cast<std::size_t>(fan.cols());
  // The echoes of a row begin at the index of its first ray. They are joined when all rows are counted.
  std::vector<std::uint32_t> ray(fan.size());
  std::vector<std::uint16_t> material(fan.size());
  std::vector<float> range_m(fan.size());
  std::vector<float> half_tangent(fan.size());
  std::vector<std::size_t> row_start(fan.rows() + 1, 0);
  caster.CastRows(fan, world_from_sonar, axes.range_max_m, [&](const RowHits& hits) {
    const std::size_t first = static_cast<std::size_t>(hits.row) * cols;
    std::size_t at = first;
    for (int i = 0; i < hits.count; ++i) {
      if (!IsEcho(hits.range_m[i], axes)) continue;
      ray[at] = static_cast<std::uint32_t>(first + static_cast<std::size_t>(hits.col[i]));
      material[at] = hits.material[i];
      range_m[at] = hits.range_m[i];
      half_tangent[at] = hits.half_tangent[i];
      ++at;
    }
    row_start[hits.row + 1] = at - first;
  });
  for (int row = 0; row < fan.rows(); ++row) row_start[row + 1] += row_start[row];

  // Elevations and solid angles stay empty, because a histogram does not use them.
  EchoList echoes = EmptyEchoList(fan, caster.material_names());
  const std::size_t count = row_start.back();
  echoes.ray.resize(count);
  echoes.material.resize(count);
  echoes.range_m.resize(count);
  echoes.azimuth_rad.resize(count);
  echoes.incidence_rad.resize(count);
  if (!fan.weighs_evenly()) echoes.weight.resize(count);
  const std::vector<float> ones(cols, 1.0F);
  tbb::parallel_for(tbb::blocked_range<int>(0, fan.rows(), 16), [&](const tbb::blocked_range<int>& rows) {
    std::vector<float> azimuth_rad(cols);
    std::vector<float> weight(cols, 1.0F);
    for (int row = rows.begin(); row != rows.end(); ++row) {
      const std::size_t from = static_cast<std::size_t>(row) * cols;
      const std::size_t to = row_start[row];
      const std::size_t here = row_start[row + 1] - to;
      std::copy_n(&ray[from], here, echoes.ray.begin() + to);
      std::copy_n(&material[from], here, echoes.material.begin() + to);
      std::copy_n(&range_m[from], here, echoes.range_m.begin() + to);
      float* incidence_rad = echoes.incidence_rad.data() + to;
      row_math::Angles(&half_tangent[from], ones.data(), static_cast<int>(here), incidence_rad);
      for (std::size_t i = 0; i < here; ++i) incidence_rad[i] *= 2.0F;
      fan.RowAzimuths(row, azimuth_rad.data());
      for (std::size_t i = 0; i < here; ++i) echoes.azimuth_rad[to + i] = azimuth_rad[ray[from + i] - from];
      if (echoes.weight.empty()) continue;
      fan.RowWeights(row, weight.data());
      for (std::size_t i = 0; i < here; ++i) echoes.weight[to + i] = weight[ray[from + i] - from];
    }
  });
  return GatherEchoes(echoes, axes);
}

}  // namespace sonarcal::sim
