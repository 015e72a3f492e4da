// The parameters of a fit by name, with unit, bounds and place. The entries of an image model are made from
// the table of all parameters (core/types/parameter_table.h); poses are added.
//
// Names are those of `fit.json`: the path in params.json, such as receiver.gain_db, with material.<name> in
// place of materials.<name>; pose.<frame>.{x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg}; pose.mount.* for an
// offset behind every recorded pose, in the sonar's frame (none is zero); geometry.* for corrections of the
// sonar's axes (core/sonars/sonar_geometry.h); object.<node>.* for a part of the scene that stands
// elsewhere (calib/parameters/object_placement.h): the components of a pose, and scale_{x,y,z}; and
// outline.<node>.{radius,bump}_NN_m for a part whose shape is known only roughly
// (calib/shapes/object_outline.h).
//
// A solver moves the coordinate of a value: the logarithm of a value that must stay positive, otherwise the
// value itself. `typical_step` is a surprising change of the coordinate. A parameter that the data leave
// freer than that is called unidentifiable. In a fit by likelihood it is also the standard deviation of the
// prior.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/shapes/object_outline.h"
#include "core/sonars/sonar_geometry.h"
#include "core/types/parameter_table.h"
#include "sim/physics/paper_echo.h"

namespace sonarcal::calib {

// Groups of entries, in the order of a catalog.
enum class ParameterGroup {
  kSourceLevel,
  kDisplay,
  kReceiver,
  kBeam,
  kPulse,
  kGsab,
  kJitter,
  kTransmit,
  kMirror,
  kPose,
  kGeometry,
  kObject,
  kOutline,
};

// Frame of the pose entries of the mount offset, which all frames share.
inline constexpr int kMountFrame = -1;

// Prior of a parameter: a normal law of its coordinate. Infinite sigma: no information.
struct Prior {
  double coordinate = 0.0;
  double sigma = 1.0;
};

// Share of the prior variance above which a parameter or a direction counts as not determined. Below it the
// prior hardly pulls: if its centre is off by 2 sigma, a 68 % interval still covers 61 % (28 % at a share of
// 0.5).
inline constexpr double kOpenShare = 0.1;

struct CatalogEntry {
  std::string name;
  std::string_view key = {};  // in its group of params.json; empty for a pose
  std::string unit;
  ParameterGroup group = ParameterGroup::kSourceLevel;
  int material = -1;  // index into the scene's material names, kGsab only
  int mirror = -1;    // as above, kMirror only
  int index = 0;      // member of its group
  int frame = -1;     // position among the fit's frames, or kMountFrame; kPose only
  int object = -1;    // index into the names of the objects (kObject) or the forms of the outlines (kOutline)
  double lower = 0.0;
  double upper = 0.0;
  // Limits of params.json. Its reader refuses values beyond them.
  double file_lower = -std::numeric_limits<double>::infinity();
  double file_upper = std::numeric_limits<double>::infinity();
  // Trust region of one solve, in which the model is nearly linear. A value that ends at it is not at a
  // bound.
  double trust_lower = -std::numeric_limits<double>::infinity();
  double trust_upper = std::numeric_limits<double>::infinity();
  bool logarithmic = false;
  double typical_step = 1.0;
  std::optional<Prior> prior = {};

  double CoordinateFromValue(double value) const { return logarithmic ? std::log(value) : value; }

  template <typename T>
  T ValueFromCoordinate(const T& coordinate) const {
    using std::exp;
    return logarithmic ? T(exp(coordinate)) : coordinate;
  }

  // Limits of a solver for the value.
  double solve_lower() const { return std::max(lower, trust_lower); }
  double solve_upper() const { return std::min(upper, trust_upper); }

  // Distance of a value from its prior, in sigmas of the prior; 0 without a prior.
  double FromPrior(double value) const {
    return prior ? (CoordinateFromValue(value) - prior->coordinate) / prior->sigma : 0.0;
  }

  // Scale of its steps: the standard deviation of its prior, or a typical step if none pulls.
  double StepSigma() const { return prior && std::isfinite(prior->sigma) ? prior->sigma : typical_step; }

  // d value / d coordinate.
  double ValueSlope(double value) const { return logarithmic ? value : 1.0; }
};

// One value for each entry of a catalog, in the entry's unit.
using ParameterValues = std::vector<double>;

// Half the sum of squares of the priors of these entries.
double CostOfPriors(const std::vector<CatalogEntry>& catalog, const std::vector<int>& entries,
                    const ParameterValues& values);

// Returns every parameter of the paper's model for a scene with these materials.
std::vector<CatalogEntry> BuildCatalog(const std::vector<std::string>& material_names);

// Returns every parameter of the acoustic model that a fit may move, with limits within those of params.json.
// A parameter whose limits then leave no room is absent. `frames`: their indices in the recording. `mirrors`:
// 1 for materials that reflect, 0 for the others; empty: none reflects. `objects`: names of the parts of the
// scene that may stand elsewhere. `outlines`: those whose shape may be another.
std::vector<CatalogEntry> BuildAcousticCatalog(const std::vector<std::string>& material_names,
                                               const SonarModel& sonar, const std::vector<int>& frames,
                                               const std::vector<char>& mirrors = {},
                                               const std::vector<std::string>& objects = {},
                                               const std::vector<OutlineForm>& outlines = {});

// Narrows the bounds of a curve's entry to the curves of real surfaces: widths and exponent, and amplitudes
// as backscatter per unit area.
void NarrowToRealCurves(CatalogEntry& gsab_entry);

// Returns true for an amplitude of a backscatter curve: A, C or E.
inline bool IsAmplitude(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kGsab && entry.index % 2 == 0;
}

// Returns true for the placement of objects and their outlines, which need another scene.
inline bool ChangesScene(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kObject || entry.group == ParameterGroup::kOutline;
}

// Returns true for poses, the sonar's geometry, and placement and outlines of objects: those that are not in
// params.json.
inline bool IsPlacement(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kPose || entry.group == ParameterGroup::kGeometry ||
         ChangesScene(entry);
}

// Returns true for a placement that all frames share.
inline bool IsSharedPlacement(const CatalogEntry& entry) {
  return IsPlacement(entry) && (entry.group != ParameterGroup::kPose || entry.frame == kMountFrame);
}

// Returns true for beam, pulse and placement, which decide where an echo arrives, and for the transmitter's
// end, which decides if it arrives. A change of these needs new tracing or gathering.
inline bool IsGeometric(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kBeam || entry.group == ParameterGroup::kPulse ||
         entry.group == ParameterGroup::kTransmit || IsPlacement(entry);
}

// Value of an entry of a geometry, an object or an outline that changes nothing: 1 for a scale, else 0.
double DeclaredValue(const CatalogEntry& entry);

// Sets the member of a geometry that the name of an entry means.
void SetGeometry(std::string_view entry_name, double value, SonarGeometry& geometry);

// Sonar geometry with the entries of a catalog at these values.
SonarGeometry GeometryOf(const std::vector<CatalogEntry>& catalog, const ParameterValues& values);

// Reference to a parameter of the acoustic model, except placements. Materials and mirrors must have entries
// of their own, and the receiver a noise level.
double& AcousticSlot(ParameterSet& parameters, const std::vector<std::string>& material_names,
                     const CatalogEntry& entry);

// Reference to a parameter of the paper's model.
template <typename T>
T& PaperSlot(sim::PaperParameters<T>& p, const CatalogEntry& entry) {
  switch (entry.group) {
    case ParameterGroup::kDisplay:
      return ParameterMember<T>(p.display, entry.key);
    case ParameterGroup::kGsab:
      return ParameterMember<T>(p.materials[entry.material], entry.key);
    case ParameterGroup::kJitter:
      return ParameterMember<T>(p.jitter, entry.key);
    default:
      return p.source_level_db;
  }
}

// Converts the parameters to another scalar.
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

// Writes fitted values back under their names. A material that used "default" gets an entry of its own.
void StorePaperParameters(const sim::PaperParameters<double>& fitted,
                          const std::vector<std::string>& material_names, ParameterSet& parameters);

}  // namespace sonarcal::calib
