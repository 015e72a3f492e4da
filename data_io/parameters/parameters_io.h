// params.json: the physical parameters of a simulation (core/types/parameters.h) as a file.
//
//   {"format": "sonar-parameters/1", "model": "paper" | "acoustic" | "coherent",
//    "source_level_db": 200,
//    "noise_level_db": 0, "array_gain_db": 0,
//    "display": {"db_min": 80, "db_max": 190, "soft_db", "exponent",
//                "law": "log" | "soft_log" | "soft_amplitude" | "power"},
//    "materials": {"floor": {"gsab": {"A": 90, "B_deg": 4, "C": 100, "D": 1, "E": 90, "F_deg": 8}}, ...},
//    "mirror": {"wall": {"loss_db": 6}, ...},
//    "jitter": {"sigma_range_m", "sigma_azimuth_deg", "reference_range_m", "reference_frequency_hz",
//               "growth": "root" | "linear"},
//    "receiver": {"gain_db", "time_varied_gain": "none" | "20logR" | "40logR" | "40logR+alpha",
//                 "noise_db", "noise_slope_db_per_m", "noise_taper_db": [dB per beam],
//                 "noise_after_gain_db", "noise_after_gain_taper_db": [dB per beam], "looks"},
//    "beam": {"azimuth_width_deg", "elevation_width_deg",
//             "azimuth_pattern": "gaussian" | "aperture" | "table",
//             "elevation_pattern": "gaussian" | "aperture" | "cosine", "elevation_taper": 0..1,
//             "azimuth_taper": 0..1, "azimuth_table_db": [odd count, the axis in the middle],
//             "transmit_even_deg", "transmit_end_deg", "mirror_lobes": "all" | "main",
//             "sensitivity_db": [dB per beam]},
//    "pulse": {"length_m"},
//    "water": {"temperature_c", "salinity_ppt", "ph", "depth_m"}}
//
// Required: `format`, `model`, `materials` (at least one, with all six numbers), db_min and db_max of
// `display`, and all members of `water` if it is present. Other absent values keep the default of
// core/types/parameters.h. Throws DataError with file, line and key for values out of range and for unknown
// keys.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/types/parameters.h"

namespace sonarcal::data_io {

ParameterSet ReadParameters(const std::filesystem::path& file);

// As ReadParameters; `file` is the name used in messages.
ParameterSet ParseParameters(std::string_view text, const std::string& file);

// Reads back as the same set, exactly. Writes all groups, including those with default values, so the file is
// self-explanatory.
nlohmann::ordered_json ParametersJson(const ParameterSet& parameters);

// Writes the whole file or nothing. Throws DataError if the file cannot be written, or the set could not be
// read back.
void WriteParameters(const std::filesystem::path& file, const ParameterSet& parameters);

}  // namespace sonarcal::data_io
