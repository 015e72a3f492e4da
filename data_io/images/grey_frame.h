// Frame stored as an 8-bit grey PNG of known size.
#pragma once

#include <filesystem>
#include <optional>

#include "core/types/image.h"
#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

// Header of a PNG; nothing if the file is no PNG or damaged.
std::optional<ImageHeader> SniffPng(const std::filesystem::path& file);

// Grey levels, row 0 at the top. Throws DataError if the file is not an intact 8-bit grey PNG of `rows` rows
// and `cols` columns. Size and type are checked before decoding.
Grid<float> ReadGreyFrame(const std::filesystem::path& file, int rows, int cols);

}  // namespace sonarcal::data_io
