// What other simulators have in place of a backscatter curve: one number a material, and a fixed power of the
// cosine of the incidence angle,
//
//   sigma(delta) = k cos(delta)^n
//
// (n = 2 is Lambert's law, which DAVE has; Stonefish and OceanSim have n = 1).
#pragma once

#include "core/types/parameters.h"

namespace sonarcal::exporting {

struct CosineLaw {
  double coefficient = 0.0;  // k, a power ratio
  double exponent = 1.0;     // n
  double worst_db = 0.0;     // largest difference of the two curves' levels over the angles compared
};

// Angles of incidence that are compared: beyond, either curve falls towards nothing.
inline constexpr double kCosineLawMostDeg = 75.0;

// k so that the levels of the two curves, in dB, differ by 0 in the mean over incidence 0 ..
// kCosineLawMostDeg, every degree alike. Exact (worst_db = 0) where A = E = 0 and D = n.
CosineLaw FitCosineLaw(const GsabParameters<double>& gsab, double exponent);

}  // namespace sonarcal::exporting
