#include "data_io/grey_png.h"

#include <algorithm>
#include <array>

#include <opencv2/imgcodecs.hpp>

#include "data_io/byte_reader.h"
#include "data_io/file_bytes.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

// PNG (ISO/IEC 15948) 5.2 and 11.2.2: signature, then the IHDR chunk, its numbers big-endian.
constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kHeaderBytes = 26;  // signature, chunk length and name, width .. colour type

// A PNG of noise is a little larger than its pixels; metadata may add to it.
constexpr std::size_t kMostMetadataBytes = 1 << 20;

std::uint32_t BigEndian32(std::span<const std::byte> bytes) {
  std::array<std::byte, 4> reversed;
  std::reverse_copy(bytes.begin(), bytes.begin() + 4, reversed.begin());
  return LittleEndian(reversed);
}

}  // namespace

std::optional<PngHeader> SniffPng(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  if (std::filesystem::file_size(file, error) < kHeaderBytes || error) return std::nullopt;
  const std::vector<std::byte> bytes = ReadFileRange(file, 0, kHeaderBytes, "PNG header");
  const auto same = [](std::uint8_t expected, std::byte found) { return std::byte{expected} == found; };
  if (!std::equal(kSignature.begin(), kSignature.end(), bytes.begin(), same)) return std::nullopt;
  const std::span<const std::byte> header(bytes);
  return PngHeader{.width = BigEndian32(header.subspan(16)),
                   .height = BigEndian32(header.subspan(20)),
                   .bit_depth = std::to_integer<std::uint8_t>(header[24]),
                   .colour_type = std::to_integer<std::uint8_t>(header[25])};
}

Grid<std::uint8_t> ReadGreyPng(const std::filesystem::path& file, int rows, int cols) {
  const std::optional<PngHeader> header = SniffPng(file);
  if (!header) throw DataError("{}: byte 0: no PNG signature and header, expected a PNG", file.string());
  const PngHeader expected{static_cast<std::uint32_t>(cols), static_cast<std::uint32_t>(rows), 8, 0};
  if (*header != expected) {
    throw DataError("{}: byte 16: PNG of {} x {}, {} bits, colour type {}; expected {} x {}, 8 bits, grey",
                    file.string(), header->width, header->height, header->bit_depth, header->colour_type,
                    cols, rows);
  }
  const std::size_t most_bytes = 2 * std::size_t(rows) * cols + kMostMetadataBytes;
  const std::string bytes = ReadFileBytes(file, most_bytes);
  cv::Mat decoded;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    decoded = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    decoded.release();
  }
  if (decoded.rows != rows || decoded.cols != cols || decoded.type() != CV_8UC1) {
    throw DataError("{}: damaged PNG, expected {} x {} intact pixels", file.string(), cols, rows);
  }
  Grid<std::uint8_t> grey(rows, cols);
  for (int row = 0; row < rows; ++row) {
    std::copy_n(decoded.ptr<std::uint8_t>(row), cols, grey.row(row).begin());
  }
  return grey;
}

}  // namespace sonarcal
