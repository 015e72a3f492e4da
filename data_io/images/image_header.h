// Header of an image file, read before any pixel is decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace sonarcal::data_io {

// Limit of the image size; a larger one indicates a damaged or malicious header.
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{64} << 20;

struct ImageHeader {
  int rows = 0;
  int cols = 0;
  int channels = 0;       // 1 grey, 2 grey and alpha, 3 colour, 4 colour and alpha
  int bits = 0;           // bits per sample
  bool is_float = false;  // IEEE samples, otherwise unsigned integers

  bool operator==(const ImageHeader&) const = default;

  std::int64_t pixels() const { return std::int64_t{rows} * cols; }
  std::size_t row_bytes() const { return (std::size_t(cols) * channels * bits + 7) / 8; }
  std::string Describe() const;  // "16-bit grey, 660 x 256 pixels (rows x columns)"
};

// Throws DataError, naming `file`, if the header announces no pixels, more than kMaxImagePixels, or more than
// `file_bytes` compressed bytes can hold. A decoder then never allocates memory for an impossible size.
void CheckImageHeader(const ImageHeader& header, std::size_t file_bytes, const std::string& file);

}  // namespace sonarcal::data_io
