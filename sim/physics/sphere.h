// Target strength of a solid elastic sphere: the standard target of a calibration.
//
// The far field of a plane wave is a series over modes l (MacLennan, The theory of solid spheres as sonar
// calibration targets, Scottish Fisheries Research Report 22, 1981):
//
//   f = -(2 / q) sum over l of (-1)^l (2 l + 1) sin(eta_l) exp(i eta_l),   TS = 10 log10(a^2 |f|^2 / 4)
//
// q = k a is the size parameter and a the radius. The phase eta_l follows from the boundary conditions on the
// sphere. Sound is not absorbed in the sphere.
//
// To add a material: an entry in NamedSphereMaterials().
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sonarcal::sim {

struct SphereMaterial {
  double longitudinal_m_per_s = 0.0;
  double transverse_m_per_s = 0.0;
  double density_kg_per_m3 = 0.0;
};

// "wc": tungsten carbide with cobalt (MacLennan and Dunn 1984); "steel-440c": stainless steel.
const std::vector<std::pair<std::string, SphereMaterial>>& NamedSphereMaterials();

struct SphereInWater {
  SphereMaterial material;
  double radius_m = 0.0;
  double sound_speed_m_per_s = 0.0;  // of the water
  double water_density_kg_per_m3 = 0.0;
};

// Backscattering cross section a^2 |f|^2 / 4 in m^2; TS is its level in dB re 1 m^2. Throws DataError for a
// value that is not positive, and for a size parameter above 2000.
double SphereCrossSectionM2(const SphereInWater& sphere, double frequency_hz);

// Target strength in dB, averaged in power over a flat band. 0 <= bandwidth_hz < 2 frequency_hz; 0 means one
// frequency. Throws DataError as SphereCrossSectionM2 does.
double SphereTargetStrengthDb(const SphereInWater& sphere, double frequency_hz, double bandwidth_hz);

// Target strength in dB of the front face alone, 20 log10(a / 2) + 20 log10 R, R from the impedances. Valid
// if the pulse is shorter than FirstInternalEchoM.
double SphereFrontFaceDb(const SphereInWater& sphere);

// Range by which the first internal echo lies behind that of the front face: the longitudinal wave crosses
// the sphere and returns. Metres of one-way range in water.
double FirstInternalEchoM(const SphereInWater& sphere);

// Standard errors of what the target strength depends on.
struct SphereUncertainty {
  double longitudinal_share = 0.005;  // relative
  double transverse_share = 0.005;
  double density_share = 0.005;
  double sound_speed_m_per_s = 0.0;  // water: the error of the temperature times about 3 m/s per degree
};

// Standard error of SphereTargetStrengthDb in dB, for independent errors. Each contribution is the root mean
// square of the changes at plus and minus one standard error, because TS may lie at an extremum.
double SphereTargetStrengthSigmaDb(const SphereInWater& sphere, double frequency_hz, double bandwidth_hz,
                                   const SphereUncertainty& uncertainty);

// Standard error of SphereFrontFaceDb in dB, likewise.
double SphereFrontFaceSigmaDb(const SphereInWater& sphere, const SphereUncertainty& uncertainty);

}  // namespace sonarcal::sim
