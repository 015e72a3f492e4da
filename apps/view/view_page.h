// Files of the page, built into the program (apps/view/CMakeLists.txt). Nothing is read from disk.
#pragma once

#include <span>
#include <string_view>

namespace sonarcal::view {

struct PageFile {
  std::string_view path;  // "/view.js"
  std::string_view type;  // MIME
  std::string_view bytes;
};

std::span<const PageFile> PageFiles();

// Returns null for an unknown path; "/" is the page itself.
const PageFile* FindPageFile(std::string_view path);

}  // namespace sonarcal::view
