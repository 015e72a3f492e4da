#include "sim/physics/beam_pattern.h"

#include "core/math/bisection.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

// Monotonically falling upper bound of |ApertureField| at v > 1.
double ApertureEnvelope(double v, double taper) {
  const double mean = 1.0 - 0.5 * taper;
  return ((1.0 - taper) + 0.5 * taper / (v * v - 1.0)) / (std::numbers::pi * v * mean);
}

// Value of v beyond which the field stays below `level`.
double ApertureReach(double level, double taper) {
  double low = 1.0;
  double high = 2.0;
  while (ApertureEnvelope(high, taper) > level) {
    low = high;
    high *= 2.0;
  }
  return Bisection(low, high, [&](double v) { return ApertureEnvelope(v, taper) > level; });
}

// Spacing of the beams near one beam.
double BeamSpacingRad(const AzimuthShape<double>& shape, double beam_azimuth_rad) {
  if (shape.beam_azimuth_rad == nullptr) return shape.beam_spacing_rad;
  const std::vector<double>& centres = *shape.beam_azimuth_rad;
  const auto above = std::upper_bound(centres.begin() + 1, centres.end() - 1, beam_azimuth_rad);
  return *above - *(above - 1);
}

// Integral of 10^(level / 10) over a step of 1 in which the level is linear.
double StepIntegral(double from_db, double to_db) {
  const double exponent = kNeperPerDb * (to_db - from_db);
  const double mean = std::abs(exponent) < 1e-6 ? 1.0 + 0.5 * exponent : std::expm1(exponent) / exponent;
  return PowerFromDb(from_db) * mean;
}

}  // namespace

std::pair<double, double> AzimuthReachRad(const AzimuthResponse<double>& response, double beam_azimuth_rad,
                                          double level_db) {
  const AzimuthShape<double>& shape = response.shape();
  switch (shape.pattern) {
    case AzimuthPattern::kAperture: {
      const double reach =
          ApertureReach(AmplitudeFromDb(level_db), shape.taper) / response.aperture_wavelengths();
      const double sine = std::sin(beam_azimuth_rad);
      return {std::asin(std::max(sine - reach, -1.0)), std::asin(std::min(sine + reach, 1.0))};
    }
    case AzimuthPattern::kTable: {
      const double beams = 0.5 * static_cast<double>(shape.table_db->size() - 1);
      double widest_rad = shape.beam_spacing_rad;
      if (shape.beam_azimuth_rad != nullptr) {
        const std::vector<double>& centres = *shape.beam_azimuth_rad;
        for (std::size_t i = 1; i < centres.size(); ++i) {
          widest_rad = std::max(widest_rad, centres[i] - centres[i - 1]);
        }
      }
      const double reach = beams * widest_rad * (1.0 + 1e-9);
      return {beam_azimuth_rad - reach, beam_azimuth_rad + reach};
    }
    case AzimuthPattern::kGaussian:
      break;
  }
  const double reach = 0.5 * shape.width_rad * std::sqrt(-kNeperPerDb * level_db / std::numbers::ln2);
  return {beam_azimuth_rad - reach, beam_azimuth_rad + reach};
}

double AzimuthEquivalentWidthRad(const AzimuthResponse<double>& response, double beam_azimuth_rad) {
  const AzimuthShape<double>& shape = response.shape();
  switch (shape.pattern) {
    case AzimuthPattern::kAperture:
      return ApertureEquivalentWidth(shape.taper) /
             (response.aperture_wavelengths() * std::cos(beam_azimuth_rad));
    case AzimuthPattern::kTable: {
      double beams = 0.0;
      for (std::size_t i = 1; i < shape.table_db->size(); ++i) {
        beams += StepIntegral((*shape.table_db)[i - 1], (*shape.table_db)[i]);
      }
      return beams * BeamSpacingRad(shape, beam_azimuth_rad);
    }
    case AzimuthPattern::kGaussian:
      break;
  }
  return GaussianEquivalentWidth(shape.width_rad);
}

double MainLobeEndRad(const ElevationResponse& response) {
  constexpr double kStepRad = 1e-3;
  double last = response.Power(0.0);
  for (int step = 1; step * kStepRad < 0.5 * kPi; ++step) {
    const double power = response.Power(step * kStepRad);
    if (power > last) return (step - 1) * kStepRad;
    last = power;
  }
  return 0.5 * kPi;
}

}  // namespace sonarcal::sim
