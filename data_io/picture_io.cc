#include "data_io/picture_io.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "data_io/picture_frames.h"
#include "data_io/picture_geometry.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

fs::path GeometryFileOf(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return path / "geometry.json";
  return fs::path(path).concat(".geometry.json");
}

void CheckSize(const Grid<float>& picture, int rows, int cols, const std::string& name) {
  if (picture.rows() == rows && picture.cols() == cols) return;
  throw DataError("{}: {} x {} pixels, expected those of the first picture, {} x {}", name, picture.rows(),
                  picture.cols(), rows, cols);
}

// Pixels that are not black in any of the frames looked at.
Mask LitPixels(const PictureFrames& pictures) {
  constexpr int kMostFrames = 32;
  constexpr float kLossyBlack = 24.0F;  // what rings about an edge in a compressed picture
  const float black = pictures.is_lossy() ? kLossyBlack : 0.0F;
  const int count = std::min(pictures.count(), kMostFrames);
  Mask lit;
  for (int i = 0; i < count; ++i) {
    const int index = static_cast<int>(static_cast<std::int64_t>(i) * pictures.count() / count);
    const Grid<float> grey = pictures.Read(index);
    if (lit.empty()) lit = Mask(grey.rows(), grey.cols());
    CheckSize(grey, lit.rows(), lit.cols(), pictures.name(index));
    for (std::size_t k = 0; k < lit.size(); ++k) {
      if (grey.values()[k] > black) lit.values()[k] = 1;
    }
  }
  return lit;
}

FanGeometry FoundIn(const PictureFrames& pictures, const fs::path& path) {
  const std::optional<FanGeometry> fan = FindFanGeometry(LitPixels(pictures));
  if (!fan) {
    throw DataError(
        "{}: no fan could be made out in the picture; give its apex_px, radius_px and half_angle_deg, or "
        "'polar', in "
        "{}",
        path.string(), GeometryFileOf(path).string());
  }
  return *fan;
}

class PictureRecording final : public RecordingSource {
 public:
  PictureRecording(const fs::path& path, std::unique_ptr<PictureFrames> pictures, PictureGeometry geometry)
      : pictures_(std::move(pictures)) {
    const bool found = !geometry.polar && !geometry.fan;
    if (found) geometry.TakeFound(FoundIn(*pictures_, path));
    const Grid<float> first = pictures_->Read(0);
    sampler_.emplace(geometry, first.rows(), first.cols(), path.string());
    geometry.Describe(info_);
    info_.source = path.string();
    info_.format = geometry.polar ? "polar pictures" : "fan pictures";
    if (pictures_->is_lossy()) info_.format += ", compressed with losses";
    info_.sonar.axes = sampler_->axes();
    if (geometry.fan) {
      info_.details.emplace_back("fan in the picture", JsonOf(*geometry.fan));
      info_.notes.push_back(fmt::format("Where the fan lies in the picture was {}.",
                                        found ? "found by its edges, to about a pixel" : "given"));
      info_.notes.emplace_back(
          "Resampled from fan pictures, bilinear: neighbouring samples are not independent.");
    }
    info_.notes.emplace_back("Grey values are the viewer's: what it did to the recorded ones is not known.");
    if (pictures_->is_lossy())
      info_.notes.emplace_back(
          "The pictures were compressed with losses: grey values are not the viewer's own.");
    info_.valid = sampler_->inside();
    if (info_.valid) {
      const double outside =
          1.0 - static_cast<double>(CountSet(*info_.valid)) / static_cast<double>(info_.valid->size());
      info_.notes.push_back(
          fmt::format("{:.2g} % of the samples lie outside the picture and do not count.", 100.0 * outside));
    }
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return pictures_->count(); }
  FrameInfo frame_info(int index) const override {
    return {pictures_->name(index), pictures_->time_s(index), {}};
  }

  Frame ReadFrame(int index) const override {
    const Grid<float> picture = pictures_->Read(index);
    CheckSize(picture, sampler_->rows(), sampler_->cols(), info_.source + ": " + pictures_->name(index));
    return {frame_info(index), {info_.sonar.axes, info_.scale, sampler_->Apply(picture)}};
  }

 private:
  std::unique_ptr<PictureFrames> pictures_;
  RecordingInfo info_;
  std::optional<PictureSampler> sampler_;
};

}  // namespace

bool IsPictures(const fs::path& path) {
  if (IsPicture(path) || IsVideo(path)) return true;
  std::error_code error;
  const fs::directory_iterator files(path, error);
  return std::any_of(begin(files), end(files),
                     [](const fs::directory_entry& file) { return IsPicture(file.path()); });
}

std::unique_ptr<RecordingSource> OpenPictureRecording(const fs::path& path) {
  std::unique_ptr<PictureFrames> pictures = OpenPictures(path);
  const fs::path file = GeometryFileOf(path);
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw DataError(
        "{}: a picture does not say how far it reaches; write that into {}: {{\"format\": "
        "\"sonar-picture-geometry/1\", \"range_m\": [nearest, farthest], \"fan\": {{{}}}}}",
        path.string(), file.string(), JsonOf(FoundIn(*pictures, path)));
  }
  return std::make_unique<PictureRecording>(path, std::move(pictures), ReadPictureGeometry(file));
}

std::unique_ptr<RecordingSource> OpenPictureRecording(const fs::path& path, const PictureGeometry& geometry) {
  return std::make_unique<PictureRecording>(path, OpenPictures(path), geometry);
}

}  // namespace sonarcal
