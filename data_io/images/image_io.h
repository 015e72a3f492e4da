// Image files: PNG of 8 or 16 bits, grey or colour, and grey TIFF of 8 or 16 bits or float.
//
//   const ImageFile file("frame_0000.png");
//   if (file.header().rows != range_bins) ...      // known before any pixel is decoded
//   const Grid<float> value = file.DecodeGrey();
//
// Row 0 is the top row of the file. The header is checked before any allocation
// (data_io/images/image_header.h). There is no implicit conversion: a colour image is not accepted as grey,
// nor 16 bits as 8.
//
// All functions throw DataError with the file's name if a file is absent, of another type, or damaged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/rgb_image.h"
#include "data_io/images/image_header.h"

namespace sonarcal::data_io {

// Encoded image in memory, with its header.
class ImageFile {
 public:
  explicit ImageFile(const std::filesystem::path& file);
  ImageFile(std::string bytes, std::string name);  // `name` for messages

  const ImageHeader& header() const { return header_; }

  Grid<std::uint8_t> DecodeGrey8() const;
  Grid<std::uint16_t> DecodeGrey16() const;
  Grid<float> DecodeGrey() const;  // 8 or 16 bits or float; the stored numbers, not scaled
  // any PNG: grey repeated, palettes resolved, alpha dropped, 16 bits truncated to 8
  RgbImage DecodeRgb() const;

 private:
  template <typename T>
  Grid<T> DecodeGreyAs(int bits, bool is_float) const;

  std::string name_;
  std::string bytes_;
  bool is_png_;
  ImageHeader header_;
};

// A grey image as a mask: 1 for each pixel above 0.
Mask ReadMask(const std::filesystem::path& file);

std::vector<std::uint8_t> EncodePng(const Grid<std::uint8_t>& grey);
std::vector<std::uint8_t> EncodePng(const Grid<std::uint16_t>& grey);
std::vector<std::uint8_t> EncodePng(const RgbImage& image);

// Write the whole file or nothing (data_io/files/atomic_output.h).
void WritePng(const std::filesystem::path& file, const Grid<std::uint8_t>& grey);
void WritePng(const std::filesystem::path& file, const Grid<std::uint16_t>& grey);
void WritePng(const std::filesystem::path& file, const RgbImage& image);
void WriteTiff(const std::filesystem::path& file, const Grid<float>& value);

}  // namespace sonarcal::data_io
