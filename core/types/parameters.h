// Physical parameters that a fit may change, as plain values. sim/physics holds their formulas,
// data_io/parameters/parameters_io.h their JSON form. Names in comments are those of `fit.json`.
#pragma once

#include <cstddef>
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
inline constexpr int kGsabMembers = 6;

// Max number of materials in a file of parameters, of named materials or of a scene.
inline constexpr std::size_t kMaxMaterials = 4096;

struct MaterialParameters {
  GsabParameters<double> gsab;
  std::string prior = {};  // name of a material (core/materials/named_materials.h); empty: none

  bool operator==(const MaterialParameters&) const = default;
};

// Law that converts received power P to a grey value v, 0..1 of full scale before clipping; evaluated by
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

// Levels displayed as 0 and as full scale, and the law between them.
template <typename T>
struct DisplayParameters {
  T db_min = T(0.0);
  T db_max = T(255.0);
  DisplayLaw law = DisplayLaw::kLog;
  double soft_db = 0.0;   // soft laws: level added to soften the logarithm
  double exponent = 1.0;  // kPower: exponent of the amplitude

  bool operator==(const DisplayParameters&) const = default;
};

// Growth of the range and azimuth errors with range (Park 2024 Eqs. 27-28 lost their roots in print).
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

// Time-varying gain: added by the receiver to the level of an echo, and of the noise, from range r.
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
// The first comes in through the array (reverberation of the water, noise before the gain). It varies with
// range and has the taper of the transmitted beams. The second comes from the electronics behind the gain and
// has neither property. Pings of a DIDSON without a target show both, each with its own taper.
struct ReceiverParameters {
  double gain_db = 0.0;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  std::optional<double> noise_db = {};                 // floor at range 0, before TVG; absent = no such noise
  double noise_slope_db_per_m = 0.0;                   // trend with range that the TVG does not explain
  std::vector<double> noise_taper_db = {};             // per beam; empty = 0 everywhere
  std::optional<double> noise_after_gain_db = {};      // floor added behind the TVG; absent = none
  std::vector<double> noise_after_gain_taper_db = {};  // per beam; empty = 0 everywhere
  double looks = 1.0;          // independent looks averaged in a pixel (1: exponential power)
  double diffuse_share = 0.0;  // share of the mean power without texture; no effect from one look on

  bool operator==(const ReceiverParameters&) const = default;
};

// Shape of a beam in azimuth; evaluated by sim/physics/beam_pattern.h.
enum class AzimuthPattern {
  kGaussian,  // main lobe only
  kAperture,  // line array shaded by (1 - taper) + taper cos^2: main lobe and side lobes
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
  kAperture,  // line aperture shaded by (1 - taper) + taper cos^2, on transmit and on receive
  kCosine,    // line aperture shaded by a cosine, on transmit and on receive
};
constexpr auto WordsOf(std::type_identity<ElevationPattern>) {
  return Words<ElevationPattern, 3>{{{"gaussian", ElevationPattern::kGaussian},
                                     {"aperture", ElevationPattern::kAperture},
                                     {"cosine", ElevationPattern::kCosine}}};
}

// Lobes of the elevation pattern through which mirrors are seen. Physically they are those of direct echoes.
// Some simulations end their mirror legs at the end of the main lobe (docs/studies/ghosts.md).
enum class MirrorLobes { kAll, kMain };
constexpr auto WordsOf(std::type_identity<MirrorLobes>) {
  return Words<MirrorLobes, 2>{{{"all", MirrorLobes::kAll}, {"main", MirrorLobes::kMain}}};
}

// Half-power widths of the beam, two-way; 0 = the sonar's own. By default a beam has side lobes; without them
// it does not see objects right below the sonar.
struct BeamParameters {
  double azimuth_width_deg = 0.0;
  double elevation_width_deg = 0.0;
  AzimuthPattern azimuth_pattern = AzimuthPattern::kAperture;
  double azimuth_taper = 1.0;  // kAperture: 0 uniform (side lobes -13 dB) .. 1 Hann (-31 dB)
  ElevationPattern elevation_pattern = ElevationPattern::kCosine;
  double elevation_taper = 1.0;  // kAperture: 0 uniform .. 1 Hann
  std::vector<double> azimuth_table_db =
      {};  // kTable: power response at -n..n beams off axis, 2 n + 1 values
  // Sound sent outside the field of view, which comes back by mirrors only. Uniform up to `transmit_even_deg`
  // off the axis, then falling as a cosine (of pressure) to zero at `transmit_end_deg`. If both are 0, the
  // limit is the fan of rays cast for the beams.
  double transmit_even_deg = 0.0;
  double transmit_end_deg = 0.0;
  MirrorLobes mirror_lobes = MirrorLobes::kAll;
  // Sensitivity to echoes per beam, dB of power, as noise_taper_db for noise; empty = 0 everywhere.
  std::vector<double> sensitivity_db = {};

  bool operator==(const BeamParameters&) const = default;
};

// Range response: half-power length of the pulse; 0 = one range bin.
struct PulseParameters {
  double length_m = 0.0;

  bool operator==(const PulseParameters&) const = default;
};

// Material that scatters and also reflects like a mirror; sim/ghosts/ghost_trace.h traces its paths. Acoustic
// and coherent models.
struct MirrorParameters {
  double loss_db = 0.0;  // loss of one reflection in dB at any angle: -20 log10 |R|, R in pressure

  bool operator==(const MirrorParameters&) const = default;
};

enum class EchoModel {
  kPaper,     // Park 2024: levels summed over rays
  kAcoustic,  // power summed over patches; expected image or speckled sample
  kCoherent,  // fields of point scatterers: the slow reference
};
constexpr auto WordsOf(std::type_identity<EchoModel>) {
  return Words<EchoModel, 3>{
      {{"paper", EchoModel::kPaper}, {"acoustic", EchoModel::kAcoustic}, {"coherent", EchoModel::kCoherent}}};
}

struct ParameterSet {
  EchoModel model = EchoModel::kPaper;
  double source_level_db = 200.0;
  // Standard error of source level plus gain, once a standard target has measured it. Backscatter curves are
  // then absolute. Absent: they hold relative to source level plus gain.
  std::optional<double> source_level_sigma_db = {};
  double noise_level_db = 0.0;  // NL of Park 2024 Eq. (10), paper model only
  double array_gain_db = 0.0;   // AG of Park 2024 Eq. (10), paper model only
  DisplayParameters<double> display;
  std::map<std::string, MaterialParameters> materials;  // "default" applies to absent names
  std::map<std::string, MirrorParameters> mirrors;      // by material; absent materials do not reflect
  JitterParameters<double> jitter;
  ReceiverParameters receiver;
  BeamParameters beam;
  PulseParameters pulse;
  std::optional<Water> water;  // overrides the recording's, with a message

  // Parameters of a scene's material, or those of "default". Throws DataError if neither is given.
  const MaterialParameters& Material(const std::string& name) const;

  bool operator==(const ParameterSet&) const = default;
};

}  // namespace sonarcal
