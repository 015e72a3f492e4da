// What a sonar's beam and pulse make of echoes, for every model of this directory but the paper's: widths
// completed from the sonar, and responses sampled where echoes are kept, as weights of power or of field.
//
// Where they are cut: range and Gaussian azimuth responses at -108 dB or below; the side lobes of an aperture
// at -60 dB, which loses 1.4e-6 of the energy at taper 1, 3.2e-4 (0.0014 dB) at taper 0; a table not at all.
#pragma once

#include <vector>

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::sim {

// The parameters with beam and pulse as they are: those that are 0 taken from the sonar. Throws DataError
// where the azimuth width is unknown and no table stands for it.
ParameterSet WithResponse(const SonarModel& sonar, const ParameterSet& parameters);

// The azimuth response of a sonar's beams; refers to tables of both arguments, which must outlive it. Throws
// DataError where the width is unknown, the taper is not 0..1 or the table is not odd.
AzimuthShape<double> AzimuthShapeOf(const SonarModel& sonar, const ParameterSet& parameters);

// Half-power width in elevation: the beam's, the sonar's where that is 0.
double ElevationWidthDeg(const SonarModel& sonar, const BeamParameters& beam);

ElevationResponse ElevationResponseOf(const SonarModel& sonar, const BeamParameters& beam);

// Half-power length of the pulse: the parameters', a range bin where it is 0.
double PulseLengthM(const SonarModel& sonar, const ParameterSet& parameters);

// Fine rows a range bin: at least 4, and at least 4 a pulse, so that sharing an echo between two of them
// moves no pixel by more than 4.3 % of its peak (the pulse's curvature over a quarter of its length). Pulses
// below a sixteenth of a bin fall between the rows, as they fall between the bins.
int RangeStepsFor(const SonarModel& sonar, const ParameterSet& parameters);

// Sensitivity of each beam to echoes, a factor on power (beam.sensitivity_db); ones where none is given.
// Throws DataError where it does not fit the beams.
std::vector<double> BeamSensitivity(const SonarModel& sonar, const BeamParameters& beam);

// Weights of a response at consecutive samples, those within reach only.
struct ResponseWindow {
  int first = 0;
  std::vector<double> weight;
};

enum class ResponseOf { kPower, kField };

// Response of each beam, its sensitivity included, to columns of echoes at these azimuths.
std::vector<ResponseWindow> AzimuthWindows(const SonarModel& sonar, const ParameterSet& parameters,
                                           const std::vector<double>& column_azimuth_rad, ResponseOf of);

// Of a range bin's centre to the fine rows; `first` is relative to the bin's own first row.
ResponseWindow PulseWindow(const SonarModel& sonar, const ParameterSet& parameters, int range_steps,
                           ResponseOf of);

}  // namespace sonarcal::sim
