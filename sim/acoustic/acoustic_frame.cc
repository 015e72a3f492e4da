#include "sim/acoustic/acoustic_frame.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>

#include "core/types/error.h"
#include "sim/acoustic/patch_shader.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/patch.h"
#include "sim/rays/row_math/sums.h"

namespace sonarcal::sim {
namespace {

static_assert(RayCaster::kBlockCols == row_math::kBlockCols);

// Power per fine row of a block of columns, before the common factor of the shader: FineRows::Spread in
// single precision. Reused from block to block.
class BlockMap {
 public:
  BlockMap(const RayFan& fan, const PatchShader& shader, const FineRows& rows, const PolarAxes& axes)
      : fan_(fan),
        shader_(shader),
        rows_(RangeRowsOf(rows, axes)),
        count_(rows.count),
        max_tangent_(static_cast<float>(LargestTangent())),
        power_(static_cast<std::size_t>(rows.count + 2) * RayCaster::kBlockCols) {}

  void Cast(const RayCaster::ColumnBlock& block) {
    std::fill(power_.begin(), power_.end(), 0.0F);
    first_col_ = block.first_col;
    block.cast([this](const RowHits& hits) { Add(hits); });
  }

  int rows() const { return count_; }
  // RayCaster::kBlockCols values.
  const float* Row(int row) const {
    return &power_[static_cast<std::size_t>(row + 1) * RayCaster::kBlockCols];
  }

 private:
  void Add(const RowHits& hits) {
    if (hits.count == 0) return;
    shader_.Shade(hits, shaded_);
    row_math::EchoParts(rows_, static_cast<float>(fan_.SpreadHeightRad(hits.row, 0)), max_tangent_,
                        hits.range_m, hits.half_tangent, hits.count, parts_.data(), position_.data(),
                        step_.data());
    for (int i = 0; i < hits.count; ++i) {
      float* column = &power_[hits.col[i] - first_col_];
      if (parts_[i] == 1.0F) {
        AddAt(column, position_[i], shaded_.power[i]);
      } else if (parts_[i] > 1.0F) {
        AddParts(column, i);
      }
    }
  }

  // Shares a power between the two rows next to a position. The rows before the first and after the last one
  // take what lies outside.
  static void AddAt(float* column, float position, float power) {
    const float above = position + 1.0F;
    const int row = static_cast<int>(above);
    const float further = (above - static_cast<float>(row)) * power;
    float* cell = column + static_cast<std::ptrdiff_t>(row) * RayCaster::kBlockCols;
    cell[0] += power - further;
    cell[RayCaster::kBlockCols] += further;
  }

  void AddParts(float* column, int i) {
    const auto end = static_cast<float>(count_) - 0.5F;
    const float power = shaded_.power[i] / parts_[i];
    const int parts = static_cast<int>(parts_[i]);
    for (int part = 0; part < parts; ++part) {
      float at = position_[i] + static_cast<float>(part) * step_[i];
      if (at < -0.5F) at = -1.0F - at;
      if (at > end) at = 2.0F * end - at;
      if (at > -1.0F && at <= end) AddAt(column, at, power);
    }
  }

  const RayFan& fan_;
  const PatchShader& shader_;
  row_math::RangeRows rows_;
  int count_;
  float max_tangent_;
  int first_col_ = 0;
  PatchShader::Buffers shaded_;
  std::array<float, RayCaster::kBlockCols> parts_ = {};
  std::array<float, RayCaster::kBlockCols> position_ = {};
  std::array<float, RayCaster::kBlockCols> step_ = {};
  std::vector<float> power_;  // one more row before the first and after the last
};

PatchShader ShaderOf(const RayFan& fan, const AcousticGeometry& geometry, const ParameterSet& parameters,
                     const std::vector<std::string>& material_names) {
  SONARCAL_CHECK(fan.sampling() == Sampling::kBeams, "a pinhole's rays are shaded one at a time");
  return {fan, EchoPowerModel(geometry, parameters, material_names),
          ElevationWidthDeg(geometry.sonar, parameters.beam)};
}

// Calls of_block(block, map) for each block of columns, on all cores.
template <typename OfBlock>
void CastBlocks(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                const PolarAxes& axes, const PatchShader& shader, const FineRows& rows,
                const OfBlock& of_block) {
  tbb::enumerable_thread_specific<BlockMap> locals([&] { return BlockMap(fan, shader, rows, axes); });
  caster.CastColumns(fan, world_from_sonar, axes.range_max_m, [&](const RayCaster::ColumnBlock& block) {
    BlockMap& map = locals.local();
    map.Cast(block);
    of_block(block, map);
  });
}

// Adds nothing outside of the map's rows.
void WeighRows(const BlockMap& map, const std::vector<float>& weight, int first_row, float* sums) {
  const int begin = std::max(first_row, 0);
  const int end = std::min(first_row + static_cast<int>(weight.size()), map.rows());
  if (begin < end) row_math::WeighRows(&weight[begin - first_row], map.Row(begin), end - begin, sums);
}

}  // namespace

ScatterMap CastScatterMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                          const AcousticGeometry& geometry, const ParameterSet& parameters) {
  ScatterMap scatter = EmptyScatterMap(fan, geometry, parameters);
  const PolarAxes& axes = geometry.sonar.axes;
  const PatchShader shader = ShaderOf(fan, geometry, parameters, caster.material_names());
  CastBlocks(caster, fan, world_from_sonar, axes, shader, scatter.RowsOf(axes),
             [&](const RayCaster::ColumnBlock& block, const BlockMap& map) {
               for (int row = 0; row < map.rows(); ++row) {
                 const float* power = map.Row(row);
                 for (int i = 0; i < block.cols; ++i)
                   scatter.power(row, block.first_col + i) = shader.factor() * power[i];
               }
             });
  return scatter;
}

PulsedCaster::PulsedCaster(const RayFan& fan, const AcousticGeometry& geometry,
                           const ParameterSet& parameters, const std::vector<std::string>& material_names)
    : fan_(fan),
      sonar_(geometry.sonar),
      shader_(ShaderOf(fan, geometry, parameters, material_names)),
      rows_(sonar_.axes, RangeStepsFor(sonar_, parameters), PulseLengthM(sonar_, parameters)),
      steps_(RangeStepsFor(sonar_, parameters)) {
  const ResponseWindow pulse = PulseWindow(sonar_, parameters, steps_, ResponseOf::kPower);
  first_row_ = pulse.first;
  pulse_.assign(pulse.weight.begin(), pulse.weight.end());
}

PulsedMap PulsedCaster::Cast(const RayCaster& caster, const Pose& world_from_sonar) const {
  const PolarAxes& axes = sonar_.axes;
  const auto factor = static_cast<float>(shader_.factor());
  PulsedMap pulsed{Grid<float>(axes.range_bins, fan_.cols()), ColumnAzimuthsRad(fan_)};
  CastBlocks(caster, fan_, world_from_sonar, axes, shader_, rows_,
             [&](const RayCaster::ColumnBlock& block, const BlockMap& map) {
               for (int bin = 0; bin < axes.range_bins; ++bin) {
                 std::array<float, RayCaster::kBlockCols> sums = {};
                 WeighRows(map, pulse_, bin * steps_ + first_row_, sums.data());
                 for (int i = 0; i < block.cols; ++i)
                   pulsed.power(bin, block.first_col + i) = factor * sums[i];
               }
             });
  return pulsed;
}

ScatterMap ScatterFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                       const AcousticGeometry& geometry, const ParameterSet& parameters,
                       const TraceOptions& options) {
  if (CastsInOnePass(fan, options))
    return CastScatterMap(caster, fan, world_from_sonar, geometry, parameters);
  return MakeScatterMap(Trace(caster, fan, world_from_sonar, geometry.sonar.axes, options), fan, geometry,
                        parameters);
}

}  // namespace sonarcal::sim
