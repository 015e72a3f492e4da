// A frame that is kept as an 8-bit grey PNG of a size that is known beforehand.
#pragma once

#include <filesystem>
#include <optional>

#include "core/types/image.h"
#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

// What a PNG's header announces; nothing where the file is no PNG, or a damaged one.
std::optional<ImageHeader> SniffPng(const std::filesystem::path& file);

// The grey levels, row 0 uppermost. Throws DataError where the file is not an intact 8-bit grey PNG of `rows`
// rows and `cols` columns; size and kind are checked before anything is decoded.
Grid<float> ReadGreyFrame(const std::filesystem::path& file, int rows, int cols);

}  // namespace sonarcal::data_io
