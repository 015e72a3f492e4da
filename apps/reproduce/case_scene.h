// Scenes of a case study (apps/reproduce/case_plan.h), as one of
//
//   {"file": "scene.gltf"}                                 in the folder of the case; glTF, OBJ, STL or PLY
//   {"environment": "tank", "max_edge_m": 0.2, "size": "standard" | "alternative", "surface": false,
//    "seed": 1, "bed": false}
//   {"turned_solid": {"length_m", "max_edge_m", "material", "radii_mm": [[x, radius], ...]}}
//   {"ogive_body": {"length_m", "diameter_m", "nose_length_m", "tail_length_m", "tail_diameter_m",
//                   "max_edge_m", "material"}}
//
// turned_solid  radii by x, the position along the axis in parts of the length, rising from the tail (0) to
//               the tip (1). Origin on the axis at mid-length, +x through the tip.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>

#include "core/types/error.h"
#include "core/types/scene.h"
#include "data_io/json/json_reader.h"
#include "sim/scenes/environments.h"

namespace sonarcal::reproduce {

// A relative path that does not leave its folder. Throws DataError with file, line and key, as all of these
// do.
std::string ReadPathBelow(const data_io::JsonReader& json);

// Returns `find` of the text of `json`. Turns a UsageError for an unknown name into a DataError.
template <typename Find>
auto FindNamed(const data_io::JsonReader& json, Find find) -> decltype(&find(json.String())) {
  try {
    return &find(json.String());
  } catch (const UsageError& error) {
    json.Fail(fmt::format("is wrong: {}", error.what()));
  }
}

Scene ReadCaseScene(const data_io::JsonReader& json, const std::filesystem::path& folder);

// The environment of such a scene, which must be one.
std::pair<const sim::Environment*, sim::EnvironmentOptions> ReadEnvironment(const data_io::JsonReader& json);

}  // namespace sonarcal::reproduce
