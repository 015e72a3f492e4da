#include "sim/acoustic/patch_shader.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/types/units.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"

namespace sonarcal::sim {
namespace {

// Table steps per width of a peak or beam. Linear interpolation is then accurate to 1e-5 of the peak.
constexpr double kStepsAWidth = 300.0;

// Half the step of the differences that give slopes, rad.
constexpr double kSlopeStepRad = 1e-4;

int TableSteps(double whole_in_widths) {
  return static_cast<int>(std::clamp(kStepsAWidth * whole_in_widths, 4096.0, 131072.0));
}

// Table of `value` over 0..1: values[0 .. steps + 1].
template <typename Value>
std::vector<float> Tabulated(int steps, const Value& value) {
  std::vector<float> table(steps + 2);
  tbb::parallel_for(tbb::blocked_range<int>(0, steps + 2, 512), [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i != range.end(); ++i)
      table[i] = static_cast<float>(value(std::min(1.0, static_cast<double>(i) / steps)));
  });
  return table;
}

float At(const std::vector<float>& table, int steps, float position) {
  const float at = std::clamp(position, 0.0F, 1.0F) * static_cast<float>(steps);
  const int i = static_cast<int>(at);
  const float between = at - static_cast<float>(i);
  return table[i] + between * (table[i + 1] - table[i]);
}

// Change of a curve per unit of the cosine of incidence.
double SlopeByCosine(const GsabParameters<double>& curve, double incidence_rad) {
  const double at = std::clamp(incidence_rad, 2.0 * kSlopeStepRad, 0.5 * std::numbers::pi - kSlopeStepRad);
  const double rise =
      GsabPower(curve, DegFromRad(at + kSlopeStepRad)) - GsabPower(curve, DegFromRad(at - kSlopeStepRad));
  return -rise / (2.0 * kSlopeStepRad * std::sin(at));
}

}  // namespace

PatchShader::PatchShader(const RayFan& fan, const EchoPowerModel& model, double elevation_width_deg,
                         bool slopes)
    : fan_(fan),
      // Spreading (40 log10 R) and the patch's R^2 together leave 1 / R^2.
      loss_per_m_(
          static_cast<float>(2.0 * TransmissionLossDb(1.0, model.absorption_db_per_m()) * kNeperPerDb)),
      factor_(model.level()) {
  double narrowest_deg = 90.0;
  for (const GsabParameters<double>& curve : model.materials())
    narrowest_deg = std::min({narrowest_deg, curve.b_deg, curve.f_deg});
  strength_steps_ = TableSteps(90.0 / narrowest_deg);
  for (const GsabParameters<double>& curve : model.materials()) {
    // Materials without a curve of their own share one.
    const auto earlier = std::find(model.materials().begin(), model.materials().end(), curve);
    if (const auto same = static_cast<std::size_t>(earlier - model.materials().begin());
        same < strength_.size()) {
      strength_.emplace_back(strength_[same]);
      if (slopes) strength_slopes_.emplace_back(strength_slopes_[same]);
      continue;
    }
    const auto over_incidence = [&](const auto& value) {
      return Tabulated(strength_steps_, [&](double half_tangent) {
        const double incidence_rad = 2.0 * std::atan(half_tangent);
        return value(incidence_rad) * PatchAreaM2(1.0, 1.0, std::cos(incidence_rad));
      });
    };
    strength_.push_back(
        over_incidence([&](double incidence_rad) { return GsabPower(curve, DegFromRad(incidence_rad)); }));
    if (slopes) {
      strength_slopes_.push_back(
          over_incidence([&](double incidence_rad) { return SlopeByCosine(curve, incidence_rad); }));
    }
  }
  const double top_rad = fan.RowElevationRad(0) + 0.5 * fan.RowHeightRad(0);
  lowest_rad_ = fan.RowElevationRad(fan.rows() - 1) - 0.5 * fan.RowHeightRad(fan.rows() - 1);
  span_rad_ = top_rad - lowest_rad_;
  elevation_steps_ = TableSteps(DegFromRad(span_rad_) / std::max(elevation_width_deg, 1e-3));
  const auto over_elevation = [&](const auto& value) {
    return Tabulated(elevation_steps_, [&](double part) {
      const double elevation_rad = lowest_rad_ + part * span_rad_;
      return std::cos(elevation_rad) * value(elevation_rad);
    });
  };
  elevation_ = over_elevation([&](double elevation_rad) { return model.elevation().Power(elevation_rad); });
  if (slopes) {
    elevation_slopes_ = over_elevation([&](double elevation_rad) {
      return (model.elevation().Power(elevation_rad + kSlopeStepRad) -
              model.elevation().Power(elevation_rad - kSlopeStepRad)) /
             (2.0 * kSlopeStepRad);
    });
  }
  for (int row = 0; row < fan.rows(); ++row) row_curve_.push_back(CurveOf(row));
  for (int col = 0; col < fan.cols(); ++col) {
    width_rad_.push_back(static_cast<float>(fan.ColumnWidthRad(col)));
    elevation_offset_.push_back(fan.ElevationOffset(col));
  }
}

PatchShader::RowCurve PatchShader::CurveOf(int row) const {
  constexpr float kMaxError = 1e-4F;  // relative
  const auto middle = static_cast<float>((fan_.RowElevationRad(row) - lowest_rad_) / span_rad_);
  const auto height = static_cast<float>(fan_.RowHeightRad(row) / span_rad_);
  const auto at = [&](float offset) { return At(elevation_, elevation_steps_, middle + offset * height); };
  const float a = at(0.0F);
  const float b = at(0.5F) - at(-0.5F);
  const float c = 2.0F * (at(0.5F) + at(-0.5F) - 2.0F * a);
  bool holds = true;
  for (const float offset : {-0.375F, -0.25F, -0.125F, 0.125F, 0.25F, 0.375F}) {
    const float exact = at(offset);
    holds = holds && std::abs(a + offset * (b + offset * c) - exact) <= kMaxError * exact;
  }
  const auto scale = static_cast<float>(fan_.RowHeight(row));
  return {holds, scale * a, scale * b, scale * c};
}

void PatchShader::Shade(const RowHits& hits, Buffers& of) const {
  const int first_col = hits.col[0];
  const int cols = hits.col[hits.count - 1] + 1 - first_col;
  of.of_columns.resize(cols);
  of.power.resize(hits.count);
  const float* offset = elevation_offset_.data() + first_col;
  const float* width = width_rad_.data() + first_col;
  if (const RowCurve& curve = row_curve_[hits.row]; curve.holds) {
    row_math::QuadraticWeights(curve.a, curve.b, curve.c, offset, width, cols, of.of_columns.data());
  } else {
    row_math::ElevationWeights({elevation_.data(), elevation_steps_},
                               static_cast<float>((fan_.RowElevationRad(hits.row) - lowest_rad_) / span_rad_),
                               static_cast<float>(fan_.RowHeightRad(hits.row) / span_rad_), offset, width,
                               cols, of.of_columns.data());
    const auto height = static_cast<float>(fan_.RowHeight(hits.row));
    for (float& of_column : of.of_columns) of_column *= height;
  }
  const float* weight = of.of_columns.data();
  if (hits.count < cols) {
    of.weight.resize(hits.count);
    for (int i = 0; i < hits.count; ++i) of.weight[i] = of.of_columns[hits.col[i] - first_col];
    weight = of.weight.data();
  }
  ForEachMaterial(hits, [&](int first, int count) {
    const row_math::Table strength{strength_[hits.material[first]].data(), strength_steps_};
    row_math::PatchPowers(strength, loss_per_m_, hits.range_m + first, hits.half_tangent + first,
                          weight + first, count, of.power.data() + first);
  });
}

PatchShader::Patch PatchShader::Shade(int row, int col, int material, float range_m,
                                      float half_tangent) const {
  const auto part = static_cast<float>(
      (fan_.RowElevationRad(row) + elevation_offset_[col] * fan_.RowHeightRad(row) - lowest_rad_) /
      span_rad_);
  const float common = static_cast<float>(fan_.RowHeight(row)) * width_rad_[col] *
                       std::exp(-loss_per_m_ * range_m) / (range_m * range_m);
  const float strength = common * At(strength_[material], strength_steps_, half_tangent);
  const float elevation = At(elevation_, elevation_steps_, part);
  return {.power = strength * elevation,
          .by_elevation = strength * At(elevation_slopes_, elevation_steps_, part),
          .by_cosine = common * At(strength_slopes_[material], strength_steps_, half_tangent) * elevation};
}

row_math::RangeRows RangeRowsOf(const FineRows& rows, const PolarAxes& axes) {
  return {.nearest_m = static_cast<float>(axes.range_min_m),
          .farthest_m = static_cast<float>(axes.range_max_m),
          .first_m = static_cast<float>(rows.first_m),
          .per_m = static_cast<float>(rows.per_m),
          .part_m = static_cast<float>(rows.part_m),
          .max_parts = static_cast<float>(FineRows::kMaxParts)};
}

}  // namespace sonarcal::sim
