// Grey TIFF to and from memory. Include data_io/images/image_io.h instead.
//
// libtiff reads and OpenCV writes. OpenCV does not read here: it has no call for the header alone, so that it
// would allocate what a header claims, and it prints the cause of a failure to the terminal without returning
// it.
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
// a single image in strips, uncompressed or with LZW, deflate or PackBits. One channel must be grey with 0 as
// black: palettes are refused.
ImageHeader ReadTiffHeader(std::string_view bytes, const std::string& file);

// Returns the samples row by row in the byte order of this machine: one channel of 8 or 16 bits or 32-bit
// float. Throws DataError if they are of another kind or damaged.
std::vector<std::byte> DecodeTiff(std::string_view bytes, const std::string& file);

// Returns an uncompressed file, which every program reads. `samples`: rows x cols.
std::vector<std::uint8_t> EncodeFloatTiff(int rows, int cols, std::span<const float> samples);

}  // namespace sonarcal::data_io
