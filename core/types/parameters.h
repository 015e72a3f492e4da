// The physical parameters that a fit may change, as plain values. Their formulas live in sim/physics, their
// JSON form in data_io/parameters/parameters_io.h. Names in comments are those of `fit.json`.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/types/sonar_model.h"
#include "core/types/words.h"

namespace sonarcal {

// Generic Seafloor Acoustic Backscatter model, Park 2024 Eq. (19) and Table 3; evaluated by
// sim/physics/gsab.h. Default values: the paper's Table 4.
template <typename T>
struct GsabParameters {
  T a = T(90.0);     // specular amplitude, power ratio
  T b_deg = T(4.0);  // half-width of the specular peak
  T c = T(100.0);    // level at oblique incidence, power ratio
  T d = T(1.0);      // exponent of the cosine: 1 Lommel-Seeliger, 2 Lambert
  T e = T(90.0);     // transitional amplitude, power ratio
  T f_deg = T(8.0);  // half-width of the transition

  bool operator==(const GsabParameters&) const = default;
};

struct MaterialParameters {
  GsabParameters<double> gsab;

  bool operator==(const MaterialParameters&) const = default;
};

// How received power P becomes a grey value v, 0..1 of full scale before clipping; evaluated by
// sim/physics/display.h.
enum class DisplayLaw {
  kLog,            // v = (10 log10 P - db_min) / (db_max - db_min)
  kSoftLog,        // v = (10 log10(P + 10^(soft_db / 10)) - db_min) / (db_max - db_min)
  kSoftAmplitude,  // v = (20 log10(sqrt(P) + 10^(soft_db / 20)) - db_min) / (db_max - db_min)
  kPower,          // v = (P / 10^(db_max / 10))^(exponent / 2)
};
constexpr auto WordsOf(std::type_identity<DisplayLaw>) {
  return Words<DisplayLaw, 4>{{{"log", DisplayLaw::kLog},
                               {"soft_log", DisplayLaw::kSoftLog},
                               {"soft_amplitude", DisplayLaw::kSoftAmplitude},
                               {"power", DisplayLaw::kPower}}};
}

// Levels shown as 0 and as full scale, and the law between them.
template <typename T>
struct DisplayParameters {
  T db_min = T(0.0);
  T db_max = T(255.0);
  DisplayLaw law = DisplayLaw::kLog;
  double soft_db = 0.0;   // soft laws: level that a logarithm is softened with
  double exponent = 1.0;  // kPower: of the amplitude

  bool operator==(const DisplayParameters&) const = default;
};

// How the range and azimuth errors grow with range (Park 2024 Eqs. 27-28 lost their roots in print).
enum class JitterGrowth {
  kRoot,    // sigma0 sqrt(1 + R^2/R0^2)
  kLinear,  // sigma0 (1 + R^2/R0^2)
};
constexpr auto WordsOf(std::type_identity<JitterGrowth>) {
  return Words<JitterGrowth, 2>{{{"root", JitterGrowth::kRoot}, {"linear", JitterGrowth::kLinear}}};
}

// Range and azimuth errors of a ray, Park 2024 Section 3.4; evaluated by sim/physics/jitter.h.
template <typename T>
struct JitterParameters {
  T sigma_range_m = T(0.0);               // at the reference frequency, at short range
  T sigma_azimuth_deg = T(0.0);           // likewise
  T reference_range_m = T(10.0);          // R0
  double reference_frequency_hz = 900e3;  // f0
  JitterGrowth growth = JitterGrowth::kRoot;

  bool operator==(const JitterParameters&) const = default;
};

// Time-varied gain: what the receiver adds to the level of an echo, and of the noise, from range r.
enum class TimeVariedGain {
  kNone,
  k20LogR,               // 20 log10 r
  k40LogR,               // 40 log10 r
  k40LogRAndAbsorption,  // 40 log10 r + 2 alpha r
};
constexpr auto WordsOf(std::type_identity<TimeVariedGain>) {
  return Words<TimeVariedGain, 4>{{{"none", TimeVariedGain::kNone},
                                   {"20logR", TimeVariedGain::k20LogR},
                                   {"40logR", TimeVariedGain::k40LogR},
                                   {"40logR+alpha", TimeVariedGain::k40LogRAndAbsorption}}};
}

// Receiver of the acoustic model: gain, a noise floor added in power, and speckle; evaluated by
// sim/physics/receiver.h. The floor of pixel (r, b), a power, is the sum of two:
//
//   N(r, b) = 10^((noise_db + noise_slope_db_per_m r + noise_taper_db[b] + TVG(r)) / 10)
//           + 10^((noise_after_gain_db + noise_after_gain_taper_db[b]) / 10)
//
// What comes in through the array (reverberation of the water, noise before the gain) changes with range and
// has the taper of the beams that are sent; what the electronics add behind the gain does neither.
// Target-free pings of a DIDSON show both, each with its own taper.
struct ReceiverParameters {
  double gain_db = 0.0;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  std::optional<double> noise_db = {};  // level of the floor at range 0, before TVG; absent = no such noise
  double noise_slope_db_per_m = 0.0;    // a trend with range that the TVG does not explain
  std::vector<double> noise_taper_db = {};         // by beam; empty = 0 everywhere
  std::optional<double> noise_after_gain_db = {};  // level of the floor added behind the TVG; absent = none
  std::vector<double> noise_after_gain_taper_db = {};  // by beam; empty = 0 everywhere
  double looks = 1.0;  // independent looks averaged in a pixel (1: exponential power)

  bool operator==(const ReceiverParameters&) const = default;
};

// Shape of a beam in azimuth; evaluated by sim/physics/beam_pattern.h.
enum class AzimuthPattern {
  kGaussian,  // a main lobe alone
  kAperture,  // a line array shaded by (1 - taper) + taper cos^2: main lobe and side lobes
  kTable,     // the recording's own response, by offset in beams
};
constexpr auto WordsOf(std::type_identity<AzimuthPattern>) {
  return Words<AzimuthPattern, 3>{{{"gaussian", AzimuthPattern::kGaussian},
                                   {"aperture", AzimuthPattern::kAperture},
                                   {"table", AzimuthPattern::kTable}}};
}

// Shape of a beam in elevation; evaluated by sim/physics/beam_pattern.h.
enum class ElevationPattern {
  kGaussian,
  kAperture,  // a line aperture shaded by (1 - taper) + taper cos^2, the same on transmit and on receive
  kCosine,    // the same shaded by a cosine
};
constexpr auto WordsOf(std::type_identity<ElevationPattern>) {
  return Words<ElevationPattern, 3>{{{"gaussian", ElevationPattern::kGaussian},
                                     {"aperture", ElevationPattern::kAperture},
                                     {"cosine", ElevationPattern::kCosine}}};
}

// Lobes of the elevation pattern through which mirrors are seen. Those of direct echoes, physically; some
// simulations end their mirror legs where the main lobe does (docs/studies/ghosts.md).
enum class MirrorLobes { kAll, kMain };
constexpr auto WordsOf(std::type_identity<MirrorLobes>) {
  return Words<MirrorLobes, 2>{{{"all", MirrorLobes::kAll}, {"main", MirrorLobes::kMain}}};
}

// Half-power widths of the beam, two-way; 0 = take the sonar's own. Where nobody says otherwise a beam has
// side lobes: without them, what lies right below a sonar is not there at all.
struct BeamParameters {
  double azimuth_width_deg = 0.0;
  double elevation_width_deg = 0.0;
  AzimuthPattern azimuth_pattern = AzimuthPattern::kAperture;
  double azimuth_taper = 1.0;  // kAperture: 0 uniform (side lobes -13 dB) .. 1 Hann (-31 dB)
  ElevationPattern elevation_pattern = ElevationPattern::kCosine;
  double elevation_taper = 1.0;  // kAperture: 0 uniform .. 1 Hann
  std::vector<double> azimuth_table_db =
      {};  // kTable: power response at -n..n beams off axis, 2 n + 1 values
  // What is sent beyond the field of view comes back by mirrors only: even to `transmit_even_deg` off the
  // axis, from there on falling as a cosine (of pressure) to nothing at `transmit_end_deg`. 0 and 0: as far
  // as rays are cast for the beams, and no further.
  double transmit_even_deg = 0.0;
  double transmit_end_deg = 0.0;
  MirrorLobes mirror_lobes = MirrorLobes::kAll;
  // Sensitivity to echoes by beam, dB of power, as noise_taper_db is for noise; empty = 0 everywhere.
  std::vector<double> sensitivity_db = {};

  bool operator==(const BeamParameters&) const = default;
};

// Range response: half-power length of the pulse; 0 = one range bin.
struct PulseParameters {
  double length_m = 0.0;

  bool operator==(const PulseParameters&) const = default;
};

// A material that reflects like a mirror, besides scattering; its paths are found by
// sim/ghosts/ghost_trace.h. Acoustic and coherent models.
struct MirrorParameters {
  double loss_db = 0.0;  // of one reflection, in power and so in pressure: -20 log10 |R|, at any angle

  bool operator==(const MirrorParameters&) const = default;
};

enum class EchoModel {
  kPaper,     // Park 2024: levels summed over rays
  kAcoustic,  // power summed over patches, expected or with speckle
  kCoherent,  // fields of point scatterers: the slow reference
};
constexpr auto WordsOf(std::type_identity<EchoModel>) {
  return Words<EchoModel, 3>{
      {{"paper", EchoModel::kPaper}, {"acoustic", EchoModel::kAcoustic}, {"coherent", EchoModel::kCoherent}}};
}

struct ParameterSet {
  EchoModel model = EchoModel::kPaper;
  double source_level_db = 200.0;
  double noise_level_db = 0.0;  // NL of Park 2024 Eq. (10), paper model only
  double array_gain_db = 0.0;   // AG of Park 2024 Eq. (10), paper model only
  DisplayParameters<double> display;
  std::map<std::string, MaterialParameters> materials;  // "default" serves names that are absent
  std::map<std::string, MirrorParameters> mirrors;      // by material; those absent reflect nothing
  JitterParameters<double> jitter;
  ReceiverParameters receiver;
  BeamParameters beam;
  PulseParameters pulse;
  std::optional<Water> water;  // wins over the recording's, and that is said

  // The parameters of a scene's material, or those of "default"; throws DataError where neither is given.
  const MaterialParameters& Material(const std::string& name) const;

  bool operator==(const ParameterSet&) const = default;
};

}  // namespace sonarcal
