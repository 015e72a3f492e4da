// `sonarcal materials`: lists the named materials (core/materials/named_materials.h), or shows one.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/commands/commands.h"
#include "core/materials/named_materials.h"
#include "core/types/error.h"
#include "core/types/parameter_table.h"
#include "core/types/units.h"
#include "data_io/parameters/materials_io.h"

namespace sonarcal::commands {
namespace {

struct MaterialsCommandOptions {
  cli::CommonOptions common;
  std::string name;  // empty: the list
  bool list = false;
  std::vector<std::filesystem::path> files;
};

using Json = nlohmann::ordered_json;

Json ToJson(const NamedMaterial& material) {
  Json json = {{"name", material.name}};
  json.update(data_io::MaterialJson(material));
  return json;
}

std::string BandText(const NamedMaterial& material) {
  const double low = 1e-3 * material.frequency_min_hz;
  const double high = 1e-3 * material.frequency_max_hz;
  return low == high ? fmt::format("{:g}", low) : fmt::format("{:g}..{:g}", low, high);
}

// Centre of a parameter with one standard deviation: "-23.0 +- 13.0" in dB, "8 x/ 2.7", "2 +- 1".
std::string PriorText(const ParameterInfo& info, double centre, double spread) {
  if (info.scale != ParameterScale::kLogarithmic) return fmt::format("{:.3g} +- {:.2g}", centre, spread);
  if (info.unit == "deg") return fmt::format("{:.3g} x/ {:.2g}", centre, spread);
  return fmt::format("{:.1f} +- {:.1f}", DbFromPower(centre), DbFromPower(spread));
}

std::string TableText(const std::vector<NamedMaterial>& materials) {
  constexpr const char* kRow = "{:<15} {:<9}{:>13}{:>15}{:>13}{:>15}{:>11}{:>15}{:>13}\n";
  std::string text =
      fmt::format(kRow, "name", "model", "band, kHz", "A, dB", "B, deg", "C, dB", "D", "E, dB", "F, deg");
  for (const NamedMaterial& material : materials) {
    std::vector<std::string> cells;
    VisitParameters(material.centre, [&](const ParameterInfo& info, double centre) {
      cells.push_back(PriorText(info, centre, ParameterMember<const double>(material.spread, info.key)));
    });
    text += fmt::format(kRow, material.name, ToString(material.model), BandText(material), cells[0], cells[1],
                        cells[2], cells[3], cells[4], cells[5]);
  }
  return text +
         "\nCentre and one standard deviation of the prior; x/ is a factor. A prior is not the value of a "
         "surface.\n"
         "'sonarcal materials NAME' shows source and comment.\n";
}

std::string OneText(const NamedMaterial& material) {
  std::string text = fmt::format("{}\n", material.name);
  const auto add = [&](const std::string& label, const std::string& value) {
    text += fmt::format("  {:<9} {}\n", label, value);
  };
  add("model", std::string(ToString(material.model)));
  add("band", BandText(material) + " kHz");
  VisitParameters(material.centre, [&](const ParameterInfo& info, double centre) {
    const bool level = info.scale == ParameterScale::kLogarithmic && info.unit != "deg";
    add(std::string(info.key),
        PriorText(info, centre, ParameterMember<const double>(material.spread, info.key)) +
            (level ? " dB" : ""));
  });
  add("level", material.level_db
                   ? fmt::format("A, C and E refer to {:g} dB of {}", *material.level_db,
                                 material.model == EchoModel::kPaper ? "source level minus db_min"
                                                                     : "source level plus gain")
                   : "A, C and E are backscattering strength per unit area");
  add("source", material.source);
  if (!material.comment.empty()) add("comment", material.comment);
  if (material.origin) {
    add("origin", fmt::format("{}{}, {}", material.origin->recording,
                              material.origin->synthetic ? " (synthetic)" : "", material.origin->program));
  }
  return text;
}

cli::ExitStatus RunMaterials(const MaterialsCommandOptions& options) {
  if (options.list && !options.name.empty())
    throw UsageError("--list is given with the name '{}', expected one of the two", options.name);
  const std::vector<NamedMaterial> materials = data_io::KnownMaterials(options.files);
  if (!options.name.empty()) {
    const NamedMaterial& material = FindMaterial(options.name, materials);
    if (options.common.json) {
      cli::PrintJson(ToJson(material));
    } else {
      cli::PrintResult(OneText(material));
    }
    return cli::ExitStatus::kDone;
  }
  if (options.common.json) {
    Json list = Json::array();
    for (const NamedMaterial& material : materials) list.push_back(ToJson(material));
    cli::PrintJson({{"materials", list}});
  } else {
    cli::PrintResult(TableText(materials));
  }
  return cli::ExitStatus::kDone;
}

}  // namespace

void SetupMaterials(CLI::App& app) {
  auto options = std::make_shared<MaterialsCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "materials", "Lists the materials known by name, for --material, or shows one");
  command->add_option("name", options->name, "Material to show with source and comment (default: the list)")
      ->type_name("NAME");
  command->add_flag("--list", options->list, "List all materials, as without a name");
  command
      ->add_option("--materials", options->files,
                   "Files with more materials, as export --to materials writes (default: none)")
      ->type_name("JSON")
      ->delimiter(',');
  cli::OnRun(command, options->common, [options] { return RunMaterials(*options); });
}

}  // namespace sonarcal::commands
