// A whole file as bytes, with a limit on its size.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace sonarcal::data_io {

// Throws DataError where the file is absent, unreadable, not a regular file, or longer than `max_bytes`
// (which is checked before anything is allocated).
std::string ReadFileBytes(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace sonarcal::data_io
