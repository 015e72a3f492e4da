// 8-bit grey PNG of a size that is known beforehand, as published recordings keep a frame in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "data_io/types/image.h"

namespace sonarcal {

struct PngHeader {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint8_t bit_depth = 0;
  std::uint8_t colour_type = 0;  // 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGB + alpha

  bool operator==(const PngHeader&) const = default;
};

// The header of a PNG, without decoding it; nothing where the file is not a PNG (or not readable).
std::optional<PngHeader> SniffPng(const std::filesystem::path& file);

// The grey levels, row 0 uppermost. Throws DataError where the file is not an intact 8-bit grey PNG of `rows`
// rows and `cols` columns; size and type are checked before anything is decoded.
Grid<std::uint8_t> ReadGreyPng(const std::filesystem::path& file, int rows, int cols);

}  // namespace sonarcal
