// Options that give materials of a scene the prior of a named material.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/parameters/fit_config.h"
#include "core/materials/named_materials.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/scene.h"

namespace sonarcal::workflow {

struct MaterialOptions {
  std::vector<std::string> material = {};   // "floor=sand:medium", or "sand:medium" if the scene has one
  std::vector<std::string> materials = {};  // files
  std::optional<double> level_sigma_db = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "material",
                     .help = "Prior of a material of the scene: MATERIAL=NAME with a name of 'sonarcal "
                             "materials', or NAME if the scene has one material",
                     .by_default = "that of the parameters, else about their values",
                     .type = "MATERIAL=NAME"},
          self.material);
    visit(OptionInfo{.name = "materials",
                     .help = "Files with more named materials, as export --to materials writes",
                     .by_default = "none",
                     .type = "JSON"},
          self.materials);
    visit(OptionInfo{.name = "level_sigma",
                     .help = "Standard deviation of source level and gain together, by which the priors of "
                             "named materials are widened; 0 for a calibrated sonar",
                     .unit = "dB",
                     .by_default = "source_level_sigma_db of the parameters, else 20",
                     .min = 0.0,
                     .max = 200.0},
          self.level_sigma_db);
  }

  // Built-in materials and those of the files. Throws DataError for a file that cannot be used.
  std::vector<NamedMaterial> Known() const;
};

// Adds the priors of named materials to a configuration that has none of these parameters: those of the
// options, else those that the parameters name. Throws DataError for an unknown material or name, and
// UsageError for an option that is neither MATERIAL=NAME nor NAME.
void AddMaterialPriors(const MaterialOptions& options, const ParameterSet& parameters, const Scene& scene,
                       calib::FitConfig& config);

// Returns a sentence for each material with a named prior: its source, and that its band does not contain
// the frequency if so (0: unknown).
std::vector<std::string> MaterialCaveats(const MaterialOptions& options, const ParameterSet& parameters,
                                         const Scene& scene, double frequency_hz);

}  // namespace sonarcal::workflow
