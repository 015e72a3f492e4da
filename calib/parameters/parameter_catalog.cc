#include "calib/parameters/parameter_catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calib/parameters/pose_step.h"
#include "core/types/units.h"
#include "sim/physics/jitter.h"

namespace sonarcal::calib {
namespace {

// Surprisingly large steps: a factor of ten in power, a factor of e in a width, 1 in an exponent, 20 dB.
constexpr double kPowerStep = std::numbers::ln10;
constexpr double kWidthStep = 1.0;
constexpr double kExponentStep = 1.0;
constexpr double kLevelStepDb = 20.0;
// 10 dB in the loss of a reflection. Beyond 60 dB the ghosts of a mirror are below all other echoes.
constexpr double kLossStepDb = 10.0;
constexpr double kMaxLossDb = 60.0;

CatalogEntry GsabEntry(const std::string& material, int material_idx, int index) {
  const sim::ParameterTraits& traits = sim::kGsabTraits[index];
  const bool exponent = traits.name == "D";
  const bool width = traits.unit == "deg";
  return {.name = fmt::format("material.{}.gsab.{}", material, traits.name),
          .unit = std::string(traits.unit),
          .group = ParameterGroup::kGsab,
          .material = material_idx,
          .index = index,
          .lower = traits.lower,
          .upper = traits.upper,
          .logarithmic = !exponent,
          .typical_step = exponent ? kExponentStep : (width ? kWidthStep : kPowerStep)};
}

CatalogEntry SourceLevelEntry() {
  return {.name = "source_level_db",
          .unit = "dB re 1 uPa at 1 m",
          .group = ParameterGroup::kSourceLevel,
          .lower = 0.0,
          .upper = 300.0,
          .typical_step = kLevelStepDb};
}

void AddMaterials(const std::vector<std::string>& material_names, std::vector<CatalogEntry>& catalog) {
  for (std::size_t material = 0; material < material_names.size(); ++material) {
    for (int index = 0; index < static_cast<int>(sim::kGsabTraits.size()); ++index) {
      catalog.push_back(GsabEntry(material_names[material], static_cast<int>(material), index));
    }
  }
}

// A width of the point spread function: at least an eighth of a sample, at most `most` samples.
CatalogEntry WidthEntry(const std::string& name, const std::string& unit, ParameterGroup group, double sample,
                        double most) {
  return {.name = name,
          .unit = unit,
          .group = group,
          .lower = 0.125 * sample,
          .upper = most * sample,
          .logarithmic = true,
          .typical_step = kWidthStep};
}

// Limits of the curves of real surfaces, as backscatter per unit area: peaks of -70 to +20 dB, at least half
// a degree wide (a narrower peak is a mirror, and absorbs errors of the model), a slow part of -70 to 0 dB.
struct Limits {
  double lower;
  double upper;
};
constexpr std::array<Limits, 6> kRealGsabBounds = {
    {{1e-7, 100.0}, {0.5, 20.0}, {1e-7, 1.0}, {0.0, 5.0}, {1e-7, 10.0}, {3.0, 60.0}}};

// Angle up to which a transmitter sends: at least to the outer beams, at most as far as rays for ghosts go.
CatalogEntry TransmitEntry(const SonarModel& sonar) {
  constexpr double kFurthestDeg = 60.0;
  constexpr double kStepDeg = 20.0;
  const double edge_deg = DegFromRad(sonar.axes.OuterEdgeRad());
  return {.name = "beam.transmit_end_deg",
          .unit = "deg",
          .group = ParameterGroup::kTransmit,
          .lower = edge_deg + 1.0,
          .upper = edge_deg + kFurthestDeg,
          .typical_step = kStepDeg};
}

void AddMirrors(const std::vector<std::string>& material_names, const std::vector<char>& mirrors,
                std::vector<CatalogEntry>& catalog) {
  for (std::size_t material = 0; material < mirrors.size(); ++material) {
    if (mirrors[material] == 0) continue;
    catalog.push_back({.name = fmt::format("mirror.{}.loss_db", material_names[material]),
                       .unit = "dB",
                       .group = ParameterGroup::kMirror,
                       .mirror = static_cast<int>(material),
                       .lower = 0.0,
                       .upper = kMaxLossDb,
                       .typical_step = kLossStepDb});
  }
}

void AddPose(const std::string& name, int frame, std::vector<CatalogEntry>& catalog) {
  for (int index = 0; index < kPoseSteps; ++index) {
    const bool angle = index >= 3;
    catalog.push_back({.name = fmt::format("pose.{}.{}", name, kPoseNames[index]),
                       .unit = angle ? "deg" : "m",
                       .group = ParameterGroup::kPose,
                       .index = index,
                       .frame = frame,
                       .lower = angle ? -720.0 : -1e5,
                       .upper = angle ? 720.0 : 1e5,
                       .typical_step = angle ? 3.0 : 0.1});
  }
}

void AddPoses(const std::vector<int>& frames, std::vector<CatalogEntry>& catalog) {
  AddPose("mount", kMountFrame, catalog);
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    AddPose(fmt::format("{}", frames[frame]), static_cast<int>(frame), catalog);
  }
}

}  // namespace

std::vector<CatalogEntry> BuildCatalog(const std::vector<std::string>& material_names) {
  std::vector<CatalogEntry> catalog;
  catalog.push_back(SourceLevelEntry());
  for (const int index : {0, 1}) {
    catalog.push_back({.name = index == 0 ? "display.db_min" : "display.db_max",
                       .unit = "dB",
                       .group = ParameterGroup::kDisplay,
                       .index = index,
                       .lower = -500.0,
                       .upper = 2000.0,
                       .typical_step = kLevelStepDb});
  }
  AddMaterials(material_names, catalog);
  for (int index = 0; index < static_cast<int>(sim::kJitterTraits.size()); ++index) {
    const sim::ParameterTraits& traits = sim::kJitterTraits[index];
    catalog.push_back({.name = fmt::format("jitter.{}", traits.name),
                       .unit = std::string(traits.unit),
                       .group = ParameterGroup::kJitter,
                       .index = index,
                       .lower = traits.lower,
                       .upper = traits.upper,
                       .logarithmic = true,
                       .typical_step = kWidthStep});
  }
  return catalog;
}

void NarrowToRealCurves(CatalogEntry& gsab_entry) {
  gsab_entry.lower = kRealGsabBounds[gsab_entry.index].lower;
  gsab_entry.upper = kRealGsabBounds[gsab_entry.index].upper;
}

std::vector<CatalogEntry> BuildAcousticCatalog(const std::vector<std::string>& material_names,
                                               const SonarModel& sonar, const std::vector<int>& frames,
                                               const std::vector<char>& mirrors) {
  std::vector<CatalogEntry> catalog = {SourceLevelEntry()};
  constexpr std::array<const char*, 2> kLevels = {"receiver.gain_db", "receiver.noise_db"};
  for (std::size_t index = 0; index < kLevels.size(); ++index) {
    catalog.push_back({.name = kLevels[index],
                       .unit = "dB",
                       .group = ParameterGroup::kReceiver,
                       .index = static_cast<int>(index),
                       .lower = -500.0,
                       .upper = 500.0,
                       .typical_step = kLevelStepDb});
  }
  // A trend of 20 dB over the whole window is surprisingly large.
  const double window_m = sonar.axes.range_max_m - sonar.axes.range_min_m;
  catalog.push_back({.name = "receiver.noise_slope_db_per_m",
                     .unit = "dB/m",
                     .group = ParameterGroup::kReceiver,
                     .index = 2,
                     .lower = -100.0 / window_m,
                     .upper = 100.0 / window_m,
                     .typical_step = kLevelStepDb / window_m});
  const double beam_deg = DegFromRad(sonar.axes.beam_spacing_rad());
  catalog.push_back(WidthEntry("beam.azimuth_width_deg", "deg", ParameterGroup::kBeam, beam_deg, 16.0));
  catalog.push_back(WidthEntry("beam.elevation_width_deg", "deg", ParameterGroup::kBeam, 1.0, 120.0));
  catalog.back().index = 1;
  catalog.push_back(
      WidthEntry("pulse.length_m", "m", ParameterGroup::kPulse, sonar.axes.range_bin_m(), 16.0));
  AddMaterials(material_names, catalog);
  for (auto& entry : catalog) {
    if (entry.group == ParameterGroup::kGsab) NarrowToRealCurves(entry);
  }
  if (std::count(mirrors.begin(), mirrors.end(), 1) > 0) {
    catalog.push_back(TransmitEntry(sonar));
    AddMirrors(material_names, mirrors, catalog);
  }
  AddPoses(frames, catalog);
  return catalog;
}

double& AcousticSlot(ParameterSet& parameters, const std::vector<std::string>& material_names,
                     const CatalogEntry& entry) {
  ReceiverParameters& receiver = parameters.receiver;
  switch (entry.group) {
    case ParameterGroup::kReceiver:
      if (entry.index == 0) return receiver.gain_db;
      return entry.index == 1 ? receiver.noise_db.value() : receiver.noise_slope_db_per_m;
    case ParameterGroup::kBeam:
      return entry.index == 0 ? parameters.beam.azimuth_width_deg : parameters.beam.elevation_width_deg;
    case ParameterGroup::kPulse:
      return parameters.pulse.length_m;
    case ParameterGroup::kTransmit:
      return parameters.beam.transmit_end_deg;
    case ParameterGroup::kMirror:
      return parameters.mirrors.at(material_names[entry.mirror]).loss_db;
    case ParameterGroup::kGsab: {
      GsabParameters<double>& g = parameters.materials.at(material_names[entry.material]).gsab;
      const std::array<double*, 6> members = {&g.a, &g.b_deg, &g.c, &g.d, &g.e, &g.f_deg};
      return *members[entry.index];
    }
    default:
      return parameters.source_level_db;
  }
}

void StorePaperParameters(const sim::PaperParameters<double>& fitted,
                          const std::vector<std::string>& material_names, ParameterSet& parameters) {
  parameters.source_level_db = fitted.source_level_db;
  parameters.display = fitted.display;
  parameters.jitter = fitted.jitter;
  for (std::size_t i = 0; i < material_names.size(); ++i) {
    parameters.materials[material_names[i]].gsab = fitted.materials[i];
  }
}

}  // namespace sonarcal::calib
