#include "sim/gathered/pixel_echoes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/types/error.h"
#include "sim/acoustic/acoustic_frame.h"
#include "sim/gathered/cast_echo_power.h"
#include "sim/rays/row_math/sums.h"

namespace sonarcal::sim {
namespace {

// Powers of each cell by coarse node. Several bins receive a cell, so its nodes are merged once.
struct CoarseCells {
  std::vector<std::uint32_t> start;  // first entry of each cell; cells + 1 values
  std::vector<EchoPower::Entry> entries;
};

CoarseCells MergeNodes(const EchoPower& echoes) {
  SONARCAL_CHECK(echoes.nodes == kIncidenceNodes, "{} nodes", echoes.nodes);
  const std::array<NodeShare, kIncidenceNodes>& shares = CoarseShares();
  const auto coarse_count = static_cast<std::uint32_t>(CoarseIncidenceDeg().size());
  CoarseCells merged;
  merged.start.reserve(echoes.cells.size() + 1);
  merged.entries.reserve(echoes.entries.size());
  for (const EchoPower::Cell& cell : echoes.cells) {
    const auto first = static_cast<std::uint32_t>(merged.entries.size());
    merged.start.push_back(first);
    // The nodes of a cell are sorted, so a coarse node is among the last two.
    const auto add = [&](std::uint32_t node, double power) {
      for (std::size_t i = merged.entries.size(); i > first && merged.entries[i - 1].node >= node; --i) {
        if (merged.entries[i - 1].node != node) continue;
        merged.entries[i - 1].power += static_cast<float>(power);
        return;
      }
      merged.entries.push_back({node, static_cast<float>(power)});
    };
    for (std::uint32_t e = cell.first_entry; e < cell.last_entry; ++e) {
      const std::uint32_t fine = echoes.entries[e].node;
      const NodeShare& share = shares[fine % kIncidenceNodes];
      const std::uint32_t node = fine / kIncidenceNodes * coarse_count + share.node;
      const double power = echoes.entries[e].power;
      if (share.of_next < 1.0) add(node, power * (1.0 - share.of_next));
      if (share.of_next > 0.0) add(node + 1, power * share.of_next);
    }
  }
  merged.start.push_back(static_cast<std::uint32_t>(merged.entries.size()));
  return merged;
}

// Range bins that are gathered together, because neighbours receive almost the same cells.
constexpr int kBlock = row_math::kWideSum;
using BlockPowers = std::array<float, kBlock>;  // one value per bin

// Weights of two neighbouring beams for the same columns.
struct BeamPair {
  int first_col = 0;
  std::vector<float> weight[2];

  BeamPair(const ResponseWindow& one, const ResponseWindow& other)
      : first_col(std::min(one.first, other.first)) {
    const auto end = [](const ResponseWindow& window) {
      return static_cast<std::size_t>(window.first) + window.weight.size();
    };
    const std::size_t cols = std::max(end(one), end(other)) - first_col;
    for (const auto& [window, to] : {std::pair(&one, &weight[0]), std::pair(&other, &weight[1])}) {
      to->resize(cols);
      std::transform(window->weight.begin(), window->weight.end(), to->begin() + (window->first - first_col),
                     [](double value) { return static_cast<float>(value); });
    }
  }
  int cols() const { return static_cast<int>(weight[0].size()); }
};

std::vector<BeamPair> PairsOf(const PowerResponse& response) {
  std::vector<BeamPair> pairs;
  for (int beam = 0; beam < response.beams(); beam += 2)
    pairs.emplace_back(response.azimuth(beam), response.azimuth(std::min(beam + 1, response.beams() - 1)));
  return pairs;
}

// Powers of a block of bins by incidence node and column of the ray fan: one line of columns per node that
// occurs. Reused from block to block.
class NodeLines {
 public:
  NodeLines(std::size_t nodes, int columns) : columns_(columns), slot_(nodes, -1) {}

  void Clear() {
    for (std::size_t slot = 0; slot < nodes_.size(); ++slot) {
      slot_[nodes_[slot]] = -1;
      const auto line = power_.begin() + static_cast<std::ptrdiff_t>(slot * columns_);
      std::fill(line + reach_[slot].first, line + reach_[slot].second + 1, BlockPowers{});
    }
    nodes_.clear();
    reach_.clear();
  }
  void Add(std::uint32_t node, int column, float power, const BlockPowers& pulse) {
    int& slot = slot_[node];
    if (slot < 0) {
      slot = static_cast<int>(nodes_.size());
      nodes_.push_back(node);
      reach_.emplace_back(column, column);
      if (power_.size() < nodes_.size() * columns_) power_.resize(nodes_.size() * columns_);
    }
    BlockPowers& at = power_[static_cast<std::size_t>(slot) * columns_ + column];
    for (int k = 0; k < kBlock; ++k) at[k] += power * pulse[k];
    reach_[slot].first = std::min(reach_[slot].first, column);
    reach_[slot].second = std::max(reach_[slot].second, column);
  }
  // Nodes that occur, sorted.
  std::vector<std::uint32_t> Sorted() const {
    std::vector<std::uint32_t> sorted = nodes_;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
  // Powers of a node in two beams.
  std::array<BlockPowers, 2> Through(const BeamPair& pair, std::uint32_t node) const {
    std::array<BlockPowers, 2> sums{};
    const auto [first_column, last_column] = reach_[slot_[node]];
    const int first = std::max(first_column, pair.first_col);
    const int last = std::min(last_column, pair.first_col + pair.cols() - 1);
    if (last < first) return sums;
    const BlockPowers* line = &power_[static_cast<std::size_t>(slot_[node]) * columns_ + first];
    const int from = first - pair.first_col;
    const float* const weights[] = {pair.weight[0].data() + from, pair.weight[1].data() + from};
    row_math::WideSums(weights, line->data(), last - first + 1, sums[0].data());
    return sums;
  }

 private:
  std::size_t columns_;
  std::vector<int> slot_;  // per node, -1 if it does not occur
  std::vector<std::uint32_t> nodes_;
  std::vector<BlockPowers> power_;          // 0 outside of the reach
  std::vector<std::pair<int, int>> reach_;  // first and last column with data, per line
};

// Weights of a row for the bins of a block; 0 for bins that do not receive it or do not exist.
BlockPowers PulseWeights(const PowerResponse& response, int first_bin, int row) {
  BlockPowers weights{};
  for (int k = 0; k < kBlock && first_bin + k < response.bins(); ++k) {
    const auto [first_row, last_row] = response.RowsOfBin(first_bin + k);
    if (row >= first_row && row < last_row)
      weights[k] = static_cast<float>(response.PulseWeight(first_bin + k, row));
  }
  return weights;
}

// Entries of a block of bins: per bin, beam by beam.
struct BlockEntries {
  std::array<std::vector<PixelEchoes::Entry>, kBlock> entries;
  std::vector<std::uint32_t> count;  // per bin and beam
};

// Sends the nodes of a block of bins through the beams. Omits entries below `negligible_share` of their
// pixel.
BlockEntries ThroughBeams(const NodeLines& lines, const std::vector<BeamPair>& pairs, int bins, int beams,
                          double negligible_share) {
  BlockEntries block;
  block.count.assign(static_cast<std::size_t>(bins) * beams, 0);
  const std::vector<std::uint32_t> present = lines.Sorted();
  std::vector<std::array<BlockPowers, 2>> powers(present.size());
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    std::array<BlockPowers, 2> total{};
    for (std::size_t i = 0; i < present.size(); ++i) {
      powers[i] = lines.Through(pairs[pair], present[i]);
      for (int of = 0; of < 2; ++of) {
        for (int k = 0; k < kBlock; ++k) total[of][k] += powers[i][of][k];
      }
    }
    for (int of = 0; of < 2; ++of) {
      const int beam = 2 * static_cast<int>(pair) + of;
      if (beam >= beams) break;
      for (int bin = 0; bin < bins; ++bin) {
        const float least = static_cast<float>(negligible_share) * total[of][bin];
        std::vector<PixelEchoes::Entry>& entries = block.entries[bin];
        const std::size_t before = entries.size();
        for (std::size_t i = 0; i < present.size(); ++i) {
          const float power = powers[i][of][bin];
          if (power > least) entries.push_back({present[i], power});
        }
        block.count[static_cast<std::size_t>(bin) * beams + beam] =
            static_cast<std::uint32_t>(entries.size() - before);
      }
    }
  }
  return block;
}

// Joins blocks of bins.
PixelEchoes Joined(const std::vector<BlockEntries>& blocks, int materials) {
  PixelEchoes gathered{.materials = materials, .start = {0}, .entries = {}};
  std::size_t total = 0;
  std::vector<std::size_t> first;
  for (const BlockEntries& block : blocks) {
    first.push_back(total);
    for (const std::uint32_t count : block.count) {
      total += count;
      gathered.start.push_back(static_cast<std::uint32_t>(total));
    }
  }
  gathered.entries.resize(total);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    auto to = gathered.entries.begin() + static_cast<std::ptrdiff_t>(first[block]);
    for (const auto& of_bin : blocks[block].entries) to = std::copy(of_bin.begin(), of_bin.end(), to);
  });
  return gathered;
}

}  // namespace

const std::vector<double>& CoarseIncidenceDeg() {
  static const std::vector<double> kNodes = [] {
    std::vector<double> nodes;
    for (double deg = 0.0; deg < 20.0; deg += 0.5) nodes.push_back(deg);
    for (double deg = 20.0; deg < 40.0; deg += 1.0) nodes.push_back(deg);
    for (double deg = 40.0; deg <= 90.0; deg += 2.0) nodes.push_back(deg);
    return nodes;
  }();
  return kNodes;
}

const std::array<NodeShare, kIncidenceNodes>& CoarseShares() {
  static const std::array<NodeShare, kIncidenceNodes> kShares = [] {
    const std::vector<double>& coarse = CoarseIncidenceDeg();
    std::array<NodeShare, kIncidenceNodes> shares;
    for (int fine = 0; fine < kIncidenceNodes; ++fine) {
      const double deg = fine * kIncidenceStepDeg;
      const auto above = std::upper_bound(coarse.begin(), coarse.end() - 1, deg);
      const int node = static_cast<int>(above - coarse.begin()) - 1;
      shares[fine] = {node, (deg - coarse[node]) / (coarse[node + 1] - coarse[node])};
    }
    return shares;
  }();
  return kShares;
}

PixelEchoes GatherPixelEchoes(const EchoPower& echoes, const PowerResponse& response,
                              double negligible_share) {
  const std::size_t nodes = CoarseIncidenceDeg().size();
  const bool coarse = echoes.nodes == static_cast<int>(nodes);
  const CoarseCells merged = coarse ? CoarseCells{} : MergeNodes(echoes);
  const EchoPower::Entry* entries = coarse ? echoes.entries.data() : merged.entries.data();
  const int bins = response.bins();
  const std::vector<std::size_t> row_start = RowStarts(echoes);
  const std::vector<BeamPair> pairs = PairsOf(response);

  const int blocks = (bins + kBlock - 1) / kBlock;
  std::vector<BlockEntries> of_block(blocks);
  tbb::parallel_for(tbb::blocked_range<int>(0, blocks), [&](const tbb::blocked_range<int>& range) {
    NodeLines lines(echoes.materials * nodes, echoes.cols);
    for (int block = range.begin(); block != range.end(); ++block) {
      const int first_bin = block * kBlock;
      const int last_bin = std::min(first_bin + kBlock, bins) - 1;
      lines.Clear();
      const int last_row = response.RowsOfBin(last_bin).second;
      for (int row = response.RowsOfBin(first_bin).first; row < last_row; ++row) {
        const BlockPowers pulse = PulseWeights(response, first_bin, row);
        for (std::size_t i = row_start[row]; i < row_start[row + 1]; ++i) {
          const EchoPower::Cell& cell = echoes.cells[i];
          const std::uint32_t first = coarse ? cell.first_entry : merged.start[i];
          const std::uint32_t end = coarse ? cell.last_entry : merged.start[i + 1];
          for (std::uint32_t e = first; e < end; ++e)
            lines.Add(entries[e].node, cell.col, entries[e].power, pulse);
        }
      }
      of_block[block] =
          ThroughBeams(lines, pairs, last_bin - first_bin + 1, response.beams(), negligible_share);
    }
  });
  return Joined(of_block, echoes.materials);
}

EchoPower EchoesOfPose(const Simulator& simulator, const Pose& world_from_sonar,
                       const ParameterSet& parameters) {
  const AcousticGeometry geometry{simulator.sonar(), simulator.absorption_db_per_m()};
  if (CastsInOnePass(simulator.fan(), simulator.options().trace))
    return CastEchoPower(simulator.caster(), simulator.fan(), world_from_sonar, geometry, parameters);
  return GatherEchoPower(simulator.TraceEchoes(world_from_sonar), simulator.fan(), geometry, parameters);
}

PixelEchoes ThroughBeamAndPulse(const Simulator& simulator, const EchoPower& echoes,
                                const ParameterSet& parameters) {
  std::vector<ResponseWindow> azimuth =
      AzimuthWindows(simulator.sonar(), parameters, echoes.column_azimuth_rad, ResponseOf::kPower);
  if (echoes.columns_together > 1) azimuth = SharpenedForShares(std::move(azimuth), echoes.columns_together);
  return GatherPixelEchoes(
      echoes, {simulator.sonar().axes.range_bins, echoes.range_steps, std::move(azimuth),
               PulseWindow(simulator.sonar(), parameters, echoes.range_steps, ResponseOf::kPower)});
}

PixelEchoes GatherPixelEchoes(const Simulator& simulator, const Pose& world_from_sonar,
                              const ParameterSet& parameters) {
  return ThroughBeamAndPulse(simulator, EchoesOfPose(simulator, world_from_sonar, parameters), parameters);
}

PixelEchoes Difference(const PixelEchoes& above, const PixelEchoes& below, double scale) {
  SONARCAL_CHECK(above.start.size() == below.start.size() && above.materials == below.materials,
                 "echoes of {} and {} pixels", above.start.size() - 1, below.start.size() - 1);
  PixelEchoes difference{.materials = above.materials, .start = {0}, .entries = {}};
  difference.start.reserve(above.start.size());
  for (std::size_t pixel = 0; pixel + 1 < above.start.size(); ++pixel) {
    std::uint32_t a = above.start[pixel];
    std::uint32_t b = below.start[pixel];
    while (a < above.start[pixel + 1] || b < below.start[pixel + 1]) {
      const std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
      const std::uint32_t node_a = a < above.start[pixel + 1] ? above.entries[a].node : none;
      const std::uint32_t node_b = b < below.start[pixel + 1] ? below.entries[b].node : none;
      const std::uint32_t node = std::min(node_a, node_b);
      double weight = 0.0;
      if (node_a == node) weight += above.entries[a++].weight;
      if (node_b == node) weight -= below.entries[b++].weight;
      difference.entries.push_back({node, static_cast<float>(scale * weight)});
    }
    difference.start.push_back(static_cast<std::uint32_t>(difference.entries.size()));
  }
  difference.entries.shrink_to_fit();
  return difference;
}

}  // namespace sonarcal::sim
