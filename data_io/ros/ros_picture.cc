#include "data_io/ros/ros_picture.h"

#include <algorithm>
#include <cstdint>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/images/image_io.h"
#include "data_io/images/jpeg_codec.h"

namespace sonarcal::data_io {
namespace {

std::uint64_t SampleBytes(const std::string& encoding, const std::string& where) {
  if (encoding == "mono8" || encoding == "8UC1") return 1;
  if (encoding == "mono16" || encoding == "16UC1") return 2;
  throw DataError("{}: a picture of encoding '{}', expected mono8, 8UC1, mono16 or 16UC1", where,
                  Printable(encoding));
}

RosPicture DecodeJpeg(std::string_view bytes, const std::string& where) {
  const ImageHeader header = ReadJpegHeader(bytes, where);
  if (header.channels != 1 || header.bits != 8) {
    throw DataError("{}: a JPEG of {} channels of {} bits, expected one of 8 (grey)", where, header.channels,
                    header.bits);
  }
  const Grid<std::uint8_t> grey = DecodeJpegGrey(bytes, where);
  RosPicture picture{.value = Grid<float>(grey.rows(), grey.cols())};
  std::ranges::copy(grey.values(), picture.value.values().begin());
  return picture;
}

}  // namespace

RosPicture PictureOf(const RosImage& image, const std::string& where) {
  const std::uint64_t sample_bytes = SampleBytes(image.encoding, where);
  const std::uint64_t row_bytes = image.width * sample_bytes;
  if (image.height == 0 || image.width == 0 || image.row_bytes < row_bytes ||
      std::uint64_t{image.row_bytes} * image.height != image.data.size()) {
    throw DataError("{}: a picture of {} x {} pixels of {} bytes, {} bytes a row, in {} bytes; they disagree",
                    where, image.height, image.width, sample_bytes, image.row_bytes, image.data.size());
  }
  RosPicture picture{Grid<float>(static_cast<int>(image.height), static_cast<int>(image.width)),
                     sample_bytes == 1 ? 255.0 : 65535.0};
  for (int row = 0; row < picture.value.rows(); ++row) {
    const std::byte* next = image.data.data() + std::uint64_t{image.row_bytes} * row;
    for (float& value : picture.value.row(row)) {
      const auto first = std::to_integer<std::uint32_t>(next[0]);
      const auto last = std::to_integer<std::uint32_t>(next[sample_bytes - 1]);
      if (sample_bytes == 1) {
        value = static_cast<float>(first);
      } else {
        value = static_cast<float>(image.is_big_endian ? first << 8 | last : last << 8 | first);
      }
      next += sample_bytes;
    }
  }
  return picture;
}

RosPicture PictureOf(const RosCompressedImage& image, const std::string& where) {
  const std::string_view bytes(reinterpret_cast<const char*>(image.data.data()), image.data.size());
  if (IsJpeg(bytes)) return DecodeJpeg(bytes, where);
  if (!bytes.starts_with("\x89PNG")) {
    throw DataError("{}: a compressed picture of format '{}', expected PNG or JPEG", where,
                    Printable(image.format));
  }
  const ImageFile file(std::string(bytes), where);
  return {file.DecodeGrey(), file.header().bits == 8 ? 255.0 : 65535.0};
}

}  // namespace sonarcal::data_io
