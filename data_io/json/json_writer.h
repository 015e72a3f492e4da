// JSON text that people can read: whatever fits in a line stands in one, and lists of numbers always do.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace sonarcal::data_io {

// Numbers are written with the fewest digits that read back as the same double; numbers that are not finite
// become null; bytes that are not UTF-8 become U+FFFD. Ends with a newline.
std::string JsonText(const nlohmann::ordered_json& json);

// Writes JsonText whole or not at all (data_io/files/atomic_output.h). Throws DataError where it cannot.
void WriteJson(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace sonarcal::data_io
