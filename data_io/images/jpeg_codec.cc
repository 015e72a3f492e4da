#include "data_io/images/jpeg_codec.h"

#include <algorithm>
#include <span>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {
namespace {

constexpr const char* kSegment = "JPEG segment";  // in messages

bool IsFrame(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}
bool IsScan(std::uint8_t marker) {
  return marker == 0xda;
}

// Number of the two bytes at `at`, big-endian.
int U16(const ByteReader& reader, std::uint64_t at) {
  return reader.U8(at, kSegment) << 8 | reader.U8(at + 1, kSegment);
}

// Position of the first segment of a kind. Throws DataError, naming `what`, if there is none.
std::uint64_t FindSegment(const ByteReader& reader, bool (*is_wanted)(std::uint8_t marker),
                          const char* what) {
  std::uint64_t at = 2;
  while (reader.U8(at, kSegment) == 0xff) {
    const std::uint8_t marker = reader.U8(at + 1, kSegment);
    if (marker == 0xff) {  // padding
      ++at;
      continue;
    }
    if (is_wanted(marker)) return at;
    at += 2 + static_cast<std::uint64_t>(U16(reader, at + 2));
  }
  throw DataError("{}: byte {}: a JPEG without a {}, or a damaged one", reader.file(), at, what);
}

// Decodes to `type`, CV_8UC1 or CV_8UC3.
cv::Mat Decode(std::string_view bytes, const std::string& name, int type) {
  const ImageHeader header = ReadJpegHeader(bytes, name);
  // The decoder fills missing data without an error. A complete file ends with the end marker, possibly
  // padded. A thumbnail before the first scan has an end marker of its own.
  const ByteReader reader(std::as_bytes(std::span(bytes)), name);
  if (bytes.find("\xff\xd9", FindSegment(reader, IsScan, "scan")) == std::string_view::npos)
    throw DataError("{}: truncated JPEG, expected an end marker", name);
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    const int flags = type == CV_8UC1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR;
    image = cv::imdecode(encoded, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw DataError("{}: damaged JPEG: {}", name, error.err);
  }
  if (image.rows != header.rows || image.cols != header.cols || image.type() != type)
    throw DataError("{}: damaged JPEG, expected {} x {} pixels", name, header.rows, header.cols);
  return image;
}

}  // namespace

bool IsJpeg(std::string_view bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

ImageHeader ReadJpegHeader(std::string_view bytes, const std::string& name) {
  // OpenCV would decode other formats, which nothing has checked.
  if (!IsJpeg(bytes)) throw DataError("{}: not a JPEG, expected one", name);
  const ByteReader reader(std::as_bytes(std::span(bytes)), name);
  const std::uint64_t at = FindSegment(reader, IsFrame, "frame");
  const ImageHeader header{.rows = U16(reader, at + 5),
                           .cols = U16(reader, at + 7),
                           .channels = reader.U8(at + 9, "JPEG components"),
                           .bits = reader.U8(at + 4, "JPEG precision")};
  // CheckImageHeader is not used: a JPEG of one colour is smaller than it accepts.
  if (header.pixels() <= 0 || header.pixels() > kMaxImagePixels) {
    throw DataError("{}: a JPEG of {} x {} pixels, expected 1 to {} pixels", name, header.rows, header.cols,
                    kMaxImagePixels);
  }
  return header;
}

Grid<std::uint8_t> DecodeJpegGrey(std::string_view bytes, const std::string& name) {
  const cv::Mat image = Decode(bytes, name, CV_8UC1);
  Grid<std::uint8_t> grey(image.rows, image.cols);
  for (int row = 0; row < image.rows; ++row)
    std::copy_n(image.ptr<std::uint8_t>(row), image.cols, grey.row(row).begin());
  return grey;
}

RgbImage DecodeJpegRgb(std::string_view bytes, const std::string& name) {
  const cv::Mat image = Decode(bytes, name, CV_8UC3);
  RgbImage rgb(image.rows, image.cols);
  for (int row = 0; row < image.rows; ++row) {
    const auto* pixels = image.ptr<cv::Vec3b>(row);
    // OpenCV's channels begin with blue.
    for (int col = 0; col < image.cols; ++col)
      rgb(row, col) = {pixels[col][2], pixels[col][1], pixels[col][0]};
  }
  return rgb;
}

}  // namespace sonarcal::data_io
