#include "data_io/images/image_io.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/files/file_bytes.h"
#include "data_io/images/png_codec.h"
#include "data_io/images/tiff_codec.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{512} << 20;

template <typename T>
Grid<T> GridFromBytes(const ImageHeader& header, const std::vector<std::byte>& bytes) {
  Grid<T> grid(header.rows, header.cols);
  SONARCAL_CHECK(bytes.size() == grid.values().size_bytes(), "{} bytes for {}", bytes.size(),
                 header.Describe());
  std::memcpy(grid.values().data(), bytes.data(), bytes.size());
  return grid;
}

template <typename T>
Grid<float> ToFloat(const Grid<T>& grid) {
  Grid<float> converted(grid.rows(), grid.cols());
  std::copy(grid.values().begin(), grid.values().end(), converted.values().begin());
  return converted;
}

template <typename T>
std::vector<std::uint8_t> EncodePixels(const Grid<T>& pixels, int channels) {
  const ImageHeader header{.rows = pixels.rows(),
                           .cols = pixels.cols(),
                           .channels = channels,
                           .bits = static_cast<int>(8 * sizeof(T)) / channels};
  return EncodePngSamples(header, std::as_bytes(pixels.values()));
}

void WriteEncoded(const std::filesystem::path& file, const std::vector<std::uint8_t>& encoded) {
  WriteFileWhole(file, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
}

}  // namespace

ImageFile::ImageFile(const std::filesystem::path& file)
    : ImageFile(ReadFileBytes(file, kMaxFileBytes), file.string()) {}

ImageFile::ImageFile(std::string bytes, std::string name)
    : name_(std::move(name)), bytes_(std::move(bytes)), is_png_(IsPng(bytes_)) {
  if (!is_png_ && !IsTiff(bytes_)) throw DataError("{}: neither a PNG nor a TIFF file", name_);
  header_ = is_png_ ? ReadPngHeader(bytes_, name_) : ReadTiffHeader(bytes_, name_);
}

template <typename T>
Grid<T> ImageFile::DecodeGreyAs(int bits, bool is_float) const {
  if (header_.channels != 1 || header_.bits != bits || header_.is_float != is_float) {
    throw DataError("{}: {}, expected {}-bit {}grey", name_, header_.Describe(), bits,
                    is_float ? "float " : "");
  }
  return GridFromBytes<T>(
      header_, is_png_ ? DecodePng(bytes_, PngSamples::kAsStored, name_) : DecodeTiff(bytes_, name_));
}

Grid<std::uint8_t> ImageFile::DecodeGrey8() const {
  return DecodeGreyAs<std::uint8_t>(8, false);
}

Grid<std::uint16_t> ImageFile::DecodeGrey16() const {
  return DecodeGreyAs<std::uint16_t>(16, false);
}

Grid<float> ImageFile::DecodeGrey() const {
  if (header_.is_float) return DecodeGreyAs<float>(32, true);
  if (header_.bits == 16) return ToFloat(DecodeGrey16());
  return ToFloat(DecodeGrey8());
}

RgbImage ImageFile::DecodeRgb() const {
  if (!is_png_) throw DataError("{}: a TIFF, expected a PNG for a colour picture", name_);
  const std::vector<std::byte> bytes = DecodePng(bytes_, PngSamples::kRgb8, name_);
  return GridFromBytes<std::array<std::uint8_t, 3>>(header_, bytes);
}

Mask ReadMask(const std::filesystem::path& file) {
  const Grid<float> grey = ImageFile(file).DecodeGrey();
  Mask mask(grey.rows(), grey.cols());
  std::ranges::transform(grey.values(), mask.values().begin(),
                         [](float value) { return std::uint8_t{value > 0.0F}; });
  return mask;
}

std::vector<std::uint8_t> EncodePng(const Grid<std::uint8_t>& grey) {
  return EncodePixels(grey, 1);
}
std::vector<std::uint8_t> EncodePng(const Grid<std::uint16_t>& grey) {
  return EncodePixels(grey, 1);
}
std::vector<std::uint8_t> EncodePng(const RgbImage& image) {
  return EncodePixels(image, 3);
}

void WritePng(const std::filesystem::path& file, const Grid<std::uint8_t>& grey) {
  WriteEncoded(file, EncodePng(grey));
}
void WritePng(const std::filesystem::path& file, const Grid<std::uint16_t>& grey) {
  WriteEncoded(file, EncodePng(grey));
}
void WritePng(const std::filesystem::path& file, const RgbImage& image) {
  WriteEncoded(file, EncodePng(image));
}

void WriteTiff(const std::filesystem::path& file, const Grid<float>& value) {
  WriteEncoded(file, EncodeFloatTiff(value.rows(), value.cols(), value.values()));
}

}  // namespace sonarcal::data_io
