// JPEG pictures as grey values: what a header announces is checked before a decoder allocates anything.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/types/image.h"
#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

bool IsJpeg(std::string_view bytes);

// From the start-of-frame segment. Throws DataError naming `name` where there is none, or of no pixels or
// more than kMaxImagePixels.
ImageHeader ReadJpegHeader(std::string_view bytes, const std::string& name);

// Of a colour picture the luminance, of the orientation that the pixels have. Throws DataError naming `name`
// where the picture is damaged or cut short; what is wrong within is taken as the decoder fills it up.
Grid<std::uint8_t> DecodeJpegGrey(std::string_view bytes, const std::string& name);

}  // namespace sonarcal::data_io
