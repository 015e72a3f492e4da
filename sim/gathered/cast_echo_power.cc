#include "sim/gathered/cast_echo_power.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/acoustic/patch_shader.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/fine_rows.h"
#include "sim/physics/patch.h"
#include "sim/rays/row_math/echoes.h"

namespace sonarcal::sim {
namespace {

constexpr int kPositionSteps = 4096;  // a fortieth of the smallest interval between nodes

// Powers of the eight corners of a cell between two rows, two columns and two nodes: index 4 row + 2 column +
// node, each 0 or 1.
using Corners = float __attribute__((vector_size(8 * sizeof(float))));

// Position of an incidence among the coarse nodes.
double NodePosition(double incidence_deg) {
  const std::vector<double>& nodes = CoarseIncidenceDeg();
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, incidence_deg);
  const auto node = above - nodes.begin() - 1;
  return static_cast<double>(node) + (incidence_deg - nodes[node]) / (*above - nodes[node]);
}

// NodePosition over tan(incidence / 2).
std::vector<float> NodePositions() {
  std::vector<float> positions(kPositionSteps + 2);
  for (int i = 0; i < kPositionSteps + 2; ++i) {
    const double half_tangent = std::min(1.0, static_cast<double>(i) / kPositionSteps);
    positions[i] = static_cast<float>(NodePosition(DegFromRad(2.0 * std::atan(half_tangent))));
  }
  return positions;
}

// Parameters whose patches all scatter with unit strength at a level of 0 dB.
ParameterSet WithUnitCurves(const ParameterSet& parameters, const std::vector<std::string>& material_names) {
  ParameterSet unit = parameters;
  unit.source_level_db = 0.0;
  unit.receiver.gain_db = 0.0;
  for (const std::string& name : material_names)
    unit.materials[name].gsab = {.a = 0.0, .b_deg = 90.0, .c = 1.0, .d = 0.0, .e = 0.0, .f_deg = 90.0};
  return unit;
}

// Joined columns of a fan: those at every `together`-th column, and one past the last.
struct JoinedColumns {
  JoinedColumns(const std::vector<double>& fine_rad, int together) {
    const int last = static_cast<int>(fine_rad.size()) - 1;
    for (int col = 0; col <= last; col += together) azimuth_rad.push_back(fine_rad[col]);
    if (together > 1 && last % together != 0) {
      const auto end = azimuth_rad.size() - 1;
      azimuth_rad.push_back(end > 0 ? 2.0 * azimuth_rad[end] - azimuth_rad[end - 1] : fine_rad[last]);
    }
    for (int col = 0; col <= last; ++col) {
      const int left = col / together;
      first.push_back(left);
      const double part = col % together == 0 ? 0.0
                                              : (fine_rad[col] - azimuth_rad[left]) /
                                                    (azimuth_rad[left + 1] - azimuth_rad[left]);
      of_next.push_back(static_cast<float>(part));
    }
  }

  std::vector<double> azimuth_rad;
  std::vector<int> first;      // per fine column: joined column to its left
  std::vector<float> of_next;  // share of the next one
};

// Data shared by all blocks.
struct Gathering {
  const RayFan& fan;
  const PatchShader& shader;
  const JoinedColumns& columns;
  row_math::RangeRows range_rows;
  int rows;
  int materials;
  float max_tangent;
  std::vector<float> node_positions;
};

// Cells and entries of a block of columns. `first_entry` counts from the block's own first.
struct BlockEchoes {
  std::vector<EchoPower::Cell> cells;  // by row, then column
  std::vector<EchoPower::Entry> entries;
};

// Sums the echoes of a block of columns. Reused from block to block.
class BlockGatherer {
 public:
  explicit BlockGatherer(const Gathering& shared)
      : shared_(shared),
        nodes_(static_cast<int>(CoarseIncidenceDeg().size())),
        words_(shared.materials * nodes_ / 64 + 1),
        newest_(static_cast<std::size_t>(shared.rows + 1) * RayCaster::kBlockCols, kNone),
        sums_(static_cast<std::size_t>(RayCaster::kBlockCols + 1) * shared.materials * nodes_, 0.0F),
        present_(static_cast<std::size_t>(RayCaster::kBlockCols + 1) * words_, 0) {}

  BlockEchoes Gather(const RayCaster::ColumnBlock& block) {
    first_joined_ = shared_.columns.first[block.first_col];
    joined_ = shared_.columns.first[block.first_col + block.cols - 1] - first_joined_ + 1;
    slots_.clear();
    std::fill(newest_.begin(), newest_.end(), kNone);
    block.cast([this](const RowHits& hits) { Add(hits); });
    BlockEchoes echoes;
    echoes.cells.reserve(slots_.size());
    echoes.entries.reserve(3 * slots_.size());
    for (int row = 0; row < shared_.rows; ++row) {
      AddHalf(row, 1);
      AddHalf(row + 1, 0);
      Emit(row, echoes);
    }
    return echoes;
  }

 private:
  static constexpr std::int32_t kNone = -1;

  // Echoes between two rows, columns and nodes; `older` chains the slots of one pair of rows and columns.
  struct Slot {
    Corners power;
    std::int32_t node;
    std::int32_t older;
  };

  void Add(const RowHits& hits) {
    if (hits.count == 0) return;
    shared_.shader.Shade(hits, shaded_);
    row_math::EchoParts(shared_.range_rows, static_cast<float>(shared_.fan.SpreadHeightRad(hits.row, 0)),
                        shared_.max_tangent, hits.range_m, hits.half_tangent, hits.count, parts_.data(),
                        position_.data(), step_.data());
    row_math::Lookup({shared_.node_positions.data(), kPositionSteps}, hits.half_tangent, hits.count,
                     node_position_.data());
    const float end = static_cast<float>(shared_.rows) - 0.5F;
    for (int i = 0; i < hits.count; ++i) {
      if (parts_[i] == 0.0F) continue;
      const int node = std::min(static_cast<int>(node_position_[i]), nodes_ - 2);
      const float of_node = node_position_[i] - static_cast<float>(node);
      const float of_col = shared_.columns.of_next[hits.col[i]];
      const float power = shaded_.power[i] / parts_[i];
      const float left = (1.0F - of_col) * power;
      const float right = of_col * power;
      const std::array<float, 4> by_col_and_node = {left - left * of_node, left * of_node,
                                                    right - right * of_node, right * of_node};
      const int col = shared_.columns.first[hits.col[i]] - first_joined_;
      const int key = hits.material[i] * nodes_ + node;
      const int parts = static_cast<int>(parts_[i]);
      for (int part = 0; part < parts; ++part) {
        float at = position_[i] + static_cast<float>(part) * step_[i];
        if (at < -0.5F) at = -1.0F - at;
        if (at > end) at = 2.0F * end - at;
        if (at > -1.0F && at <= end) AddAt(at, col, key, by_col_and_node);
      }
    }
  }

  void AddAt(float at, int col, int key, const std::array<float, 4>& by_col_and_node) {
    const float above = at + 1.0F;
    const int row = static_cast<int>(above);  // one past the row below
    const float further = above - static_cast<float>(row);
    const float nearer = 1.0F - further;
    const std::array<float, 4>& p = by_col_and_node;
    SlotOf(row * RayCaster::kBlockCols + col, key).power +=
        Corners{nearer * p[0],  nearer * p[1],  nearer * p[2],  nearer * p[3],
                further * p[0], further * p[1], further * p[2], further * p[3]};
  }

  Slot& SlotOf(int place, int key) {
    for (std::int32_t slot = newest_[place]; slot != kNone; slot = slots_[slot].older) {
      if (slots_[slot].node == key) return slots_[slot];
    }
    slots_.push_back(Slot{.power = {}, .node = key, .older = newest_[place]});
    newest_[place] = static_cast<std::int32_t>(slots_.size()) - 1;
    return slots_.back();
  }

  // Adds the nearer (0) or further (1) half of the slots above a row to the sums by column and node.
  void AddHalf(int interval, int half) {
    for (int col = 0; col < joined_; ++col) {
      std::int32_t at = newest_[interval * RayCaster::kBlockCols + col];
      if (at == kNone) continue;
      heard_ |= std::uint64_t{3} << col;
      for (; at != kNone; at = slots_[at].older) {
        const Slot& slot = slots_[at];
        for (int beside = 0; beside < 2; ++beside) {
          float* sums =
              &sums_[static_cast<std::size_t>(col + beside) * shared_.materials * nodes_ + slot.node];
          sums[0] += slot.power[4 * half + 2 * beside];
          sums[1] += slot.power[4 * half + 2 * beside + 1];
          std::uint64_t* present =
              &present_[static_cast<std::size_t>(col + beside) * words_ + slot.node / 64];
          present[0] |= std::uint64_t{3} << (slot.node % 64);
          if (slot.node % 64 == 63) present[1] |= 1;
        }
      }
    }
  }

  // Moves the sums to cells of a row.
  void Emit(int row, BlockEchoes& echoes) {
    for (; heard_ != 0; heard_ &= heard_ - 1) {
      const int col = std::countr_zero(heard_);
      float* sums = &sums_[static_cast<std::size_t>(col) * shared_.materials * nodes_];
      const auto first = static_cast<std::uint32_t>(echoes.entries.size());
      for (int word = 0; word < words_; ++word) {
        std::uint64_t& present = present_[static_cast<std::size_t>(col) * words_ + word];
        for (; present != 0; present &= present - 1) {
          const int node = 64 * word + std::countr_zero(present);
          if (sums[node] > 0.0F) echoes.entries.push_back({static_cast<std::uint32_t>(node), sums[node]});
          sums[node] = 0.0F;
        }
      }
      const auto last = static_cast<std::uint32_t>(echoes.entries.size());
      if (last == first) continue;
      echoes.cells.push_back(
          {.row = row, .col = first_joined_ + col, .first_entry = first, .last_entry = last});
    }
  }

  const Gathering& shared_;
  int nodes_;
  int words_;
  int first_joined_ = 0;
  int joined_ = 0;  // columns that are to the left of an echo
  PatchShader::Buffers shaded_;
  std::array<float, RayCaster::kBlockCols> parts_ = {};
  std::array<float, RayCaster::kBlockCols> position_ = {};
  std::array<float, RayCaster::kBlockCols> step_ = {};
  std::array<float, RayCaster::kBlockCols> node_position_ = {};
  std::vector<Slot> slots_;
  std::vector<std::int32_t> newest_;  // slot per row (one past the row below) and column
  std::vector<float> sums_;           // per column and node, of the row that is emitted
  std::vector<std::uint64_t> present_;
  std::uint64_t heard_ = 0;  // columns with sums
};

// Joins the blocks: entries block by block, cells by row.
void Join(const std::vector<BlockEchoes>& blocks, EchoPower& frame) {
  std::vector<std::vector<std::size_t>> next(blocks.size(), std::vector<std::size_t>(frame.rows, 0));
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    for (const EchoPower::Cell& cell : blocks[block].cells) ++next[block][cell.row];
  });
  std::size_t cells = 0;
  for (int row = 0; row < frame.rows; ++row) {
    for (std::vector<std::size_t>& of_block : next) cells += std::exchange(of_block[row], cells);
  }
  std::vector<std::size_t> first_entry;
  std::size_t entries = 0;
  for (const BlockEchoes& block : blocks) {
    first_entry.push_back(entries);
    entries += block.entries.size();
  }
  frame.cells.resize(cells);
  frame.entries.resize(entries);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    const auto offset = static_cast<std::uint32_t>(first_entry[block]);
    for (const EchoPower::Cell& cell : blocks[block].cells) {
      frame.cells[next[block][cell.row]++] = {cell.row, cell.col, cell.first_entry + offset,
                                              cell.last_entry + offset};
    }
    std::copy(blocks[block].entries.begin(), blocks[block].entries.end(), frame.entries.begin() + offset);
  });
}

}  // namespace

int ColumnsTogether(const RayFan& fan, const AcousticGeometry& geometry, const ParameterSet& parameters) {
  const AzimuthShape<double> shape = AzimuthShapeOf(geometry.sonar, parameters);
  if (shape.pattern == AzimuthPattern::kTable) return 1;
  double widest_rad = 0.0;
  for (int col = 0; col < fan.cols(); ++col) widest_rad = std::max(widest_rad, fan.ColumnWidthRad(col));
  const int together = static_cast<int>(shape.width_rad / kColumnsOfBeam / widest_rad);
  return std::max(together, 1);
}

std::vector<ResponseWindow> SharpenedForShares(std::vector<ResponseWindow> windows, int together) {
  const double share = (1.0 - 1.0 / (static_cast<double>(together) * together)) / 12.0;
  for (ResponseWindow& window : windows) {
    double before = 0.0;
    for (std::size_t i = 0; i < window.weight.size(); ++i) {
      const double here = window.weight[i];
      const double after = i + 1 < window.weight.size() ? window.weight[i + 1] : 0.0;
      window.weight[i] = here - share * (after - 2.0 * here + before);
      before = here;
    }
  }
  return windows;
}

EchoPower CastEchoPower(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                        const AcousticGeometry& geometry, const ParameterSet& parameters) {
  SONARCAL_CHECK(fan.sampling() == Sampling::kBeams, "a pinhole's rays are gathered one at a time");
  const PolarAxes& axes = geometry.sonar.axes;
  EchoPower frame;
  frame.range_steps = RangeStepsFor(geometry.sonar, parameters);
  const FineRows rows(axes, frame.range_steps, PulseLengthM(geometry.sonar, parameters));
  const int together = ColumnsTogether(fan, geometry, parameters);
  const JoinedColumns columns(ColumnAzimuthsRad(fan), together);
  frame.rows = rows.count;
  frame.cols = static_cast<int>(columns.azimuth_rad.size());
  frame.materials = static_cast<int>(caster.material_names().size());
  frame.nodes = static_cast<int>(CoarseIncidenceDeg().size());
  frame.columns_together = together;
  frame.column_azimuth_rad = columns.azimuth_rad;

  const ParameterSet unit = WithUnitCurves(parameters, caster.material_names());
  const PatchShader shader(fan, EchoPowerModel(geometry, unit, caster.material_names()),
                           ElevationWidthDeg(geometry.sonar, parameters.beam));
  const Gathering shared{.fan = fan,
                         .shader = shader,
                         .columns = columns,
                         .range_rows = RangeRowsOf(rows, axes),
                         .rows = rows.count,
                         .materials = frame.materials,
                         .max_tangent = static_cast<float>(LargestTangent()),
                         .node_positions = NodePositions()};
  std::vector<BlockEchoes> blocks(RayCaster::CountBlocks(fan));
  tbb::enumerable_thread_specific<BlockGatherer> locals([&] { return BlockGatherer(shared); });
  caster.CastColumns(fan, world_from_sonar, axes.range_max_m, [&](const RayCaster::ColumnBlock& block) {
    blocks[block.index] = locals.local().Gather(block);
  });
  Join(blocks, frame);
  return frame;
}

}  // namespace sonarcal::sim
