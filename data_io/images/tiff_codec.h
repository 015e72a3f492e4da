// Grey TIFF to and from memory, by libtiff. Internal to data_io/images/image_io.h; include that file instead.
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

// Throws DataError, naming `file`, if the header is damaged, CheckImageHeader rejects it, or the file is not
// a single image in strips, uncompressed or with LZW, deflate or PackBits.
ImageHeader ReadTiffHeader(std::string_view bytes, const std::string& file);

// Samples row by row in the byte order of this machine, of one channel, with 8 or 16 bits or 32-bit float.
// Throws DataError if they are of another type or damaged.
std::vector<std::byte> DecodeTiff(std::string_view bytes, const std::string& file);

// Uncompressed file, readable by every program. `samples`: rows x cols.
std::vector<std::uint8_t> EncodeFloatTiff(int rows, int cols, std::span<const float> samples);

}  // namespace sonarcal::data_io
