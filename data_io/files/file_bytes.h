// Reads a whole file as bytes, with a limit on its size.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace sonarcal::data_io {

// Throws DataError if the file is absent, unreadable, not a regular file, or longer than `max_bytes` (checked
// before any allocation).
std::string ReadFileBytes(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace sonarcal::data_io
