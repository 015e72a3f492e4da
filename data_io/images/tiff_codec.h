// Grey TIFF to and from memory, through libtiff. Used by data_io/images/image_io.h, which is what to include.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

bool IsTiff(std::string_view bytes);

// Throws DataError naming `file` where the header is damaged, CheckImageHeader refuses it, or the file is
// other than the plain kind: one image in strips, uncompressed or by LZW, deflate or PackBits.
ImageHeader ReadTiffHeader(std::string_view bytes, const std::string& file);

// Samples row by row in the byte order of this machine; of one channel only, of 8 or 16 bits or float of 32.
// Throws DataError where they are of another kind or damaged.
std::vector<std::byte> DecodeTiff(std::string_view bytes, const std::string& file);

// An uncompressed file, which every program reads. `samples`: rows x cols.
std::vector<std::uint8_t> EncodeFloatTiff(int rows, int cols, std::span<const float> samples);

}  // namespace sonarcal::data_io
