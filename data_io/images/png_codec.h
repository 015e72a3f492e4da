// PNG to and from memory, by libpng. Internal to data_io/images/image_io.h; include that file instead.
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

// Throws DataError, naming `file`, if the header is damaged or CheckImageHeader rejects it. A palette counts
// as three channels of 8 bits.
ImageHeader ReadPngHeader(std::string_view bytes, const std::string& file);

enum class PngSamples {
  kAsStored,  // samples as in the file
  kRgb8,  // three channels of 8 bits: grey repeated, palettes resolved, alpha dropped, 16 bits truncated to 8
};

// Samples row by row; 16-bit samples in the byte order of this machine. Throws DataError if the file ends
// early or a checksum is wrong.
std::vector<std::byte> DecodePng(std::string_view bytes, PngSamples samples, const std::string& file);

// PNG file of `samples`, in the layout of DecodePng; grey or colour of 8 or 16 bits.
std::vector<std::uint8_t> EncodePngSamples(const ImageHeader& header, std::span<const std::byte> samples);

}  // namespace sonarcal::data_io
