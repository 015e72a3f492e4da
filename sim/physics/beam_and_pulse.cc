#include "sim/physics/beam_and_pulse.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

constexpr double kPulseReachInLengths = 3.0;  // 2^-36, about -108 dB
constexpr double kGaussianCutDb = -108.0;
constexpr double kSideLobeCutDb = -60.0;
constexpr double kMinRangeSteps = 4.0;
constexpr double kMaxRangeSteps = 64.0;

// Half the step of the differences that give slopes, as a fraction of the width.
constexpr double kSlopeStep = 1e-4;

// Value of a response at an offset, of the kind `of`. `power` returns its power at any offset; `width` sets
// the step of the slope.
template <typename Power, typename Field>
double Respond(ResponseOf of, double offset, double width, const Power& power, const Field& field) {
  if (of == ResponseOf::kField) return field(offset);
  if (of == ResponseOf::kPower) return power(offset);
  const double step = kSlopeStep * width;
  return (power(offset + step) - power(offset - step)) / (2.0 * step);
}

}  // namespace

ParameterSet WithResponse(const SonarModel& sonar, const ParameterSet& parameters) {
  ParameterSet complete = parameters;
  BeamParameters& beam = complete.beam;
  if (!(beam.azimuth_width_deg > 0.0)) beam.azimuth_width_deg = sonar.azimuth_beam_width_deg;
  if (!(beam.azimuth_width_deg > 0.0) && beam.azimuth_pattern != AzimuthPattern::kTable) {
    throw DataError("{}: azimuth beam width unknown; give it in the sonar or as beam.azimuth_width_deg",
                    sonar.name);
  }
  beam.elevation_width_deg = ElevationWidthDeg(sonar, beam);
  complete.pulse.length_m = PulseLengthM(sonar, parameters);
  return complete;
}

AzimuthShape<double> AzimuthShapeOf(const SonarModel& sonar, const ParameterSet& parameters) {
  const BeamParameters& beam = parameters.beam;
  AzimuthShape<double> shape{.pattern = beam.azimuth_pattern, .taper = beam.azimuth_taper};
  if (beam.azimuth_pattern == AzimuthPattern::kTable) {
    if (beam.azimuth_table_db.size() < 3 || beam.azimuth_table_db.size() % 2 == 0) {
      throw DataError("beam.azimuth_table_db has {} numbers, expected an odd number of them, 3 at least",
                      beam.azimuth_table_db.size());
    }
    SONARCAL_CHECK(sonar.axes.beam_count() >= 2, "{} beams", sonar.axes.beam_count());
    shape.table_db = &beam.azimuth_table_db;
    shape.beam_azimuth_rad = &sonar.axes.beam_azimuth_rad;
    shape.beam_spacing_rad = sonar.axes.beam_spacing_rad();
    return shape;
  }
  if (beam.azimuth_pattern == AzimuthPattern::kAperture) {
    for (const double azimuth_rad : sonar.axes.beam_azimuth_rad) {
      if (!(std::abs(azimuth_rad) < 0.5 * std::numbers::pi)) {
        throw DataError(
            "a beam at {:.1f} degrees, expected less than 90 degrees from the axis with beam.azimuth_pattern "
            "aperture, because a line array hears both sides alike; gaussian or table has no such limit",
            DegFromRad(azimuth_rad));
      }
    }
  }
  if (!(beam.azimuth_taper >= 0.0 && beam.azimuth_taper <= 1.0)) {
    throw DataError("beam.azimuth_taper is {}, expected 0 .. 1", beam.azimuth_taper);
  }
  shape.width_rad = RadFromDeg(WithResponse(sonar, parameters).beam.azimuth_width_deg);
  return shape;
}

double ElevationWidthDeg(const SonarModel& sonar, const BeamParameters& beam) {
  return beam.elevation_width_deg > 0.0 ? beam.elevation_width_deg : sonar.elevation_beam_width_deg;
}

ElevationResponse ElevationResponseOf(const SonarModel& sonar, const BeamParameters& beam) {
  return {beam.elevation_pattern, RadFromDeg(ElevationWidthDeg(sonar, beam)), beam.elevation_taper};
}

double PulseLengthM(const SonarModel& sonar, const ParameterSet& parameters) {
  return parameters.pulse.length_m > 0.0 ? parameters.pulse.length_m : sonar.axes.range_bin_m();
}

int RangeStepsFor(const SonarModel& sonar, const ParameterSet& parameters) {
  const double steps = std::ceil(4.0 * sonar.axes.range_bin_m() / PulseLengthM(sonar, parameters) - 1e-9);
  return static_cast<int>(std::clamp(steps, kMinRangeSteps, kMaxRangeSteps));
}

std::vector<double> BeamSensitivity(const SonarModel& sonar, const BeamParameters& beam) {
  const int beams = sonar.axes.beam_count();
  if (beam.sensitivity_db.empty()) return std::vector<double>(beams, 1.0);
  if (static_cast<int>(beam.sensitivity_db.size()) != beams) {
    throw DataError("beam.sensitivity_db has {} values, expected one for each of {} beams",
                    beam.sensitivity_db.size(), beams);
  }
  std::vector<double> power;
  for (const double level_db : beam.sensitivity_db) power.push_back(PowerFromDb(level_db));
  return power;
}

std::vector<ResponseWindow> AzimuthWindows(const SonarModel& sonar, const ParameterSet& parameters,
                                           const std::vector<double>& column_azimuth_rad, ResponseOf of) {
  const AzimuthShape<double> shape = AzimuthShapeOf(sonar, parameters);
  const AzimuthResponse<double> response(shape);
  const std::vector<double> sensitivity = BeamSensitivity(sonar, parameters.beam);
  const double cut_db = shape.pattern == AzimuthPattern::kGaussian ? kGaussianCutDb : kSideLobeCutDb;
  // The aperture's response depends on sines of azimuths, which beams share.
  const bool by_sines = shape.pattern == AzimuthPattern::kAperture && of != ResponseOf::kPowerSlope;
  std::vector<double> column_sine;
  if (by_sines) {
    for (const double azimuth_rad : column_azimuth_rad) column_sine.push_back(std::sin(azimuth_rad));
  }
  const int beams = sonar.axes.beam_count();
  std::vector<ResponseWindow> windows(beams);
  std::vector<int> end(beams);  // column behind the last of each window
  tbb::parallel_for(0, beams, [&](int beam) {
    const auto [lowest, highest] = AzimuthReachRad(response, sonar.axes.beam_azimuth_rad[beam], cut_db);
    const auto first = std::lower_bound(column_azimuth_rad.begin(), column_azimuth_rad.end(), lowest);
    const auto last = std::upper_bound(first, column_azimuth_rad.end(), highest);
    windows[beam].first = static_cast<int>(first - column_azimuth_rad.begin());
    end[beam] = static_cast<int>(last - column_azimuth_rad.begin());
  });
  std::size_t weights = 0;
  for (int beam = 0; beam < beams; ++beam) weights += end[beam] - windows[beam].first;
  if (weights > kMaxBeamWeights) {
    throw DataError(
        "{} beams receive from {} of {} columns of rays each, expected at most {} pairs of beam and "
        "column: give fewer columns with --rays, or a narrower beam",
        beams, weights / beams, column_azimuth_rad.size(), kMaxBeamWeights);
  }
  tbb::parallel_for(0, beams, [&](int beam) {
    const double centre = sonar.axes.beam_azimuth_rad[beam];
    const double factor = of == ResponseOf::kField ? std::sqrt(sensitivity[beam]) : sensitivity[beam];
    windows[beam].weight.reserve(end[beam] - windows[beam].first);
    if (by_sines) {
      const double sine = std::sin(centre);
      for (int col = windows[beam].first; col < end[beam]; ++col) {
        const double field = response.ApertureFieldAt(column_sine[col] - sine);
        windows[beam].weight.push_back(factor * (of == ResponseOf::kField ? field : field * field));
      }
      return;
    }
    const double width_rad = shape.width_rad > 0.0 ? shape.width_rad : shape.beam_spacing_rad;
    for (int col = windows[beam].first; col < end[beam]; ++col) {
      windows[beam].weight.push_back(
          factor * Respond(
                       of, column_azimuth_rad[col], width_rad,
                       [&](double azimuth_rad) { return response.Power(azimuth_rad, centre); },
                       [&](double azimuth_rad) { return response.Field(azimuth_rad, centre); }));
    }
  });
  return windows;
}

ResponseWindow PulseWindow(const SonarModel& sonar, const ParameterSet& parameters, int range_steps,
                           ResponseOf of) {
  const double length_m = PulseLengthM(sonar, parameters);
  const double step_m = sonar.axes.range_bin_m() / range_steps;
  const int reach = static_cast<int>(std::ceil(kPulseReachInLengths * length_m / step_m)) + range_steps;
  ResponseWindow window{.first = -reach, .weight = {}};
  for (int row = -reach; row <= reach + range_steps; ++row) {
    const double offset_m = (row + 0.5) * step_m - 0.5 * sonar.axes.range_bin_m();
    const auto power = [&](double at_m) { return GaussianResponse(at_m, length_m); };
    window.weight.push_back(
        Respond(of, offset_m, length_m, power, [&](double at_m) { return std::sqrt(power(at_m)); }));
  }
  return window;
}

}  // namespace sonarcal::sim
