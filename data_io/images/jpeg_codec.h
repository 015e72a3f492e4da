// Decodes JPEG pictures to grey values or colours. The header is checked before a decoder allocates memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/types/image.h"
#include "core/types/rgb_image.h"
#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

bool IsJpeg(std::string_view bytes);

// Header from the start-of-frame segment. Throws DataError, naming `name`, if the bytes are no JPEG, if there
// is no such segment, or if it has no pixels or more than kMaxImagePixels.
ImageHeader ReadJpegHeader(std::string_view bytes, const std::string& name);

// Luminance of a colour picture, in the orientation of the pixels. Throws DataError, naming `name`, if the
// picture is damaged or truncated. Errors within the data are accepted as the decoder fills them.
Grid<std::uint8_t> DecodeJpegGrey(std::string_view bytes, const std::string& name);

// Colours, under the same conditions.
RgbImage DecodeJpegRgb(std::string_view bytes, const std::string& name);

}  // namespace sonarcal::data_io
