// Readable JSON text: values that fit in a line are written in one, and lists of numbers always are.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace sonarcal::data_io {

// Numbers have the fewest digits that read back as the same double. Non-finite numbers become null; bytes
// that are not UTF-8 become U+FFFD. Ends with a newline.
std::string JsonText(const nlohmann::ordered_json& json);

// JsonText in one line, without spaces and without a newline.
std::string JsonLine(const nlohmann::ordered_json& json);

// Writes JsonText completely or not at all (data_io/files/atomic_output.h). Throws DataError if it cannot.
void WriteJson(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace sonarcal::data_io
