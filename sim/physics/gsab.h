// Generic Seafloor Acoustic Backscatter model (Park 2024 Eq. 19; target strength: Eq. 20), from Ifremer:
// Lamarche, Lurton, Verdier, Augustin, Continental Shelf Research 31, 2011.
//
//   GSAB(delta) = A exp(-delta^2 / 2 B^2) + C cos(delta)^D + E exp(-delta^2 / 2 F^2)
//
// delta is the angle between the ray and the surface normal, 0..90 degrees. A, C and E are power ratios, B
// and F half-widths in degrees, D an exponent (the paper's typesetting could be read as a factor). The
// paper's model uses 10 log10 GSAB as the target strength of one ray, the acoustic model as backscattering
// strength per unit area.
#pragma once

#include <cmath>
#include <limits>

#include "core/types/parameters.h"
#include "core/types/units.h"

namespace sonarcal::sim {

// Lower limit of the power; it keeps the logarithm finite at 90 degrees.
inline constexpr double kGsabFloor = 1e-12;

// GsabPeaksPower: the two peaks, for facets tilted by tilt_deg from the normal. GsabSlowPower: the cosine
// term, at this cosine of incidence.
template <typename T>
T GsabPeaksPower(const GsabParameters<T>& p, double tilt_deg) {
  using std::exp;
  const double square = tilt_deg * tilt_deg;
  return p.a * exp(T(-0.5 * square) / (p.b_deg * p.b_deg)) +
         p.e * exp(T(-0.5 * square) / (p.f_deg * p.f_deg));
}

template <typename T>
T GsabSlowPower(const GsabParameters<T>& p, double cosine) {
  using std::pow;
  return p.c * pow(T(cosine), p.d);
}

template <typename T>
T GsabPower(const GsabParameters<T>& p, double incidence_deg) {
  T power = GsabPeaksPower(p, incidence_deg);
  const double cosine = std::cos(RadFromDeg(incidence_deg));
  if (cosine > std::numeric_limits<double>::epsilon()) power += GsabSlowPower(p, cosine);
  return power;
}

// Scattering between two directions, at incidence_deg and other_deg from the normal, with the normal tilt_deg
// off their bisector. Symmetric in the two directions; equals GsabPower if they coincide. The two peaks come
// from facets, which reflect one direction into the other if they are tilted by tilt_deg. The cosine term
// depends on the geometric mean of both cosines. No publication gives this extension of the curves. It agrees
// with an independent coherent simulation of a tank (docs/studies/ghosts.md); the mean of both backscatter
// values does not.
template <typename T>
T GsabBetweenPower(const GsabParameters<T>& p, double incidence_deg, double other_deg, double tilt_deg) {
  T power = GsabPeaksPower(p, tilt_deg);
  const double cosines = std::cos(RadFromDeg(incidence_deg)) * std::cos(RadFromDeg(other_deg));
  if (cosines > std::numeric_limits<double>::epsilon()) power += GsabSlowPower(p, std::sqrt(cosines));
  return power;
}

template <typename T>
T GsabDb(const GsabParameters<T>& p, double incidence_deg) {
  const T power = GsabPower(p, incidence_deg);
  return DbFromPower(power > T(kGsabFloor) ? power : T(kGsabFloor));
}

}  // namespace sonarcal::sim
