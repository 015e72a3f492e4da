// Target strength of a sphere used as a standard target, for one sonar, water and pulse.
//
// A pulse shorter than the path to the sphere's first internal echo shows the front face alone. A longer one
// shows the whole sphere, whose series (sim/physics/sphere.h) is averaged over the band of the pulse. A pulse
// with the half-power length L, as a matched receiver shows it, is taken as one of the flat band
// B = .886 c / (2 L), whose response is a sinc.
#pragma once

#include <optional>
#include <string>

#include "core/types/sonar_model.h"

namespace sonarcal::calib {

struct StandardSphere {
  std::string material = "wc";  // of sim::NamedSphereMaterials()
  double diameter_m = 0.0;
  std::optional<double> bandwidth_hz = {};  // absent: that of the pulse
  double temperature_sigma_c = 1.0;         // standard error of the water's temperature
};

struct SphereStrength {
  double db = 0.0;        // re 1 m^2
  double sigma_db = 0.0;  // by the errors of the sphere's material and of the water's temperature
  bool front_face = false;
  double bandwidth_hz = 0.0;
  double first_internal_echo_m = 0.0;  // one way, behind the front face
  // The pulse is within a factor of two of first_internal_echo_m: neither case holds well.
  bool doubtful = false;
};

// Density of water in kg/m^3, within 1.3 kg/m^3 at 0..30 C, 0..40 ppt and little depth.
double WaterDensityKgPerM3(const Water& water);

// `pulse_m`: half-power length, one way. Throws DataError for an unknown material, a frequency or sound speed
// that the sonar does not state, and what sim::SphereCrossSectionM2 refuses.
SphereStrength StrengthOfSphere(const StandardSphere& sphere, const SonarModel& sonar, const Water& water,
                                double pulse_m);

}  // namespace sonarcal::calib
