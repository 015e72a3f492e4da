// --scene, for every command that takes one: glTF, or OBJ, STL or PLY with unit and up axis, which these
// formats do not state (data_io/scenes/cad_io.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>

#include <nlohmann/json_fwd.hpp>

#include "apps/cli/command.h"
#include "core/types/words.h"
#include "data_io/scenes/cad_io.h"

namespace sonarcal::cli {

enum class LengthUnit { kMetre, kCentimetre, kMillimetre, kInch, kFoot };
constexpr auto WordsOf(std::type_identity<LengthUnit>) {
  return Words<LengthUnit, 5>{{{"m", LengthUnit::kMetre},
                               {"cm", LengthUnit::kCentimetre},
                               {"mm", LengthUnit::kMillimetre},
                               {"in", LengthUnit::kInch},
                               {"ft", LengthUnit::kFoot}}};
}

// Unit and up axis of an OBJ, STL or PLY file. Default: the conventions of data_io/scenes/cad_io.h.
struct SceneFormat {
  std::optional<LengthUnit> unit;
  std::optional<data_io::UpAxis> up;
};

double MetresPerUnit(LengthUnit unit);

// Adds --scene, or another option `name` for the file, and --scene-unit and --scene-up.
void AddSceneOptions(CLI::App& command, std::filesystem::path& scene, SceneFormat& format,
                     const std::string& description, bool required, const std::string& name = "--scene");

// Reads the scene. For OBJ, STL or PLY prints its size, which shows a wrong unit or axis. Throws UsageError
// if a format is given for a glTF, DataError as ReadScene does.
Scene ReadSceneFile(const std::filesystem::path& scene, const SceneFormat& format,
                    const CommonOptions& common);

// Returns the given values for provenance; empty if none is given.
nlohmann::ordered_json SceneFormatJson(const SceneFormat& format);

}  // namespace sonarcal::cli
