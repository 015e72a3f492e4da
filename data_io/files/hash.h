// SHA-256, by which a result names the inputs it was made from.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sonarcal::data_io {

// 64 hexadecimal digits, as `sha256sum` prints them.
std::string Sha256(std::string_view bytes);

// Of a file of any size, read in pieces. Throws DataError where it cannot be read.
std::string Sha256OfFile(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
