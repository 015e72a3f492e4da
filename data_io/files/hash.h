// SHA-256, used by a result to identify its inputs.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sonarcal::data_io {

// 64 hexadecimal digits, in the format of `sha256sum`.
std::string Sha256(std::string_view bytes);

// Hash of a file of any size, read in pieces. Throws DataError if it cannot be read.
std::string Sha256OfFile(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
