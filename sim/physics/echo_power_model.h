// Mean power of the acoustic model's echoes, before beam in azimuth and pulse:
//
//   P = 10^((SL + G - TL_out - TL_back) / 10) sigma_m(delta) a sqrt(el(phi_out) el(phi_back)),
//
// TL one way (sim/physics/propagation.h), sigma_m GSAB as backscatter per unit area (sim/physics/gsab.h), a =
// R^2 dOmega / cos(delta) the patch that a ray represents (sim/physics/patch.h), el the two-way elevation
// response. A direct echo has the same loss and elevation both ways, a multipath echo has not.
// sim/acoustic/acoustic_frame.h has a fast version in single precision, which its test compares with this
// one.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"

namespace sonarcal::sim {

// Sonar and water of an acoustic image.
struct AcousticGeometry {
  const SonarModel& sonar;
  double absorption_db_per_m = 0.0;
};

// Geometry of one echo.
struct EchoPath {
  double loss_db = 0.0;          // loss out and back
  double elevation_power = 1.0;  // sqrt(el(phi_out) el(phi_back))
  double area_m2 = 0.0;          // area of the patch
};

class EchoPowerModel {
 public:
  // Throws DataError if the parameters have no entry for a material.
  EchoPowerModel(const AcousticGeometry& geometry, const ParameterSet& parameters,
                 const std::vector<std::string>& material_names)
      : level_db_(parameters.source_level_db + parameters.receiver.gain_db),
        absorption_db_per_m_(geometry.absorption_db_per_m),
        elevation_(ElevationResponseOf(geometry.sonar, parameters.beam)) {
    for (const std::string& name : material_names) materials_.push_back(parameters.Material(name).gsab);
  }

  // 10^((SL + G) / 10).
  double level() const { return PowerFromDb(level_db_); }
  double absorption_db_per_m() const { return absorption_db_per_m_; }
  const ElevationResponse& elevation() const { return elevation_; }
  const std::vector<GsabParameters<double>>& materials() const { return materials_; }

  // Path of an echo that comes straight back from a patch. range_m > 0.
  EchoPath StraightBack(double range_m, double incidence_rad, double solid_angle_sr,
                        double elevation_power) const {
    return {.loss_db = 2.0 * TransmissionLossDb(range_m, absorption_db_per_m_),
            .elevation_power = elevation_power,
            .area_m2 = PatchAreaM2(range_m, solid_angle_sr, std::cos(incidence_rad))};
  }

  // Power backscattered per unit area of a material, by index into `material_names`.
  double Backscatter(int material, double incidence_rad) const {
    return GsabPower(materials_[material], DegFromRad(incidence_rad));
  }

  // Mean power of an echo from a surface that scatters `backscatter` per unit area.
  double Power(const EchoPath& path, double backscatter) const {
    return PowerAtLevel(level_db_, path, backscatter);
  }

  // Power for SL + G = 0 dB and unit backscatter: the factor of the geometry.
  static double UnitPower(const EchoPath& path) { return PowerAtLevel(0.0, path, 1.0); }

 private:
  static double PowerAtLevel(double level_db, const EchoPath& path, double backscatter) {
    return PowerFromDb(level_db - path.loss_db) * backscatter * path.area_m2 * path.elevation_power;
  }

  double level_db_;
  double absorption_db_per_m_;
  ElevationResponse elevation_;
  std::vector<GsabParameters<double>> materials_;
};

}  // namespace sonarcal::sim
