#include "calib/paper/coarse_paper.h"

#include <algorithm>
#include <cstdint>

namespace sonarcal::calib {
namespace {

struct Block {
  int bins = 1;
  int beams = 1;
};

int LargestDivisor(int number, int most) {
  int divisor = std::max(1, most);
  while (number % divisor != 0) --divisor;
  return divisor;
}

// Sums the cells of the fine histogram within one cell of the coarse one. A pixel of the coarse image is the
// mean over its block, so each weight counts for one pixel of the block.
class CellSum {
 public:
  void Add(const sim::EchoHistogram& fine, const sim::EchoHistogram::Cell& cell, double weight_factor,
           double range_position, double azimuth_position) {
    node_weight_.resize(static_cast<std::size_t>(fine.materials) * sim::kIncidenceNodes, 0.0);
    const double weight = weight_factor * cell.weight;
    weight_ += weight;
    log_range_ += weight_factor * cell.log_range;
    two_way_range_m_ += weight_factor * cell.two_way_range_m;
    range_ += weight * range_position;
    azimuth_ += weight * azimuth_position;
    for (std::uint32_t entry = cell.first_entry; entry < cell.last_entry; ++entry) {
      const auto [node, of_node] = fine.entries[entry];
      if (node_weight_[node] == 0.0) nodes_.push_back(node);
      node_weight_[node] += weight_factor * of_node;
    }
  }

  // Appends the cell, if it holds any echo, and begins anew.
  void Flush(int row, int col, sim::EchoHistogram& coarse) {
    if (nodes_.empty()) return;
    sim::EchoHistogram::Cell cell{.row = row,
                                  .col = col,
                                  .weight = weight_,
                                  .log_range = log_range_,
                                  .two_way_range_m = two_way_range_m_,
                                  .range_offset = Offset(range_ / weight_ - row),
                                  .azimuth_offset = Offset(azimuth_ / weight_ - col),
                                  .first_entry = static_cast<std::uint32_t>(coarse.entries.size())};
    std::ranges::sort(nodes_);
    for (const std::uint32_t node : nodes_) {
      coarse.entries.push_back({node, static_cast<float>(node_weight_[node])});
      node_weight_[node] = 0.0;
    }
    cell.last_entry = static_cast<std::uint32_t>(coarse.entries.size());
    coarse.cells.push_back(cell);
    nodes_.clear();
    weight_ = log_range_ = two_way_range_m_ = range_ = azimuth_ = 0.0;
  }

 private:
  static float Offset(double within) { return static_cast<float>(std::clamp(within - 0.5, -0.5, 0.5)); }

  double weight_ = 0.0;
  double log_range_ = 0.0;
  double two_way_range_m_ = 0.0;
  double range_ = 0.0;
  double azimuth_ = 0.0;
  std::vector<double> node_weight_;
  std::vector<std::uint32_t> nodes_;  // of weight
};

sim::EchoHistogram MakeCoarse(const sim::EchoHistogram& fine, Block block) {
  sim::EchoHistogram coarse;
  coarse.rows = fine.rows / block.bins;
  coarse.beams = fine.beams / block.beams;
  coarse.materials = fine.materials;
  const double weight_factor = 1.0 / (block.bins * block.beams);
  std::vector<CellSum> sums(coarse.beams);
  for (int row = 0; row < coarse.rows; ++row) {
    coarse.row_start.push_back(static_cast<std::uint32_t>(coarse.cells.size()));
    for (std::uint32_t i = fine.row_start[row * block.bins]; i < fine.row_start[(row + 1) * block.bins];
         ++i) {
      const sim::EchoHistogram::Cell& cell = fine.cells[i];
      sums[cell.col / block.beams].Add(fine, cell, weight_factor,
                                       (cell.row + 0.5 + cell.range_offset) / block.bins,
                                       (cell.col + 0.5 + cell.azimuth_offset) / block.beams);
    }
    for (int col = 0; col < coarse.beams; ++col) sums[col].Flush(row, col, coarse);
  }
  coarse.row_start.push_back(static_cast<std::uint32_t>(coarse.cells.size()));
  return coarse;
}

FitFrame MakeCoarse(const FitFrame& fine, int fine_beams, Block block) {
  FitFrame coarse{.index = fine.index, .echoes = MakeCoarse(fine.echoes, block), .measured = {}};
  const auto beams = static_cast<std::size_t>(fine_beams / block.beams);
  coarse.measured.assign(fine.measured.size() / (block.bins * block.beams), 0.0);
  if (!fine.use.empty()) coarse.use.assign(coarse.measured.size(), 1);
  for (std::size_t i = 0; i < fine.measured.size(); ++i) {
    const std::size_t bin = i / fine_beams / block.bins;
    const std::size_t pixel = bin * beams + i % fine_beams / block.beams;
    coarse.measured[pixel] += fine.measured[i] / (block.bins * block.beams);
    if (!fine.use.empty() && fine.use[i] == 0) coarse.use[pixel] = 0;
  }
  return coarse;
}

}  // namespace

CoarsePaperFrames MakeCoarse(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                             int most) {
  const int fine_beams = geometry.axes.beam_count();
  const Block block{.bins = LargestDivisor(geometry.axes.range_bins, most),
                    .beams = LargestDivisor(fine_beams, most)};
  CoarsePaperFrames coarse{.geometry = geometry, .frames = {}};
  coarse.geometry.axes.range_bins /= block.bins;
  coarse.geometry.axes.beam_azimuth_rad.clear();
  coarse.geometry.beam_edges_rad.clear();
  for (int beam = 0; beam < fine_beams; beam += block.beams) {
    const double low = geometry.beam_edges_rad[beam];
    const double high = geometry.beam_edges_rad[beam + block.beams];
    coarse.geometry.axes.beam_azimuth_rad.push_back(0.5 * (low + high));
    coarse.geometry.beam_edges_rad.push_back(low);
  }
  coarse.geometry.beam_edges_rad.push_back(geometry.beam_edges_rad.back());
  for (const FitFrame& frame : frames) coarse.frames.push_back(MakeCoarse(frame, fine_beams, block));
  return coarse;
}

}  // namespace sonarcal::calib
