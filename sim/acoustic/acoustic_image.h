// The acoustic model: power summed over echoes, through the responses of beam and pulse, over a noise floor.
//
//   P(r, b) = sum_k 10^((SL + G - 40 log10 R_k - 2 alpha R_k) / 10) sigma_m(delta_k) a_k
//                   el(phi_k) az(theta_k - theta_b) pulse(R_k - R_r) s_b 10^(TVG(r) / 10)  +  N(r, b)
//
// sigma_m is GSAB as backscatter per unit area; a_k = R_k^2 dOmega_k / cos(delta_k) is the patch a ray stands
// for (its cosine bounded at kSmallestCosine, sim/physics/patch.h), so the level does not depend on the
// number of rays. The responses are those of sim/physics/beam_pattern.h; s_b is the sensitivity of a beam
// (beam.sensitivity_db).
//
// Where they are cut stands in sim/physics/beam_and_pulse.h. A beam near the edge of the fan sees what the
// fan's azimuth margin (sim/rays/ray_fan.h) shows it, and no more.
//
// `SampleAcousticImage` draws one ping: each patch scatters with a random phase, the field is summed
// coherently through the same field responses (an aperture's with their signs), receiver noise is added as
// the sonar forms its beams (sim/acoustic/beam_noise.h), and the power goes through the display. Its mean
// power is P exactly, its speckle has the correlation lengths of beam and pulse, and it is not the image
// formation the paper model fits. Noise is independent from bin to bin.
#pragma once

#include <cstdint>

#include "core/types/parameters.h"
#include "sim/rays/trace.h"

namespace sonarcal::sim {

// Power that the scene's patches scatter, before beam and pulse: `range_steps` rows a range bin (4, or more
// for a pulse shorter than a bin), one column for each column of the ray fan.
struct ScatterMap {
  Grid<double> power;
  int range_steps = 4;
  std::vector<double> column_azimuth_rad;

  // Where the rows are.
  struct Rows {
    double first_m = 0.0;  // middle of row 0
    double per_m = 1.0;
  };
  Rows RowsOf(const PolarAxes& axes) const {
    const double per_m = range_steps / axes.range_bin_m();
    return {axes.range_min_m + 0.5 / per_m, per_m};
  }

  // What a patch within the window scatters, shared between the two nearest rows, so that the image changes
  // smoothly with range.
  void Add(const Rows& rows, double range_m, int col, double of_patch) {
    const double position = (range_m - rows.first_m) * rows.per_m;  // not below -1/2
    const int row = static_cast<int>(position + 1.0) - 1;
    const double fraction = position - row;
    if (row >= 0 && row < power.rows()) power(row, col) += (1.0 - fraction) * of_patch;
    if (row + 1 < power.rows()) power(row + 1, col) += fraction * of_patch;
  }
};

struct AcousticGeometry {
  const SonarModel& sonar;
  double absorption_db_per_m = 0.0;
};

// Time-varied gain of each range bin, a factor on power.
std::vector<double> GainByBin(const AcousticGeometry& geometry, const ParameterSet& parameters);

// N(r, b), time-varied gain included. Throws DataError where a taper does not fit the beams.
Grid<double> NoiseFloorPower(const AcousticGeometry& geometry, const ParameterSet& parameters);

// Of nothing yet, with the rows and columns of a fan.
ScatterMap EmptyScatterMap(const RayFan& fan, const AcousticGeometry& geometry,
                           const ParameterSet& parameters);

ScatterMap MakeScatterMap(const EchoList& echoes, const RayFan& fan, const AcousticGeometry& geometry,
                          const ParameterSet& parameters);

// Mean power of the echoes, range_bins x beams: P without N, time-varied gain included.
Grid<double> EchoPowerImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                            const ParameterSet& parameters);

// Adds N(r, b) to a mean power, range_bins x beams. Throws DataError where a taper does not fit the beams.
void AddNoiseFloor(const AcousticGeometry& geometry, const ParameterSet& parameters, Grid<double>& power);

// A power per pixel as an image; Quantity::kPower.
PolarImage PowerImage(const PolarAxes& axes, const Grid<double>& power);

// P(r, b), range_bins x beams; Quantity::kPower.
PolarImage ExpectedPower(const ScatterMap& scatter, const AcousticGeometry& geometry,
                         const ParameterSet& parameters);

// The mean displayed value where speckle varies about P, through the display law and its clipping, not
// rounded (sim/physics/speckle.h): for a logarithm far from both clips 10 log10 P + MeanLogSpeckleDb(looks).
PolarImage ExpectedDisplay(const PolarImage& power, const ParameterSet& parameters, double full_scale);

// Power through the display as it is, not rounded.
PolarImage DisplayPower(const PolarImage& power, const ParameterSet& parameters, double full_scale);

// What a draw's random numbers come from. A static scene keeps its speckle from frame to frame where the
// scatterers' seed stays the same and the receiver's changes.
struct DrawSeeds {
  std::uint64_t scatterers = 1;
  std::uint64_t receiver = 1;
};

// One draw, through the display, not rounded. The same seed gives the same image on any number of threads.
// Throws DataError for fewer than one look. Looks that are not whole are a weighted mean: its variance is 1 /
// L, its mean level up to 0.24 dB above that of a Gamma law.
PolarImage SampleAcousticImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                               const ParameterSet& parameters, double full_scale, const DrawSeeds& seeds);

// Both from one seed.
inline PolarImage SampleAcousticImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                                      const ParameterSet& parameters, double full_scale, std::uint64_t seed) {
  return SampleAcousticImage(scatter, geometry, parameters, full_scale, DrawSeeds{seed, seed});
}

}  // namespace sonarcal::sim
