#include "sim/gathered/paper_echoes.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "sim/paper/expected_paper_image.h"
#include "sim/paper/paper_blur.h"

namespace sonarcal::sim {
namespace {

// Values by incidence node and beam: for each node that occurs, `values` lines of beams one after the other.
// The last node stands for the loss.
class BeamLines {
 public:
  BeamLines(std::size_t nodes, int beams, int values)
      : beams_(beams),
        values_(values),
        line_(static_cast<std::size_t>(beams) * static_cast<std::size_t>(values)),
        slot_(nodes, -1) {}

  // Lines of a node, which hold data in the beams [first, last) from now on. Valid until the next call.
  float* Line(std::uint32_t node, int first, int last) {
    int& slot = slot_[node];
    if (slot < 0) {
      slot = static_cast<int>(nodes_.size());
      nodes_.push_back(node);
      reach_.emplace_back(first, last);
      data_.resize(std::max(data_.size(), nodes_.size() * line_), 0.0F);
    }
    auto& [low, high] = reach_[slot];
    low = std::min(low, first);
    high = std::max(high, last);
    return &data_[static_cast<std::size_t>(slot) * line_];
  }

  struct View {
    std::uint32_t node;
    int first;
    int last;
    const float* line;
  };
  std::size_t size() const { return nodes_.size(); }
  View operator[](std::size_t slot) const {
    return {nodes_[slot], reach_[slot].first, reach_[slot].second, &data_[slot * line_]};
  }

  void Clear() {
    for (std::size_t slot = 0; slot < nodes_.size(); ++slot) {
      const auto line = data_.begin() + static_cast<std::ptrdiff_t>(slot * line_);
      const auto [low, high] = reach_[slot];
      for (int value = 0; value < values_; ++value)
        std::fill(line + value * beams_ + low, line + value * beams_ + high, 0.0F);
      slot_[nodes_[slot]] = -1;
    }
    nodes_.clear();
    reach_.clear();
  }

 private:
  int beams_;
  int values_;             // lines per node
  std::size_t line_;       // numbers per node
  std::vector<int> slot_;  // per node, -1 if it does not occur
  std::vector<std::uint32_t> nodes_;
  std::vector<std::pair<int, int>> reach_;
  std::vector<float> data_;  // 0 outside of the reach
};

// A row after the blur in azimuth: per node the weight of each beam, and then the weight times its offset in
// range. Holds only the beams that a node reaches.
constexpr int kRowValues = 2;

struct Row {
  struct Line {
    std::uint32_t node = 0;
    int first = 0;  // beams [first, last)
    int last = 0;
    std::size_t start = 0;  // of its values
  };
  std::vector<Line> lines;
  std::vector<float> values;

  Row() = default;
  Row(const BeamLines& from, int beams) {
    for (std::size_t slot = 0; slot < from.size(); ++slot) {
      const BeamLines::View view = from[slot];
      lines.push_back({view.node, view.first, view.last, values.size()});
      for (const float* line = view.line; line != view.line + kRowValues * beams; line += beams)
        values.insert(values.end(), line + view.first, line + view.last);
    }
    values.shrink_to_fit();
  }
};

class Gatherer {
 public:
  Gatherer(const EchoHistogram& histogram, const ImageGeometry& geometry,
           const internal::RowErrors<double>& errors)
      : histogram_(histogram),
        geometry_(geometry),
        blur_(histogram, geometry, errors.sigma_range_m, errors.sigma_azimuth_rad),
        loss_node_(static_cast<std::uint32_t>(histogram.materials * CoarseIncidenceDeg().size())) {}

  PaperEchoes Run() {
    SpreadRows();
    const int bins = geometry_.axes.range_bins;
    std::vector<BinEchoes> of_bin(bins);
    LinesOfThreads lines_of_threads(BeamLines(loss_node_ + 1, histogram_.beams, 1));
    tbb::parallel_for(tbb::blocked_range<int>(0, bins, 8), [&](const tbb::blocked_range<int>& range) {
      BeamLines& lines = lines_of_threads.local();
      for (int bin = range.begin(); bin != range.end(); ++bin) {
        AddRows(bin, lines);
        of_bin[bin] = Entries(lines);
        lines.Clear();
      }
    });
    PaperEchoes echoes{.nodes = {.materials = histogram_.materials, .start = {0}, .entries = {}},
                       .loss_db = {}};
    for (const BinEchoes& bin : of_bin) {
      for (const std::uint32_t count : bin.count)
        echoes.nodes.start.push_back(echoes.nodes.start.back() + count);
      echoes.nodes.entries.insert(echoes.nodes.entries.end(), bin.entries.begin(), bin.entries.end());
      echoes.loss_db.insert(echoes.loss_db.end(), bin.loss_db.begin(), bin.loss_db.end());
    }
    return echoes;
  }

 private:
  using LinesOfThreads = tbb::enumerable_thread_specific<BeamLines>;

  struct BinEchoes {
    std::vector<PixelEchoes::Entry> entries;
    std::vector<std::uint32_t> count;  // per beam
    std::vector<float> loss_db;
  };

  void SpreadRows() {
    rows_.resize(blur_.row_count());
    LinesOfThreads lines_of_threads(BeamLines(loss_node_ + 1, histogram_.beams, kRowValues));
    tbb::parallel_for(tbb::blocked_range<int>(0, blur_.row_count(), 8), [&](const auto& range) {
      BeamLines& lines = lines_of_threads.local();
      for (int row = range.begin(); row != range.end(); ++row) {
        SpreadRow(row, lines);
        rows_[row] = Row(lines, histogram_.beams);
        lines.Clear();
      }
    });
  }

  void SpreadRow(int row, BeamLines& lines) const {
    const auto [first_cell, last_cell] = blur_.CellsOfRow(row);
    const auto coarse_nodes = static_cast<std::uint32_t>(CoarseIncidenceDeg().size());
    const std::array<NodeShare, kIncidenceNodes>& shares = CoarseShares();
    PaperBlur::BeamWeights beams;
    for (std::uint32_t number = first_cell; number < last_cell; ++number) {
      const EchoHistogram::Cell& cell = histogram_.cells[number];
      blur_.WeighBeams(cell, beams);
      const auto range_offset = static_cast<float>(blur_.RangeOffset(cell));
      const auto add = [&](std::uint32_t node, double value) {
        const auto count = static_cast<int>(beams.weight.size());
        float* weight = lines.Line(node, beams.first, beams.first + count) + beams.first;
        float* moment = weight + histogram_.beams;
        const auto of_node = static_cast<float>(value);
        for (int i = 0; i < count; ++i) {
          const float at = beams.weight[i] * of_node;
          weight[i] += at;
          moment[i] += range_offset * at;
        }
      };
      for (std::uint32_t e = cell.first_entry; e < cell.last_entry; ++e) {
        const auto [fine, weight] = histogram_.entries[e];
        const NodeShare& share = shares[fine % kIncidenceNodes];
        const std::uint32_t node = fine / kIncidenceNodes * coarse_nodes + share.node;
        if (share.of_next < 1.0) add(node, weight * (1.0 - share.of_next));
        if (share.of_next > 0.0) add(node + 1, weight * share.of_next);
      }
      add(loss_node_, cell.log_range + geometry_.absorption_db_per_m * cell.two_way_range_m);
    }
  }

  void AddRows(int bin, BeamLines& lines) const {
    for (const PaperBlur::RangeWeight& of_row : blur_.RowsOfBin(bin)) {
      const auto weight = static_cast<float>(of_row.weight.value);
      const auto moment = static_cast<float>(of_row.moment.value);
      const Row& row = rows_[of_row.row];
      for (const Row::Line& from : row.lines) {
        float* to = lines.Line(from.node, from.first, from.last);
        const int count = from.last - from.first;
        const float* values = &row.values[from.start];
        const float* moments = values + count;
        for (int i = 0; i < count; ++i) to[from.first + i] += weight * values[i] + moment * moments[i];
      }
    }
  }

  BinEchoes Entries(const BeamLines& lines) const {
    std::vector<BeamLines::View> views;
    for (std::size_t slot = 0; slot < lines.size(); ++slot) views.push_back(lines[slot]);
    std::ranges::sort(views, {}, &BeamLines::View::node);
    BinEchoes bin{.entries = {},
                  .count = std::vector<std::uint32_t>(histogram_.beams, 0),
                  .loss_db = std::vector<float>(histogram_.beams, 0.0F)};
    if (views.empty()) return bin;
    const BeamLines::View loss = views.back();
    views.pop_back();
    std::copy(loss.line + loss.first, loss.line + loss.last, bin.loss_db.begin() + loss.first);
    std::vector<float> least(histogram_.beams, 0.0F);
    for (const BeamLines::View& view : views) {
      for (int beam = view.first; beam < view.last; ++beam)
        least[beam] += static_cast<float>(kNegligibleShare) * view.line[beam];
    }
    for (int beam = loss.first; beam < loss.last; ++beam) {
      const std::size_t before = bin.entries.size();
      for (const BeamLines::View& view : views) {
        if (beam >= view.first && beam < view.last && view.line[beam] > least[beam])
          bin.entries.push_back({view.node, view.line[beam]});
      }
      bin.count[beam] = static_cast<std::uint32_t>(bin.entries.size() - before);
    }
    return bin;
  }

  const EchoHistogram& histogram_;
  const ImageGeometry& geometry_;
  PaperBlur blur_;
  std::uint32_t loss_node_;
  std::vector<Row> rows_;
};

}  // namespace

PaperEchoes GatherPaperEchoes(const EchoHistogram& histogram, const ImageGeometry& geometry,
                              const JitterParameters<double>& errors) {
  return Gatherer(histogram, geometry, internal::ErrorsOfRows(histogram, geometry, errors)).Run();
}

double PaperIncidenceDeg(std::size_t node) {
  const std::vector<double>& nodes_deg = CoarseIncidenceDeg();
  if (node + 1 < nodes_deg.size()) return nodes_deg[node];
  return GrazingEndDeg(nodes_deg[node - 1]);
}

}  // namespace sonarcal::sim
