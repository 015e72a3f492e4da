// Law of other simulators in place of a backscatter curve: one number per material, and a fixed power of the
// cosine of the incidence angle,
//
//   sigma(delta) = k cos(delta)^n
//
// (n = 2 is Lambert's law, used by DAVE; Stonefish and OceanSim use n = 1).
#pragma once

#include "core/types/parameters.h"

namespace sonarcal::exporting {

struct CosineLaw {
  double coefficient = 0.0;  // k, a power ratio
  double exponent = 1.0;     // n
  double worst_db = 0.0;     // largest difference between the levels of the two curves
};

// Largest incidence angle of the comparison. Beyond it, both curves fall towards nothing.
inline constexpr double kCosineLawMaxDeg = 75.0;

// Finds k so that the levels of the two curves, in dB, have a mean difference of 0 over incidence 0 ..
// kCosineLawMaxDeg, with equal weight per degree. Exact (worst_db = 0) if A = E = 0 and D = n.
CosineLaw FitCosineLaw(const GsabParameters<double>& gsab, double exponent);

}  // namespace sonarcal::exporting
