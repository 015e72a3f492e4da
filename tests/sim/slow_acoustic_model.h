// The acoustic model's closed forms as they are written down, and parameters that allow them: for the tests
// of sim/, which hold the library to them.
#pragma once

#include <cmath>

#include "core/types/parameters.h"
#include "core/types/units.h"

namespace sonarcal::testing {

// Gaussian in azimuth and elevation, with a gain. `b_deg` is the half-width of the specular peak.
inline ParameterSet ClosedFormParameters(double b_deg) {
  ParameterSet p;
  p.model = EchoModel::kAcoustic;
  p.source_level_db = 180.0;
  p.receiver.gain_db = 5.0;
  p.materials["default"].gsab = {.a = 0.16, .b_deg = b_deg, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
  p.beam.azimuth_pattern = AzimuthPattern::kGaussian;
  p.beam.elevation_pattern = ElevationPattern::kGaussian;
  return p;
}

// Backscatter between two directions (sim/physics/gsab.h, GsabBetweenPower): of one, its cosine twice and its
// incidence for the tilt.
inline double SlowSigma(const GsabParameters<double>& g, double cosine, double other_cosine,
                        double tilt_rad) {
  const double tilt = tilt_rad * 180.0 / kPi;
  return g.a * std::exp(-tilt * tilt / (2.0 * g.b_deg * g.b_deg)) +
         g.c * std::pow(cosine, 0.5 * g.d) * std::pow(other_cosine, 0.5 * g.d) +
         g.e * std::exp(-tilt * tilt / (2.0 * g.f_deg * g.f_deg));
}

// In power, by the full width at half power.
inline double SlowResponse(double x, double width) {
  return std::pow(0.5, 4.0 * x * x / (width * width));
}

}  // namespace sonarcal::testing
