// Named materials (core/materials/named_materials.h) as a file, as `sonarcal export --to materials` writes
// fitted ones:
//
//   {"format": "sonar-materials/1",
//    "materials": {"tank floor": {
//      "model": "acoustic", "frequency_hz": [900000, 900000], "level_db": 200,
//      "gsab": {"A": {"centre": 0.1, "factor": 1.2}, "B_deg": {"centre": 5, "factor": 1.1},
//               "C": {"centre": 0.002, "factor": 1.1}, "D": {"centre": 1.8, "sigma": 0.1},
//               "E": {"centre": 0.01, "factor": 1.3}, "F_deg": {"centre": 11, "factor": 1.2}},
//      "source": "fit of ...", "comment": "",
//      "origin": {"recording": "tank", "synthetic": true, "program": "sonarcal 0.1.0"}}}}
//
// `factor` and `sigma` are one standard deviation. `level_db` absent: A, C and E are backscattering strength
// per unit area. `comment` and `origin` may be absent. Throws DataError with file, line and key.
#pragma once

#include <filesystem>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/materials/named_materials.h"

namespace sonarcal::data_io {

// Returns the materials in alphabetical order. Refuses the name of a built-in one.
std::vector<NamedMaterial> ReadMaterials(const std::filesystem::path& file);

// Built-in materials and those of the files. Refuses a name that two files give.
std::vector<NamedMaterial> KnownMaterials(const std::vector<std::filesystem::path>& files);

// The object of one material.
nlohmann::ordered_json MaterialJson(const NamedMaterial& material);

// The whole file. Materials read back as the same numbers.
nlohmann::ordered_json MaterialsJson(const std::vector<NamedMaterial>& materials);

}  // namespace sonarcal::data_io
