#include "sim/acoustic/acoustic_frame.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"
#include "sim/rays/row_math.h"

namespace sonarcal::sim {
namespace {

// Table steps per width of a peak or beam. Linear interpolation is then accurate to 1e-5 of the peak.
constexpr double kStepsAWidth = 300.0;

int TableSteps(double whole_in_widths) {
  return static_cast<int>(std::clamp(kStepsAWidth * whole_in_widths, 4096.0, 131072.0));
}

// Table of `value` over 0..1: values[0 .. steps + 1].
template <typename Value>
std::vector<float> Tabulated(int steps, const Value& value) {
  std::vector<float> table;
  for (int i = 0; i <= steps + 1; ++i)
    table.push_back(static_cast<float>(value(std::min(1.0, static_cast<double>(i) / steps))));
  return table;
}

// Data shared by all rays of a frame. The power of a ray is a product of a common factor (`factor`), a
// function of range and incidence (row_math::PatchPowers), a function of elevation, and the width of its
// column.
class PatchShader {
 public:
  // `elevation_width_deg`: half-power width of the beam.
  PatchShader(const RayFan& fan, const EchoPowerModel& model, double elevation_width_deg)
      : fan_(fan),
        // Two-way absorption. Spreading (40 log10 R) and the patch's R^2 together leave 1 / R^2.
        loss_per_m_(
            static_cast<float>(2.0 * TransmissionLossDb(1.0, model.absorption_db_per_m()) * kNeperPerDb)),
        factor_(model.level()) {
    double narrowest_deg = 90.0;
    for (const GsabParameters<double>& curve : model.materials())
      narrowest_deg = std::min({narrowest_deg, curve.b_deg, curve.f_deg});
    strength_steps_ = TableSteps(90.0 / narrowest_deg);
    for (const GsabParameters<double>& curve : model.materials()) {
      strength_.push_back(Tabulated(strength_steps_, [&](double half_tangent) {
        const double incidence_rad = 2.0 * std::atan(half_tangent);
        return GsabPower(curve, DegFromRad(incidence_rad)) * PatchAreaM2(1.0, 1.0, std::cos(incidence_rad));
      }));
    }
    const double top_rad = fan.RowElevationRad(0) + 0.5 * fan.RowHeightRad(0);
    lowest_rad_ = fan.RowElevationRad(fan.rows() - 1) - 0.5 * fan.RowHeightRad(fan.rows() - 1);
    span_rad_ = top_rad - lowest_rad_;
    elevation_steps_ = TableSteps(DegFromRad(span_rad_) / std::max(elevation_width_deg, 1e-3));
    elevation_ = Tabulated(elevation_steps_, [&](double part) {
      const double elevation_rad = lowest_rad_ + part * span_rad_;
      return std::cos(elevation_rad) * model.elevation().Power(elevation_rad);
    });
    for (int col = 0; col < fan.cols(); ++col) {
      width_rad_.push_back(static_cast<float>(fan.ColumnWidthRad(col)));
      elevation_offset_.push_back(fan.ElevationOffset(col));
    }
  }

  double factor() const { return factor_; }

  struct Buffers {
    std::vector<float> of_columns;
    std::vector<float> weight;
    std::vector<float> power;
  };

  // Power of each hit, before `factor`. All hits are in one block of columns.
  void Shade(const RowHits& hits, Buffers& of) const {
    const int first_col = hits.col[0];
    const int cols = hits.col[hits.count - 1] + 1 - first_col;
    of.of_columns.resize(cols);
    of.weight.resize(hits.count);
    of.power.resize(hits.count);
    row_math::ElevationWeights({elevation_.data(), elevation_steps_},
                               static_cast<float>((fan_.RowElevationRad(hits.row) - lowest_rad_) / span_rad_),
                               static_cast<float>(fan_.RowHeightRad(hits.row) / span_rad_),
                               elevation_offset_.data() + first_col, width_rad_.data() + first_col, cols,
                               of.of_columns.data());
    const auto height = static_cast<float>(fan_.RowHeight(hits.row));
    for (int i = 0; i < hits.count; ++i) of.weight[i] = height * of.of_columns[hits.col[i] - first_col];
    ForEachMaterial(hits, [&](int first, int count) {
      const row_math::Table strength{strength_[hits.material[first]].data(), strength_steps_};
      row_math::PatchPowers(strength, loss_per_m_, hits.range_m + first, hits.half_tangent + first,
                            of.weight.data() + first, count, of.power.data() + first);
    });
  }

 private:
  const RayFan& fan_;
  float loss_per_m_;  // nepers of power per metre
  double factor_;
  std::vector<std::vector<float>> strength_;  // per material, over tan(incidence / 2)
  int strength_steps_ = 0;
  std::vector<float> elevation_;  // beam response times cosine, from the lowest elevation up
  int elevation_steps_ = 0;
  double lowest_rad_ = 0.0;
  double span_rad_ = 0.0;
  std::vector<float> width_rad_;
  std::vector<float> elevation_offset_;
};

}  // namespace

ScatterMap CastScatterMap(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                          const AcousticGeometry& geometry, const ParameterSet& parameters) {
  SONARCAL_CHECK(fan.sampling() == Sampling::kBeams, "a pinhole's rays are shaded one at a time");
  const PolarAxes& axes = geometry.sonar.axes;
  ScatterMap scatter = EmptyScatterMap(fan, geometry, parameters);
  const PatchShader shader(fan, EchoPowerModel(geometry, parameters, caster.material_names()),
                           ElevationWidthDeg(geometry.sonar, parameters.beam));
  const FineRows rows = scatter.RowsOf(axes);
  const auto nearest_m = static_cast<float>(axes.range_min_m);
  const auto farthest_m = static_cast<float>(axes.range_max_m);
  tbb::enumerable_thread_specific<PatchShader::Buffers> locals;
  caster.CastColumns(fan, world_from_sonar, axes.range_max_m, [&](const RowHits& hits) {
    if (hits.count == 0) return;
    PatchShader::Buffers& of = locals.local();
    shader.Shade(hits, of);
    for (int i = 0; i < hits.count; ++i) {
      const float range_m = hits.range_m[i];
      // A ray that starts on a surface hits it at range 0, where the transmission loss is undefined.
      if (!(range_m > 0.0F && range_m >= nearest_m && range_m < farthest_m)) continue;
      const double square = double{hits.half_tangent[i]} * hits.half_tangent[i];
      const double depth_m =
          PatchDepthM(range_m, fan.SpreadHeightRad(hits.row, 0), (1.0 - square) / (1.0 + square));
      scatter.Add(rows, range_m, depth_m, hits.col[i], shader.factor() * of.power[i]);
    }
  });
  return scatter;
}

ScatterMap ScatterFrom(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                       const AcousticGeometry& geometry, const ParameterSet& parameters,
                       const TraceOptions& options) {
  if (fan.sampling() == Sampling::kBeams && options.normals == NormalSource::kGeometric)
    return CastScatterMap(caster, fan, world_from_sonar, geometry, parameters);
  return MakeScatterMap(Trace(caster, fan, world_from_sonar, geometry.sonar.axes, options), fan, geometry,
                        parameters);
}

}  // namespace sonarcal::sim
