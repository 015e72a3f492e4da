#include "data_io/images/grey_frame.h"

#include <array>
#include <fstream>

#include "core/types/error.h"
#include "data_io/images/image_io.h"
#include "data_io/images/png_codec.h"

namespace sonarcal::data_io {

std::optional<ImageHeader> SniffPng(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  std::array<char, 8> signature{};
  std::ifstream(file, std::ios::binary).read(signature.data(), signature.size());
  if (!IsPng({signature.data(), signature.size()})) return std::nullopt;
  try {
    return ImageFile(file).header();
  } catch (const DataError&) {
    return std::nullopt;
  }
}

Grid<float> ReadGreyFrame(const std::filesystem::path& file, int rows, int cols) {
  const ImageFile image(file);
  const ImageHeader& header = image.header();
  const ImageHeader expected{.rows = rows, .cols = cols, .channels = 1, .bits = 8};
  if (header.rows != rows || header.cols != cols || header.channels != 1 || header.bits != 8) {
    throw DataError("{}: {}, expected {}", file.string(), header.Describe(), expected.Describe());
  }
  return image.DecodeGrey();
}

}  // namespace sonarcal::data_io
