// Power of the patches that rays of a fan represent, by tables in single precision. The formulas are those of
// sim/acoustic/acoustic_image.h. The power of a ray is a product of a common factor, a function of range and
// incidence, a function of elevation, and the width of its column.
#pragma once

#include <vector>

#include "sim/acoustic/acoustic_image.h"
#include "sim/rays/ray_caster.h"
#include "sim/rays/row_math/echoes.h"

namespace sonarcal::sim {

class PatchShader {
 public:
  // The fan has the sampling `beams` and must outlive the shader. `elevation_width_deg`: half-power width of
  // the beam. `slopes`: whether Shade will be called for slopes, too.
  PatchShader(const RayFan& fan, const EchoPowerModel& model, double elevation_width_deg,
              bool slopes = false);

  // Common factor of all powers.
  double factor() const { return factor_; }
  // Two-way absorption, nepers of power per metre.
  float loss_per_m() const { return loss_per_m_; }

  struct Buffers {
    std::vector<float> of_columns;
    std::vector<float> weight;
    std::vector<float> power;
  };

  // Power of each hit, before `factor`. All hits are in one block of columns.
  void Shade(const RowHits& hits, Buffers& of) const;

  // Power of a patch and its slopes, before the common factor.
  struct Patch {
    float power = 0.0F;
    float by_elevation = 0.0F;  // per radian
    float by_cosine = 0.0F;     // per unit of the cosine of incidence, of a patch of fixed area
  };
  Patch Shade(int row, int col, int material, float range_m, float half_tangent) const;

 private:
  // Elevation weight of a row times the height of the row: a + b o + c o^2 at the elevation offset o.
  struct RowCurve {
    bool holds = false;  // whether it agrees with the table over the whole row
    float a = 0.0F;
    float b = 0.0F;
    float c = 0.0F;
  };
  RowCurve CurveOf(int row) const;

  const RayFan& fan_;
  float loss_per_m_;
  double factor_;
  std::vector<std::vector<float>> strength_;         // per material, over tan(incidence / 2)
  std::vector<std::vector<float>> strength_slopes_;  // by the cosine; empty without slopes
  int strength_steps_ = 0;
  std::vector<float> elevation_;  // beam response times cosine, from the lowest elevation up
  std::vector<float> elevation_slopes_;
  int elevation_steps_ = 0;
  std::vector<RowCurve> row_curve_;
  double lowest_rad_ = 0.0;
  double span_rad_ = 0.0;
  std::vector<float> width_rad_;
  std::vector<float> elevation_offset_;
};

// Rows of range for row_math::EchoParts.
row_math::RangeRows RangeRowsOf(const FineRows& rows, const PolarAxes& axes);

}  // namespace sonarcal::sim
