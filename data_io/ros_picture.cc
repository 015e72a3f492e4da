#include "data_io/ros_picture.h"

#include <cstdint>

#include <opencv2/imgcodecs.hpp>

#include "data_io/byte_reader.h"
#include "data_io/image_header.h"
#include "data_io/image_io.h"
#include "data_io/printable.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

std::uint64_t SampleBytes(const std::string& encoding, const std::string& where) {
  if (encoding == "mono8" || encoding == "8UC1") return 1;
  if (encoding == "mono16" || encoding == "16UC1") return 2;
  throw DataError("{}: a picture of encoding '{}', expected mono8, 8UC1, mono16 or 16UC1", where,
                  Printable(encoding));
}

// What a JPEG's start-of-frame segment announces.
ImageHeader ReadJpegHeader(std::span<const std::byte> bytes, const std::string& where) {
  const ByteReader reader(bytes, where);
  const auto u16 = [&](std::uint64_t at) {  // big-endian
    return reader.U8(at, "JPEG segment") << 8 | reader.U8(at + 1, "JPEG segment");
  };
  for (std::uint64_t at = 2; reader.U8(at, "JPEG segment") == 0xff;) {
    const std::uint8_t marker = reader.U8(at + 1, "JPEG segment");
    if (marker == 0xff) {  // padding
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      return {.rows = u16(at + 5),
              .cols = u16(at + 7),
              .channels = reader.U8(at + 9, "JPEG components"),
              .bits = reader.U8(at + 4, "JPEG precision")};
    }
    at += 2 + static_cast<std::uint64_t>(u16(at + 2));
  }
  throw DataError("{}: a JPEG without a frame, or a damaged one", where);
}

RosPicture DecodeJpeg(std::span<const std::byte> bytes, const std::string& where) {
  const ImageHeader header = ReadJpegHeader(bytes, where);
  if (header.channels != 1 || header.bits != 8) {
    throw DataError("{}: a JPEG of {} channels of {} bits, expected one of 8 (grey)", where, header.channels,
                    header.bits);
  }
  CheckImageHeader(header, bytes.size(), where);
  cv::Mat decoded;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::byte*>(bytes.data()));
    decoded = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    decoded.release();  // said below
  }
  if (decoded.type() != CV_8UC1 || decoded.rows != header.rows || decoded.cols != header.cols)
    throw DataError("{}: the JPEG is damaged", where);
  RosPicture picture{.value = Grid<float>(header.rows, header.cols)};
  for (int row = 0; row < header.rows; ++row) {
    for (int col = 0; col < header.cols; ++col) picture.value(row, col) = decoded.at<std::uint8_t>(row, col);
  }
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
  if (bytes.starts_with("\xff\xd8")) return DecodeJpeg(image.data, where);
  if (!bytes.starts_with("\x89PNG")) {
    throw DataError("{}: a compressed picture of format '{}', expected PNG or JPEG", where,
                    Printable(image.format));
  }
  const ImageFile file(std::string(bytes), where);
  return {file.DecodeGrey(), file.header().bits == 8 ? 255.0 : 65535.0};
}

}  // namespace sonarcal
