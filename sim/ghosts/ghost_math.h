// Vectorised power of multipath echoes, in single precision. The formulas are those of GhostPower::OneWay;
// tests compare the two. The source is compiled in two versions (core/math/vector_versions.h).
#pragma once

namespace sonarcal::sim::ghost_math {

// Values of a few echoes.
struct Echoes {
  static constexpr int kMax = 64;

  float weight[kMax];           // solid angle, sr, times the factors of all reflections
  float elevation_power[kMax];  // product of the elevation responses of both legs
  float length_m[kMax];         // of both legs together
  float back_spreading_m[kMax];
  float incidence_rad[kMax];
  float other_incidence_rad[kMax];
  float tilt_rad[kMax];
  // Curve of the patch: power ratios of its terms, 1 / 2 B^2 and 1 / 2 F^2 per square radian, and D / 2.
  float a[kMax];
  float per_b[kMax];
  float c[kMax];
  float half_d[kMax];
  float e[kMax];
  float per_f[kMax];
};

// Power of each echo for SL + G = 0 dB. `loss_per_m`: absorption in one direction, nepers of power per metre.
void Powers(const Echoes& echoes, float loss_per_m, int count, float* power);

}  // namespace sonarcal::sim::ghost_math
