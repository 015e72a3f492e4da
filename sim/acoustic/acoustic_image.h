// Acoustic model: echo power summed through the responses of beam and pulse, plus a noise floor.
//
//   P(r, b) = sum_k 10^((SL + G - 40 log10 R_k - 2 alpha R_k) / 10) sigma_m(delta_k) a_k
//                   el(phi_k) az(theta_k - theta_b) pulse(R_k - R_r) s_b 10^(TVG(r) / 10)  +  N(r, b)
//
// - sigma_m: GSAB backscatter per unit area of material m.
// - a_k = R_k^2 dOmega_k / cos(delta_k): area of the patch that a ray represents. Its cosine has the lower
//   bound kSmallestCosine (sim/physics/patch.h). The level does not depend on the number of rays.
// - el, az, pulse: responses of sim/physics/beam_pattern.h; sim/physics/beam_and_pulse.h gives their
//   cut-offs.
// - s_b: sensitivity of a beam (beam.sensitivity_db).
//
// A beam near the edge of the fan receives only what lies within the fan's azimuth margin
// (sim/rays/ray_fan.h).
//
// `SampleAcousticImage` computes one speckled sample, i.e. one ping. Each patch scatters with a random phase.
// The field is summed coherently through the same field responses (those of an aperture with their signs).
// Receiver noise is added according to how the sonar forms its beams (sim/acoustic/beam_noise.h). The power
// then goes through the display. Its mean power is P exactly. Its speckle has the correlation lengths of beam
// and pulse; this differs from the image formation of the paper's model. Noise is independent between bins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/physics/echo_power_model.h"
#include "sim/physics/fine_rows.h"
#include "sim/rays/trace.h"

namespace sonarcal::sim {

// Power that the scene's patches scatter, before beam and pulse. `range_steps` rows per range bin (4, or more
// for a pulse shorter than a bin), one column per column of the ray fan.
struct ScatterMap {
  Grid<double> power;
  int range_steps = 4;
  double pulse_m = 0.0;  // half-power length
  std::vector<double> column_azimuth_rad;

  FineRows RowsOf(const PolarAxes& axes) const { return {axes, range_steps, pulse_m}; }

  // Adds the power of an echo that covers `depth_m` of range.
  void Add(const FineRows& rows, double range_m, double depth_m, int col, double echo) {
    rows.Spread(range_m, depth_m, echo, [&](int row, double part) { power(row, col) += part; });
  }
};

// Power through the pulse, in single precision: range_bins x columns of the ray fan.
struct PulsedMap {
  Grid<float> power;
  std::vector<double> column_azimuth_rad;
};

// Time-varying gain of each range bin, a factor on power.
std::vector<double> GainByBin(const AcousticGeometry& geometry, const ParameterSet& parameters);

// N(r, b), time-varying gain included. Throws DataError if a taper does not fit the beams.
Grid<double> NoiseFloorPower(const AcousticGeometry& geometry, const ParameterSet& parameters);

// Returns a zero-filled map with columns at these azimuths, or with those of `fan`.
ScatterMap EmptyScatterMap(std::vector<double> column_azimuth_rad, const AcousticGeometry& geometry,
                           const ParameterSet& parameters);
ScatterMap EmptyScatterMap(const RayFan& fan, const AcousticGeometry& geometry,
                           const ParameterSet& parameters);

// Azimuths of the columns of a fan.
std::vector<double> ColumnAzimuthsRad(const RayFan& fan);

ScatterMap MakeScatterMap(const EchoList& echoes, const RayFan& fan, const AcousticGeometry& geometry,
                          const ParameterSet& parameters);

// Power of a ScatterMap through the pulse: range_bins x columns of the ray fan.
Grid<double> ThroughPulse(const ScatterMap& scatter, const AcousticGeometry& geometry,
                          const ParameterSet& parameters);

// Mean power of the echoes, range_bins x beams: P without N, time-varying gain included.
Grid<double> EchoPowerImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                            const ParameterSet& parameters);

// Adds N(r, b) to a mean power, range_bins x beams. Throws DataError if a taper does not fit the beams.
void AddNoiseFloor(const AcousticGeometry& geometry, const ParameterSet& parameters, Grid<double>& power);

// Converts a power per pixel into an image with Quantity::kPower.
PolarImage PowerImage(const PolarAxes& axes, const Grid<double>& power);

// P(r, b), range_bins x beams; Quantity::kPower.
PolarImage ExpectedPower(const ScatterMap& scatter, const AcousticGeometry& geometry,
                         const ParameterSet& parameters);

// Expected display value: the mean over speckle about P, through the display law and its clipping, not
// rounded (sim/physics/speckle.h). For a logarithmic display far from both clips this is 10 log10 P +
// MeanLogSpeckleDb(looks).
PolarImage ExpectedDisplay(const PolarImage& power, const ParameterSet& parameters, double full_scale);

// Display of `power` without speckle, not rounded.
PolarImage DisplayPower(const PolarImage& power, const ParameterSet& parameters, double full_scale);

// Random seeds of a speckled sample. Speckle is constant between frames if the scatterers' seed is constant
// and only the receiver's changes.
struct DrawSeeds {
  std::uint64_t scatterers = 1;
  std::uint64_t receiver = 1;
};

// Seeds of a ping of a frame: the scatterers of the frame, and receiver noise of its own.
inline DrawSeeds SeedsOfPing(const DrawSeeds& of_frame, std::size_t ping) {
  return {of_frame.scatterers, of_frame.receiver + 0x9E3779B97F4A7C15U * ping};
}

// Wavenumber 2 pi f / c, 1/m. An unknown sound speed is taken as 1500 m/s.
inline double Wavenumber(const SonarModel& sonar) {
  constexpr double kUsualMPerS = 1500.0;
  const double c = sonar.sound_speed_m_per_s > 0.0 ? sonar.sound_speed_m_per_s : kUsualMPerS;
  return 2.0 * std::numbers::pi * sonar.frequency_hz / c;
}

// One speckled sample through the display, not rounded. `drawn_from_sonar`: pose of the sonar in the axes for
// which the scatterers are drawn. Scatterers stay where they are in the world, so speckle moves and
// decorrelates with the sonar as geometry says. They are taken to lie in the plane of zero elevation. The
// identity draws them for the sonar itself. The same seeds give the same image on any number of
// threads. A number of looks that is not whole is a weighted mean: its variance is 1 / L, its mean level up
// to 0.24 dB above that of a Gamma distribution. Throws DataError for fewer than one look.
PolarImage SampleAcousticImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                               const ParameterSet& parameters, double full_scale, const DrawSeeds& seeds,
                               const Pose& drawn_from_sonar = {});

// Uses one seed for both.
inline PolarImage SampleAcousticImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                                      const ParameterSet& parameters, double full_scale, std::uint64_t seed) {
  return SampleAcousticImage(scatter, geometry, parameters, full_scale, DrawSeeds{seed, seed});
}

}  // namespace sonarcal::sim
