#include "apps/workflow/materials/material_options.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "data_io/parameters/materials_io.h"

namespace sonarcal::workflow {
namespace {

// Name of a named material by material of the scene.
using PriorNames = std::map<std::string, std::string>;

PriorNames PriorNamesOf(const MaterialOptions& options, const ParameterSet& parameters, const Scene& scene) {
  const std::vector<std::string>& materials = scene.material_names;
  PriorNames names;
  for (const std::string& material : materials) {
    const auto given = parameters.materials.find(material);
    const auto others = parameters.materials.find("default");
    const auto& of = given != parameters.materials.end() ? given : others;
    if (of != parameters.materials.end() && !of->second.prior.empty()) names[material] = of->second.prior;
  }
  for (const std::string& text : options.material) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      if (materials.size() != 1)
        throw UsageError(
            "--material is '{}', expected MATERIAL=NAME with one of {}, because the scene has {} "
            "materials",
            text, fmt::join(materials, ", "), materials.size());
      names[materials.front()] = text;
      continue;
    }
    const std::string material = text.substr(0, equals);
    if (std::ranges::find(materials, material) == materials.end())
      throw DataError("--material: the scene has no material '{}'{}", material,
                      ExpectedWord(material, materials));
    names[material] = text.substr(equals + 1);
  }
  return names;
}

}  // namespace

std::vector<NamedMaterial> MaterialOptions::Known() const {
  return data_io::KnownMaterials({materials.begin(), materials.end()});
}

void AddMaterialPriors(const MaterialOptions& options, const ParameterSet& parameters, const Scene& scene,
                       calib::FitConfig& config) {
  const std::vector<NamedMaterial> known = options.Known();
  const double level_sigma_db =
      options.level_sigma_db.value_or(parameters.source_level_sigma_db.value_or(calib::kUnknownLevelDb));
  for (const auto& [material, name] : PriorNamesOf(options, parameters, scene))
    calib::AddMaterialPriors(material, FindMaterial(name, known), parameters, level_sigma_db, config);
}

std::vector<std::string> MaterialCaveats(const MaterialOptions& options, const ParameterSet& parameters,
                                         const Scene& scene, double frequency_hz) {
  const std::vector<NamedMaterial> known = options.Known();
  std::vector<std::string> sentences;
  for (const auto& [material, name] : PriorNamesOf(options, parameters, scene)) {
    const NamedMaterial& of = FindMaterial(name, known);
    std::string sentence = fmt::format("material '{}' has the prior of {} ({})", material, name, of.source);
    if (frequency_hz > of.frequency_max_hz || (frequency_hz > 0.0 && frequency_hz < of.frequency_min_hz)) {
      sentence += fmt::format("; its band, {:g} to {:g} kHz, does not contain {:g} kHz",
                              1e-3 * of.frequency_min_hz, 1e-3 * of.frequency_max_hz, 1e-3 * frequency_hz);
    }
    sentences.push_back(std::move(sentence));
  }
  return sentences;
}

}  // namespace sonarcal::workflow
