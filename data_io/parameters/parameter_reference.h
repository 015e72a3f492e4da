// Reference of params.json, made from the table of parameters (core/types/parameter_table.h). The command
// `sonarcal documentation` writes it; tests compare it with docs/reference.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace sonarcal::data_io {

// JSON Schema of params.json: docs/reference/schemas/params.schema.json.
nlohmann::ordered_json ParametersSchema();

// Markdown tables of docs/reference/parameters.md, each under its heading.
std::string ParametersTables();

// Markdown table of the limits of acoustic fits in docs/reference/fit_config.md.
std::string AcousticFitLimitsTable();

}  // namespace sonarcal::data_io
