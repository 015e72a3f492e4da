// Pictures as viewers export them, one after the other, as grey values: PNG or JPEG files, or a video that
// OpenCV can decode (AVI, MP4, ...). The one place that sees OpenCV's video.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/types/image.h"

namespace sonarcal::data_io {

// Whether a file's first bytes are those of a JPEG or of a video's container, or of a PNG.
bool IsPicture(const std::filesystem::path& file);
bool IsVideo(const std::filesystem::path& file);

class PictureFrames {
 public:
  virtual ~PictureFrames() = default;

  virtual int count() const = 0;
  virtual std::string name(int index) const = 0;
  virtual std::optional<double> time_s(int) const { return std::nullopt; }

  // 0..255; of a colour picture the luminance. Throws DataError where a picture is damaged or larger than
  // kMaxImagePixels.
  virtual Grid<float> Read(int index) const = 0;

  // Whether pixels were compressed with losses, so that black is only nearly black.
  virtual bool is_lossy() const = 0;
};

// One picture, the pictures of a folder in the order of their names, or a video. Throws DataError where there
// is none, or a video tells no size or number of frames.
std::unique_ptr<PictureFrames> OpenPictures(const std::filesystem::path& path);

// Pictures directly in `folder`, by name, numbers in it as numbers; none where it is no folder.
std::vector<std::filesystem::path> PicturesOf(const std::filesystem::path& folder);

}  // namespace sonarcal::data_io
