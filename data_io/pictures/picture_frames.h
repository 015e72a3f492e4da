// Pictures exported by viewers, read one after the other as grey values: PNG or JPEG files, or a video that
// OpenCV can decode (AVI, MP4, ...). The only file that uses OpenCV's video functions.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/types/image.h"
#include "core/types/rgb_image.h"

namespace sonarcal::data_io {

// IsPicture: the file begins like a PNG, a JPEG or a video container. IsVideo: like a video container.
bool IsPicture(const std::filesystem::path& file);
bool IsVideo(const std::filesystem::path& file);

class PictureFrames {
 public:
  virtual ~PictureFrames() = default;

  virtual int count() const = 0;
  virtual std::string name(int index) const = 0;
  virtual std::optional<double> time_s(int) const { return std::nullopt; }

  // Grey values 0..255, with fractions if the picture has 16 bits; the luminance of a colour picture. Throws
  // DataError if a picture is damaged or larger than kMaxImagePixels.
  virtual Grid<float> Read(int index) const = 0;

  // Colours of the same picture. Throws DataError like Read.
  virtual RgbImage ReadColors(int index) const = 0;

  // True if pixels were compressed with losses, so black is only nearly black.
  virtual bool is_lossy() const = 0;
};

// Opens one picture, the pictures of a folder in the order of their names, or a video. Throws DataError if
// there is none, if a video has no size or number of frames, or if its codec cannot be decoded.
std::unique_ptr<PictureFrames> OpenPictures(const std::filesystem::path& path);

// Pictures directly in `folder`, in natural order of their names; empty if it is no folder.
std::vector<std::filesystem::path> PicturesOf(const std::filesystem::path& folder);

}  // namespace sonarcal::data_io
