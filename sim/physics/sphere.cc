#include "sim/physics/sphere.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

// Spherical Bessel functions j_l(x), l = 0 .. last, by the recurrence downwards, which is stable. Their scale
// follows from j_0 or j_1, whichever is larger: the other may be near a zero.
std::vector<double> BesselJ(int last, double x) {
  constexpr double kLarge = 1e120;
  const int start = std::max(last, static_cast<int>(x)) + 30 + static_cast<int>(6.0 * std::cbrt(x));
  std::vector<double> j(start + 2, 0.0);
  j[start] = 1.0;
  for (int l = start; l > 0; --l) {
    j[l - 1] = (2 * l + 1) / x * j[l] - j[l + 1];
    if (std::abs(j[l - 1]) < kLarge) continue;
    for (int k = l - 1; k <= start; ++k) j[k] /= kLarge;
  }
  const double j0 = std::sin(x) / x;
  const double j1 = (j0 - std::cos(x)) / x;
  const double scale = std::abs(j0) > std::abs(j1) ? j0 / j[0] : j1 / j[1];
  j.resize(last + 1);
  for (double& value : j) value *= scale;
  return j;
}

// Spherical Bessel functions y_l(x), l = 0 .. last, by the recurrence upwards, which is stable.
std::vector<double> BesselY(int last, double x) {
  std::vector<double> y(std::max(last + 1, 2));
  y[0] = -std::cos(x) / x;
  y[1] = (y[0] - std::sin(x)) / x;
  for (int l = 1; l < last; ++l) y[l + 1] = (2 * l + 1) / x * y[l] - y[l - 1];
  return y;
}

// First derivative of j_l or y_l. Needs l + 1 below the size.
double Slope(const std::vector<double>& f, int l, double x) {
  return l / x * f[l] - f[l + 1];
}

// Second derivative, from the differential equation.
double Curvature(const std::vector<double>& f, int l, double x) {
  return -2.0 / x * Slope(f, l, x) + (l * (l + 1.0) / (x * x) - 1.0) * f[l];
}

void CheckPositive(double value, const char* name, const char* unit) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw DataError("sphere: {} is {:g}{}, expected a positive number", name, value, unit);
}

void Check(const SphereInWater& sphere) {
  CheckPositive(sphere.radius_m, "radius", " m");
  CheckPositive(sphere.sound_speed_m_per_s, "sound speed of the water", " m/s");
  CheckPositive(sphere.water_density_kg_per_m3, "density of the water", " kg/m3");
  CheckPositive(sphere.material.longitudinal_m_per_s, "longitudinal speed", " m/s");
  CheckPositive(sphere.material.transverse_m_per_s, "transverse speed", " m/s");
  CheckPositive(sphere.material.density_kg_per_m3, "density", " kg/m3");
}

// Standard error of `level_db`, a function of the sphere, in dB.
template <typename LevelDb>
double SigmaDb(const SphereInWater& sphere, const SphereUncertainty& uncertainty, const LevelDb& level_db) {
  const double at_db = level_db(sphere);
  double variance = 0.0;
  const auto add = [&](auto&& value_of, double share) {
    for (const double sign : {-1.0, 1.0}) {
      SphereInWater moved = sphere;
      value_of(moved) *= 1.0 + sign * share;
      variance += 0.5 * std::pow(level_db(moved) - at_db, 2);
    }
  };
  add([](SphereInWater& s) -> double& { return s.material.longitudinal_m_per_s; },
      uncertainty.longitudinal_share);
  add([](SphereInWater& s) -> double& { return s.material.transverse_m_per_s; },
      uncertainty.transverse_share);
  add([](SphereInWater& s) -> double& { return s.material.density_kg_per_m3; }, uncertainty.density_share);
  add([](SphereInWater& s) -> double& { return s.sound_speed_m_per_s; },
      uncertainty.sound_speed_m_per_s / sphere.sound_speed_m_per_s);
  return std::sqrt(variance);
}

}  // namespace

const std::vector<std::pair<std::string, SphereMaterial>>& NamedSphereMaterials() {
  static const std::vector<std::pair<std::string, SphereMaterial>> kMaterials = {
      {"wc", {6853.0, 4171.0, 14900.0}}, {"steel-440c", {5950.0, 3240.0, 7650.0}}};
  return kMaterials;
}

double SphereCrossSectionM2(const SphereInWater& sphere, double frequency_hz) {
  Check(sphere);
  CheckPositive(frequency_hz, "frequency", " Hz");
  constexpr double kLargest = 2000.0;
  const double c = sphere.sound_speed_m_per_s;
  const SphereMaterial& solid = sphere.material;
  const double q = 2.0 * std::numbers::pi * frequency_hz * sphere.radius_m / c;
  if (q > kLargest)
    throw DataError("sphere: the size parameter 2 pi radius / wavelength is {:g}, expected at most {:g}", q,
                    kLargest);
  const double q1 = q * c / solid.longitudinal_m_per_s;
  const double q2 = q * c / solid.transverse_m_per_s;
  const double density = solid.density_kg_per_m3 / sphere.water_density_kg_per_m3;
  const double alpha = 2.0 * density * std::pow(solid.transverse_m_per_s / c, 2);
  const double beta = density * std::pow(solid.longitudinal_m_per_s / c, 2) - alpha;

  const int modes = static_cast<int>(std::ceil(q + 4.0 * std::cbrt(q))) + 8;
  const std::vector<double> j = BesselJ(modes + 1, q);
  const std::vector<double> y = BesselY(modes + 1, q);
  const std::vector<double> j1 = BesselJ(modes + 1, q1);
  const std::vector<double> j2 = BesselJ(modes + 1, q2);
  std::complex<double> sum = 0.0;
  for (int l = 0; l <= modes; ++l) {
    const double a2 = (l * l + l - 2.0) * j2[l] + q2 * q2 * Curvature(j2, l, q2);
    const double a1 = 2.0 * l * (l + 1.0) * (q1 * Slope(j1, l, q1) - j1[l]);
    const double b2 = a2 * q1 * q1 * (beta * j1[l] - alpha * Curvature(j1, l, q1)) -
                      a1 * alpha * (j2[l] - q2 * Slope(j2, l, q2));
    const double b1 = q * (a2 * q1 * Slope(j1, l, q1) - a1 * j2[l]);
    // tan(eta) = -above / below, so sin(eta) exp(i eta) = -above / (below + i above).
    const double above = b2 * Slope(j, l, q) - b1 * j[l];
    const double below = b2 * Slope(y, l, q) - b1 * y[l];
    if (above == 0.0 || !std::isfinite(below)) continue;  // a mode beyond the range of numbers adds nothing
    sum += (l % 2 == 0 ? 1.0 : -1.0) * (2.0 * l + 1.0) / std::complex<double>(-below / above, -1.0);
  }
  return sphere.radius_m * sphere.radius_m * std::norm(2.0 / q * sum) / 4.0;
}

double SphereTargetStrengthDb(const SphereInWater& sphere, double frequency_hz, double bandwidth_hz) {
  CheckPositive(frequency_hz, "frequency", " Hz");
  if (!(bandwidth_hz >= 0.0 && bandwidth_hz < 2.0 * frequency_hz))
    throw DataError("sphere: the bandwidth is {:g} Hz, expected 0 to below {:g} Hz", bandwidth_hz,
                    2.0 * frequency_hz);
  if (bandwidth_hz == 0.0) return DbFromPower(SphereCrossSectionM2(sphere, frequency_hz));
  // Resonances are much narrower than the ripple of waves that travel around the sphere.
  Check(sphere);
  const double ripple_hz = sphere.sound_speed_m_per_s / (2.0 * std::numbers::pi * sphere.radius_m);
  const int steps = std::max(2000, static_cast<int>(std::ceil(200.0 * bandwidth_hz / ripple_hz)));
  double power = 0.0;
  for (int i = 0; i < steps; ++i)
    power += SphereCrossSectionM2(sphere, frequency_hz + ((i + 0.5) / steps - 0.5) * bandwidth_hz);
  return DbFromPower(power / steps);
}

double SphereFrontFaceDb(const SphereInWater& sphere) {
  Check(sphere);
  const double solid = sphere.material.density_kg_per_m3 * sphere.material.longitudinal_m_per_s;
  const double water = sphere.water_density_kg_per_m3 * sphere.sound_speed_m_per_s;
  const double reflection = std::abs(solid - water) / (solid + water);
  return 2.0 * DbFromPower(0.5 * sphere.radius_m * reflection);
}

double FirstInternalEchoM(const SphereInWater& sphere) {
  Check(sphere);
  return 2.0 * sphere.radius_m * sphere.sound_speed_m_per_s / sphere.material.longitudinal_m_per_s;
}

double SphereTargetStrengthSigmaDb(const SphereInWater& sphere, double frequency_hz, double bandwidth_hz,
                                   const SphereUncertainty& uncertainty) {
  return SigmaDb(sphere, uncertainty, [&](const SphereInWater& moved) {
    return SphereTargetStrengthDb(moved, frequency_hz, bandwidth_hz);
  });
}

double SphereFrontFaceSigmaDb(const SphereInWater& sphere, const SphereUncertainty& uncertainty) {
  return SigmaDb(sphere, uncertainty, SphereFrontFaceDb);
}

}  // namespace sonarcal::sim
