#include "calib/standard_target/sphere_strength.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/types/error.h"
#include "sim/physics/sphere.h"

namespace sonarcal::calib {
namespace {

// Change of the speed of sound with temperature. 3 at 15 C, 4.5 near freezing, 2.4 at 25 C in fresh water.
constexpr double kSpeedPerDegree = 3.0;
constexpr double kHalfPowerOfSinc = 0.886;  // full width of sinc^2(x) at half power

sim::SphereMaterial MaterialNamed(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& [known, material] : sim::NamedSphereMaterials()) {
    if (known == name) return material;
    names.push_back(known);
  }
  throw DataError("material of the sphere '{}', expected one of {}", name, fmt::join(names, ", "));
}

}  // namespace

double WaterDensityKgPerM3(const Water& water) {
  const double from_densest_c = water.temperature_c - 4.0;
  return 999.97 - 0.0067 * from_densest_c * from_densest_c + 0.775 * water.salinity_ppt;
}

SphereStrength StrengthOfSphere(const StandardSphere& sphere, const SonarModel& sonar, const Water& water,
                                double pulse_m) {
  if (!(sonar.frequency_hz > 0.0) || !(sonar.sound_speed_m_per_s > 0.0)) {
    throw DataError(
        "the sonar states a frequency of {} Hz and a sound speed of {} m/s, expected both above 0",
        sonar.frequency_hz, sonar.sound_speed_m_per_s);
  }
  const sim::SphereInWater in_water{.material = MaterialNamed(sphere.material),
                                    .radius_m = 0.5 * sphere.diameter_m,
                                    .sound_speed_m_per_s = sonar.sound_speed_m_per_s,
                                    .water_density_kg_per_m3 = WaterDensityKgPerM3(water)};
  SphereStrength strength;
  strength.bandwidth_hz = sphere.bandwidth_hz.value_or(
      std::min(kHalfPowerOfSinc * sonar.sound_speed_m_per_s / (2.0 * pulse_m), 1.9 * sonar.frequency_hz));
  strength.first_internal_echo_m = sim::FirstInternalEchoM(in_water);
  const double ratio = pulse_m / strength.first_internal_echo_m;
  strength.front_face = ratio < 1.0;
  strength.doubtful = ratio > 0.5 && ratio < 2.0;
  const sim::SphereUncertainty errors{.sound_speed_m_per_s = kSpeedPerDegree * sphere.temperature_sigma_c};
  if (strength.front_face) {
    strength.db = sim::SphereFrontFaceDb(in_water);
    strength.sigma_db = sim::SphereFrontFaceSigmaDb(in_water, errors);
  } else {
    strength.db = sim::SphereTargetStrengthDb(in_water, sonar.frequency_hz, strength.bandwidth_hz);
    strength.sigma_db =
        sim::SphereTargetStrengthSigmaDb(in_water, sonar.frequency_hz, strength.bandwidth_hz, errors);
  }
  return strength;
}

}  // namespace sonarcal::calib
