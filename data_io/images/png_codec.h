// PNG to and from memory, through libpng. Used by data_io/images/image_io.h, which is what to include.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

bool IsPng(std::string_view bytes);

// Throws DataError naming `file` where the header is damaged or CheckImageHeader refuses it. A palette counts
// as three channels of 8 bits.
ImageHeader ReadPngHeader(std::string_view bytes, const std::string& file);

enum class PngSamples {
  kAsStored,  // samples as they are in the file
  kRgb8,      // three channels of 8 bits: grey repeated, palettes looked up, alpha dropped, 16 bits cut to 8
};

// Samples row by row; those of 16 bits in the byte order of this machine. Throws DataError where the file
// ends early or a checksum is wrong.
std::vector<std::byte> DecodePng(std::string_view bytes, PngSamples samples, const std::string& file);

// The file for `samples`, laid out as DecodePng gives them; grey or colour of 8 or 16 bits.
std::vector<std::uint8_t> EncodePngSamples(const ImageHeader& header, std::span<const std::byte> samples);

}  // namespace sonarcal::data_io
