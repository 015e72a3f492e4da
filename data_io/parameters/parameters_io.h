// params.json: the physical parameters of a simulation (core/types/parameters.h) as a file.
//
//   {"format": "sonar-parameters/1", "model": "acoustic", "source_level_db": 200,
//    "display": {"db_min": 80, "db_max": 190},
//    "materials": {"floor": {"gsab": {"A": 90, "B_deg": 4, "C": 100, "D": 1, "E": 90, "F_deg": 8}}, ...},
//    ...}
//
// Its keys, their units and limits are those of core/types/parameter_table.h; docs/reference/parameters.md
// lists them. A key that is absent keeps the default of core/types/parameters.h, unless it is required.
// Throws DataError with file, line and key for a value out of its limits and for every unknown key.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/materials/named_materials.h"
#include "core/types/parameters.h"

namespace sonarcal::data_io {

class JsonReader;

inline constexpr std::string_view kParametersFormat = "sonar-parameters/1";

ParameterSet ReadParameters(const std::filesystem::path& file);

// Reads the start of a fit: a material may have a prior and no curve. It then starts at the centre of that
// material of `materials`. Throws DataError for a prior that is none of them.
ParameterSet ReadStartParameters(const std::filesystem::path& file,
                                 const std::vector<NamedMaterial>& materials);

// As the functions above; `file` is the name used in messages.
ParameterSet ParseParameters(std::string_view text, const std::string& file);
ParameterSet ParseStartParameters(std::string_view text, const std::string& file,
                                  const std::vector<NamedMaterial>& materials);

// Reads the members of an object in another file. Leaves unknown keys to the reader's Finish.
ParameterSet ParametersFrom(const JsonReader& json);

// Reads back as the same set, exactly. Writes all groups, including those with default values, so the file is
// self-explanatory.
nlohmann::ordered_json ParametersJson(const ParameterSet& parameters);

// Writes the whole file or nothing. Throws DataError if the file cannot be written, or the set could not be
// read back.
void WriteParameters(const std::filesystem::path& file, const ParameterSet& parameters);

}  // namespace sonarcal::data_io
