// Responses of a sonar's beam and pulse, for every image model except the paper's. Completes widths from the
// sonar, and samples responses at the positions where echoes are kept, as weights of power or of field.
//
// Cut-off levels: Gaussian responses in range and azimuth at -108 dB or below; side lobes of an aperture at
// -60 dB, which loses 1.4e-6 of the energy at taper 1 and 3.2e-4 (0.0014 dB) at taper 0; none for a table.
#pragma once

#include <cstddef>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::sim {

// Parameters with values of beam and pulse that are 0 replaced by the sonar's. Throws DataError if the
// azimuth width is unknown and there is no table.
ParameterSet WithResponse(const SonarModel& sonar, const ParameterSet& parameters);

// Azimuth response of a sonar's beams. It refers to tables of both arguments, which must outlive it. Throws
// DataError if the width is unknown, the taper is not 0..1, or the table's size is not odd.
AzimuthShape<double> AzimuthShapeOf(const SonarModel& sonar, const ParameterSet& parameters);

// Half-power width in elevation: the beam's, or the sonar's if that is 0.
double ElevationWidthDeg(const SonarModel& sonar, const BeamParameters& beam);

ElevationResponse ElevationResponseOf(const SonarModel& sonar, const BeamParameters& beam);

// Half-power length of the pulse: the parameters', or a range bin if that is 0.
double PulseLengthM(const SonarModel& sonar, const ParameterSet& parameters);

// Fine rows per range bin: at least 4, and at least 4 per pulse. Sharing an echo between two rows then
// changes no pixel by more than 4.3 % of its peak (the pulse's curvature over a quarter of its length).
// Pulses shorter than a sixteenth of a bin fall between the rows, as they fall between the bins.
int RangeStepsFor(const SonarModel& sonar, const ParameterSet& parameters);

// Sensitivity of each beam to echoes, a factor on power (beam.sensitivity_db); all 1 if none is given. Throws
// DataError if the number of values differs from the number of beams.
std::vector<double> BeamSensitivity(const SonarModel& sonar, const BeamParameters& beam);

// Weights of a response at consecutive samples within its reach.
struct ResponseWindow {
  int first = 0;
  std::vector<double> weight;
};

// kPowerSlope: change of the response of power while the echo moves, per radian to the right or per metre
// away.
enum class ResponseOf { kPower, kField, kPowerSlope };

// Max number of weights of all beams together: 0.8 GB. 1000 beams with 4 columns each have at most 4 million.
inline constexpr std::size_t kMaxBeamWeights = 100'000'000;

// Response of each beam, its sensitivity included, to echoes in columns at these ascending azimuths. Throws
// DataError if that takes more than kMaxBeamWeights.
std::vector<ResponseWindow> AzimuthWindows(const SonarModel& sonar, const ParameterSet& parameters,
                                           const std::vector<double>& column_azimuth_rad, ResponseOf of);

// Response of a range bin's centre to the fine rows; `first` is relative to the bin's own first row.
ResponseWindow PulseWindow(const SonarModel& sonar, const ParameterSet& parameters, int range_steps,
                           ResponseOf of);

}  // namespace sonarcal::sim
