#include "sim/rays/acoustic_fan.h"

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"

namespace sonarcal::sim {
namespace {

constexpr double kGaussianWidths = 4.0;  // elevation beam widths, if there are no side lobes
constexpr double kMaxElevationDeg = 176.0;
constexpr double kRowDeg = 0.107;  // mean row height; with crowding, a sixth of it at the horizon
constexpr double kCrowding = 6.0;
// Azimuth margin in beam widths. It holds the main lobe of every pattern, and the side lobes above -35 dB of
// a Hann-shaded array.
constexpr double kMarginWidths = 3.0;
constexpr double kMaxMarginDeg = 20.0;
constexpr double kColumnsPerWidth = 4.0;
constexpr int kMinColumnsPerBeam = 4;
constexpr int kMaxColumnsPerBeam = 8;

}  // namespace

RayFanOptions AcousticFanOptions(const SonarModel& sonar, const ParameterSet& parameters) {
  const ParameterSet complete = WithResponse(sonar, parameters);
  const BeamParameters& beam = complete.beam;
  if (beam.elevation_pattern == ElevationPattern::kGaussian && !(beam.elevation_width_deg > 0.0)) {
    throw DataError("{}: elevation beam width unknown; give it in the sonar or as beam.elevation_width_deg",
                    sonar.name);
  }
  const double spacing_deg = DegFromRad(sonar.axes.beam_spacing_rad());
  const double width_deg = std::max(beam.azimuth_width_deg, 1e-3);
  const int per_beam = std::clamp(static_cast<int>(std::ceil(kColumnsPerWidth * spacing_deg / width_deg)),
                                  kMinColumnsPerBeam, kMaxColumnsPerBeam);
  const double span_deg = beam.elevation_pattern == ElevationPattern::kGaussian
                              ? std::min(kGaussianWidths * beam.elevation_width_deg, kMaxElevationDeg)
                              : kMaxElevationDeg;
  return {.sampling = Sampling::kBeams,
          .cols = per_beam * sonar.axes.beam_count(),
          .rows = static_cast<int>(std::ceil(span_deg / kRowDeg)),
          .elevation_span_deg = span_deg,
          .azimuth_margin_deg = std::min(kMarginWidths * beam.azimuth_width_deg, kMaxMarginDeg),
          .row_crowding = kCrowding,
          .stagger = true,
          .stagger_rows = true};
}

}  // namespace sonarcal::sim
