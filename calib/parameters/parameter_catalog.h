// The parameters of a fit by name: what each is called, its unit, its bounds, and where it lives.
//
// Names are those of `fit.json`: source_level_db, display.db_min, display.db_max,
// material.<name>.gsab.{A,B_deg,C,D,E,F_deg}; of the paper's model jitter.{sigma_range_m,sigma_azimuth_deg,
// reference_range_m}; of the acoustic model receiver.{gain_db,noise_db,noise_slope_db_per_m},
// beam.{azimuth_width_deg,elevation_width_deg}, pulse.length_m, where there are mirrors mirror.<name>.loss_db
// and beam.transmit_end_deg, pose.<frame>.{x_m,y_m,z_m,roll_deg,pitch_deg,
// yaw_deg}, and pose.mount.* for an offset behind every recorded pose (in the sonar's frame; none is zero).
//
// A solver does not see a value but its coordinate: the logarithm for what must stay positive, the value
// itself for the rest. `typical_step` is a change of the coordinate that would be a surprise; a parameter
// that the data leave freer than that is called unidentifiable. In a fit by likelihood it is the prior's
// sigma as well.
//
// To add a parameter: an entry in the catalog and a case in the slot of its model.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/physics/paper_echo.h"

namespace sonarcal::calib {

enum class ParameterGroup {
  kSourceLevel,
  kDisplay,
  kGsab,
  kJitter,
  kReceiver,
  kBeam,
  kPulse,
  kTransmit,
  kMirror,
  kPose,
};

// The pose entry of an offset that all frames share.
inline constexpr int kMountFrame = -1;

// What is known of a parameter beforehand: a normal law of its coordinate; of infinite sigma, nothing.
struct Prior {
  double coordinate = 0.0;
  double sigma = 1.0;
};

struct CatalogEntry {
  std::string name;
  std::string unit;
  ParameterGroup group = ParameterGroup::kSourceLevel;
  int material = -1;  // index into the scene's material names, kGsab only
  int mirror = -1;    // likewise, kMirror only
  int index = 0;      // member of its group
  int frame = -1;     // position among the fit's frames, or kMountFrame; kPose only
  double lower = 0.0;
  double upper = 0.0;
  // How far one solve may move the value: where the model is linear. No bound: nothing is known by it.
  double leash_lower = -std::numeric_limits<double>::infinity();
  double leash_upper = std::numeric_limits<double>::infinity();
  bool logarithmic = false;
  double typical_step = 1.0;
  std::optional<Prior> prior = {};

  double CoordinateFromValue(double value) const { return logarithmic ? std::log(value) : value; }

  template <typename T>
  T ValueFromCoordinate(const T& coordinate) const {
    using std::exp;
    return logarithmic ? T(exp(coordinate)) : coordinate;
  }

  // Within which a solver keeps the value.
  double solve_lower() const { return std::max(lower, leash_lower); }
  double solve_upper() const { return std::min(upper, leash_upper); }

  // How far a value lies from what was known beforehand, in sigmas of the prior; 0 where nothing was.
  double FromPrior(double value) const {
    return prior ? (CoordinateFromValue(value) - prior->coordinate) / prior->sigma : 0.0;
  }

  // d value / d coordinate.
  double ValueSlope(double value) const { return logarithmic ? value : 1.0; }
};

// One value for each entry of a catalog, in the entry's unit.
using ParameterValues = std::vector<double>;

// Every parameter of the paper model for a scene with these materials.
std::vector<CatalogEntry> BuildCatalog(const std::vector<std::string>& material_names);

// Every parameter of the acoustic model that a fit may move, for a sonar with these bins and beams and frames
// of these indices in the recording. `mirrors`: 1 for the materials that reflect, 0 for the others; empty:
// none does.
std::vector<CatalogEntry> BuildAcousticCatalog(const std::vector<std::string>& material_names,
                                               const SonarModel& sonar, const std::vector<int>& frames,
                                               const std::vector<char>& mirrors = {});

// Narrows the bounds of a curve's entry to what curves of real surfaces stay within: of widths and the
// exponent; and of amplitudes, as backscatter per unit area.
void NarrowToRealCurves(CatalogEntry& gsab_entry);

// Amplitude of a backscatter curve: A, C or E.
inline bool IsAmplitude(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kGsab && entry.index % 2 == 0;
}

// Beam, pulse and pose: what decides where an echo arrives; and how far aside is sent, which decides whether
// it does. None of them can be changed without tracing or gathering again.
inline bool IsGeometric(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kBeam || entry.group == ParameterGroup::kPulse ||
         entry.group == ParameterGroup::kTransmit || entry.group == ParameterGroup::kPose;
}

// The place of a parameter of the acoustic model, but for poses. Materials and mirrors must have entries of
// their own, and the receiver a noise level.
double& AcousticSlot(ParameterSet& parameters, const std::vector<std::string>& material_names,
                     const CatalogEntry& entry);

// The place of a parameter.
template <typename T>
T& PaperSlot(sim::PaperParameters<T>& p, const CatalogEntry& entry) {
  switch (entry.group) {
    case ParameterGroup::kSourceLevel:
      return p.source_level_db;
    case ParameterGroup::kDisplay:
      return entry.index == 0 ? p.display.db_min : p.display.db_max;
    case ParameterGroup::kGsab: {
      GsabParameters<T>& g = p.materials[entry.material];
      T* const members[] = {&g.a, &g.b_deg, &g.c, &g.d, &g.e, &g.f_deg};
      return *members[entry.index];
    }
    default:
      break;
  }
  T* const members[] = {&p.jitter.sigma_range_m, &p.jitter.sigma_azimuth_deg, &p.jitter.reference_range_m};
  return *members[entry.index];
}

// The same parameters with another scalar.
template <typename T>
sim::PaperParameters<T> CastPaperParameters(const sim::PaperParameters<double>& p) {
  sim::PaperParameters<T> out;
  out.source_level_db = T(p.source_level_db);
  out.display = {T(p.display.db_min), T(p.display.db_max)};
  for (const GsabParameters<double>& g : p.materials) {
    out.materials.push_back({T(g.a), T(g.b_deg), T(g.c), T(g.d), T(g.e), T(g.f_deg)});
  }
  out.jitter = {T(p.jitter.sigma_range_m), T(p.jitter.sigma_azimuth_deg), T(p.jitter.reference_range_m),
                p.jitter.reference_frequency_hz, p.jitter.growth};
  out.noise_level_db = p.noise_level_db;
  out.array_gain_db = p.array_gain_db;
  return out;
}

// Writes fitted values back under their names; a material that "default" served gets an entry of its own.
void StorePaperParameters(const sim::PaperParameters<double>& fitted,
                          const std::vector<std::string>& material_names, ParameterSet& parameters);

}  // namespace sonarcal::calib
