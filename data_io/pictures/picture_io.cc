#include "data_io/pictures/picture_io.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pictures/picture_geometry.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

fs::path GeometryFileOf(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return path / "geometry.json";
  return fs::path(path).concat(".geometry.json");
}

[[noreturn]] void FailOfSize(int rows, int cols, int first_rows, int first_cols, const std::string& name) {
  throw DataError("{}: {} x {} pixels, expected those of the first picture, {} x {}", name, rows, cols,
                  first_rows, first_cols);
}

void CheckSize(const Grid<float>& picture, int rows, int cols, const std::string& name) {
  if (picture.rows() != rows || picture.cols() != cols)
    FailOfSize(picture.rows(), picture.cols(), rows, cols, name);
}

// Pixels of a frame that are not black.
Mask LitPixels(const PictureFrames& pictures, int index) {
  constexpr float kLossyBlack = 24.0F;  // limit for ringing at edges in a compressed picture
  const float black = pictures.is_lossy() ? kLossyBlack : 0.0F;
  const Grid<float> grey = pictures.Read(index);
  Mask lit(grey.rows(), grey.cols());
  std::transform(grey.values().begin(), grey.values().end(), lit.values().begin(),
                 [black](float value) { return std::uint8_t{value > black}; });
  return lit;
}

constexpr int kMaxFrames = 32;  // frames in which the fan is searched

// Up to `max_count` frames, evenly spread.
std::vector<int> FramesToLookAt(const PictureFrames& pictures, int max_count = kMaxFrames) {
  const int count = std::min(pictures.count(), max_count);
  std::vector<int> indices;
  for (int i = 0; i < count; ++i)
    indices.push_back(static_cast<int>(static_cast<std::int64_t>(i) * pictures.count() / count));
  return indices;
}

// Pixels that are not black in any of the examined frames.
Mask LitInAny(const PictureFrames& pictures) {
  Mask lit;
  for (const int index : FramesToLookAt(pictures)) {
    const Mask own = LitPixels(pictures, index);
    if (lit.empty()) lit = Mask(own.rows(), own.cols());
    if (own.rows() != lit.rows() || own.cols() != lit.cols())
      FailOfSize(own.rows(), own.cols(), lit.rows(), lit.cols(), pictures.name(index));
    std::transform(own.values().begin(), own.values().end(), lit.values().begin(), lit.values().begin(),
                   [](std::uint8_t a, std::uint8_t b) { return std::uint8_t{a != 0 || b != 0}; });
  }
  return lit;
}

// One fan is read for all pictures. Throws DataError if some pictures show another fan.
void RefuseAnotherFan(const PictureFrames& pictures, const FanGeometry& fan, const fs::path& path) {
  constexpr int kMaxPictures = 512;  // files are read quickly, video frames slowly
  std::vector<int> others;
  const std::vector<int> looked_at = FramesToLookAt(pictures, IsVideo(path) ? kMaxFrames : kMaxPictures);
  for (const int index : looked_at) {
    if (ShowsAnotherFan(LitPixels(pictures, index), fan)) others.push_back(index);
  }
  if (others.empty()) return;
  constexpr std::size_t kMaxNamed = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(others.size(), kMaxNamed); ++i)
    names += (i == 0 ? "" : ", ") + pictures.name(others[i]);
  throw DataError(
      "{}: {} of the {} pictures looked at show another fan than the others ({}{}), expected one window of "
      "range "
      "for all: move the pictures of each window into a folder of their own; or, if these are dark at a "
      "side, "
      "give apex_px, radius_px and half_angle_deg in {}",
      path.string(), others.size(), looked_at.size(), names, others.size() > kMaxNamed ? ", ..." : "",
      GeometryFileOf(path).string());
}

FanGeometry FoundIn(const PictureFrames& pictures, const fs::path& path) {
  const std::optional<FanGeometry> fan = FindFanGeometry(LitInAny(pictures));
  if (!fan) {
    throw DataError(
        "{}: no fan could be made out in the picture; give its apex_px, radius_px and half_angle_deg, or "
        "'polar', in "
        "{}",
        path.string(), GeometryFileOf(path).string());
  }
  RefuseAnotherFan(pictures, *fan, path);
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
    if (!geometry.range_min_m) {
      info_.notes.push_back(
          fmt::format("The nearest range, {:.3f} m, was determined by the radii of the fan.",
                      info_.sonar.axes.range_min_m));
    }
    if (geometry.fan) {
      info_.details.emplace_back("fan in the picture", JsonOf(*geometry.fan));
      info_.notes.push_back(fmt::format("The position of the fan in the picture was {}.",
                                        found ? "found by its edges, to about a pixel" : "given"));
      info_.notes.emplace_back(
          "Resampled from fan pictures, bilinear: neighbouring samples are not independent.");
    }
    info_.notes.emplace_back("Grey values are those of the viewer; its processing is not known.");
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

bool HasPictureGeometry(const fs::path& path) {
  std::error_code error;
  return fs::exists(GeometryFileOf(path), error) && IsPictures(path);
}

std::unique_ptr<RecordingSource> OpenPictureRecording(const fs::path& path) {
  std::unique_ptr<PictureFrames> pictures = OpenPictures(path);
  const fs::path file = GeometryFileOf(path);
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw DataError(
        "{}: a picture does not contain its range; write it into {}: {{\"format\": "
        "\"sonar-picture-geometry/1\", \"range_m\": [farthest], \"fan\": {{{}}}}}",
        path.string(), file.string(), JsonOf(FoundIn(*pictures, path)));
  }
  return std::make_unique<PictureRecording>(path, std::move(pictures), ReadPictureGeometry(file));
}

std::unique_ptr<RecordingSource> OpenPictureRecording(const fs::path& path, const PictureGeometry& geometry) {
  return std::make_unique<PictureRecording>(path, OpenPictures(path), geometry);
}

}  // namespace sonarcal::data_io
