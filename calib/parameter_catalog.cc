#include "calib/parameter_catalog.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "sim/physics/jitter.h"

namespace sonarcal {
namespace {

// Steps that would be a surprise: a factor of ten in power, a factor of e in a width, one in an exponent, 20
// dB.
constexpr double kPowerStep = std::numbers::ln10;
constexpr double kWidthStep = 1.0;
constexpr double kExponentStep = 1.0;
constexpr double kLevelStepDb = 20.0;

CatalogEntry GsabEntry(const std::string& material, int material_idx, int index) {
  const ParameterTraits& traits = kGsabTraits[index];
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

}  // namespace

std::vector<CatalogEntry> BuildCatalog(const std::vector<std::string>& material_names) {
  std::vector<CatalogEntry> catalog;
  catalog.push_back({.name = "source_level_db",
                     .unit = "dB re 1 uPa at 1 m",
                     .group = ParameterGroup::kSourceLevel,
                     .lower = 0.0,
                     .upper = 300.0,
                     .typical_step = kLevelStepDb});
  for (const int index : {0, 1}) {
    catalog.push_back({.name = index == 0 ? "display.db_min" : "display.db_max",
                       .unit = "dB",
                       .group = ParameterGroup::kDisplay,
                       .index = index,
                       .lower = -500.0,
                       .upper = 2000.0,
                       .typical_step = kLevelStepDb});
  }
  for (std::size_t material = 0; material < material_names.size(); ++material) {
    for (int index = 0; index < static_cast<int>(kGsabTraits.size()); ++index) {
      catalog.push_back(GsabEntry(material_names[material], static_cast<int>(material), index));
    }
  }
  for (int index = 0; index < static_cast<int>(kJitterTraits.size()); ++index) {
    const ParameterTraits& traits = kJitterTraits[index];
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

void StorePaperParameters(const PaperParameters<double>& fitted,
                          const std::vector<std::string>& material_names, ParameterSet& parameters) {
  parameters.source_level_db = fitted.source_level_db;
  parameters.display = fitted.display;
  parameters.jitter = fitted.jitter;
  for (std::size_t i = 0; i < material_names.size(); ++i) {
    parameters.materials[material_names[i]].gsab = fitted.materials[i];
  }
}

}  // namespace sonarcal
