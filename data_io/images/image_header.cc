#include "data_io/images/image_header.h"

#include <fmt/format.h>

#include "core/types/error.h"

namespace sonarcal::data_io {

std::string ImageHeader::Describe() const {
  static constexpr const char* kChannels[] = {"", "grey", "grey with alpha", "colour", "colour with alpha"};
  const std::string kind =
      channels >= 1 && channels <= 4 ? kChannels[channels] : fmt::format("{}-channel", channels);
  return fmt::format("{}-bit {}{}, {} x {} pixels (rows x columns)", bits, is_float ? "float " : "", kind,
                     rows, cols);
}

void CheckImageHeader(const ImageHeader& header, std::size_t file_bytes, const std::string& file) {
  if (header.rows < 1 || header.cols < 1) {
    throw DataError("{}: an image of {} x {} pixels, expected at least 1 x 1", file, header.rows,
                    header.cols);
  }
  if (header.pixels() > kMaxImagePixels) {
    throw DataError("{}: an image of {} x {} pixels, expected at most {} in all", file, header.rows,
                    header.cols, kMaxImagePixels);
  }
  constexpr std::size_t kBestCompression = 2048;  // deflate reaches 1032, LZW about 1400
  if (header.row_bytes() * header.rows / kBestCompression > file_bytes) {
    throw DataError("{}: announces {} but has only {} bytes, expected more", file, header.Describe(),
                    file_bytes);
  }
}

}  // namespace sonarcal::data_io
