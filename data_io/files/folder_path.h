// Path of a folder by which its name and its parents are found.
#pragma once

#include <filesystem>

namespace sonarcal::data_io {

// Returns the absolute path without "." and "..", and without a slash at its end. An empty path is the
// working directory.
inline std::filesystem::path PlainFolder(const std::filesystem::path& folder) {
  const std::filesystem::path whole = std::filesystem::absolute(folder.empty() ? "." : folder);
  return (whole / "").lexically_normal().parent_path();  // "" ends every path with a slash
}

}  // namespace sonarcal::data_io
