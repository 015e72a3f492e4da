#include "data_io/pictures/picture_io.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "data_io/pictures/fan_search.h"
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

void CheckSize(const Grid<float>& picture, int rows, int cols, const std::string& name) {
  if (picture.rows() != rows || picture.cols() != cols)
    FailOfPictureSize(picture.rows(), picture.cols(), rows, cols, name);
}

// One fan is read for all pictures. Throws DataError if some pictures show another fan.
void RefuseAnotherFan(const PictureFrames& pictures, const FanSearch& search, const fs::path& path) {
  constexpr int kMaxPictures = 512;  // files are read quickly, video frames slowly
  constexpr int kMaxFrames = 32;
  std::vector<int> others;
  const std::vector<int> looked_at = EvenlySpreadFrames(pictures, IsVideo(path) ? kMaxFrames : kMaxPictures);
  for (const int index : looked_at) {
    if (ShowsAnotherFan(search.LitPixels(index), *search.fan())) others.push_back(index);
  }
  if (others.empty()) return;
  constexpr std::size_t kMaxNamed = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(others.size(), kMaxNamed); ++i)
    names += (i == 0 ? "" : ", ") + pictures.name(others[i]);
  throw DataError(
      "{}: {} of the {} pictures looked at show another fan than the others ({}{}), expected one window of "
      "range for all: move the pictures of each window into a folder of their own; or, if these are dark at "
      "a side, give apex_px, radius_px and half_angle_deg in {}",
      path.string(), others.size(), looked_at.size(), names, others.size() > kMaxNamed ? ", ..." : "",
      GeometryFileOf(path).string());
}

struct FoundFan {
  FanGeometry geometry;
  std::string doubt;  // sentence on an outline that is dark; empty if it is clear
};

// A sentence if less than half of a side or of the far arc is lit.
std::string DoubtOf(const FanVisibility& visible) {
  constexpr double kClear = 0.5;
  if (visible.min() >= kClear) return {};
  return fmt::format(
      "The outline of the fan is dark in places, so check its position: {:.0f} % of the left side, {:.0f} % "
      "of the right side and {:.0f} % of the far arc are lit.",
      100.0 * visible.left_side, 100.0 * visible.right_side, 100.0 * visible.far_arc);
}

FoundFan FoundIn(const PictureFrames& pictures, const fs::path& path) {
  const FanSearch search(pictures);
  if (!search.fan()) {
    throw DataError(
        "{}: no fan could be made out in the picture; give its apex_px, radius_px and half_angle_deg, or "
        "'polar', in "
        "{}",
        path.string(), GeometryFileOf(path).string());
  }
  RefuseAnotherFan(pictures, search, path);
  return {*search.fan(), DoubtOf(search.visibility())};
}

class PictureRecording final : public RecordingSource {
 public:
  PictureRecording(const fs::path& path, std::unique_ptr<PictureFrames> pictures, PictureGeometry geometry)
      : pictures_(std::move(pictures)) {
    const bool found = !geometry.polar && !geometry.fan;
    if (found) {
      const FoundFan fan = FoundIn(*pictures_, path);
      geometry.TakeFound(fan.geometry);
      if (!fan.doubt.empty()) info_.notes.push_back(fan.doubt);
    }
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
    const FoundFan found = FoundIn(*pictures, path);
    throw DataError(
        "{}: a picture does not contain its range; write it into {}: {{\"format\": "
        "\"sonar-picture-geometry/1\", \"range_m\": [farthest], \"fan\": {{{}}}}}{}",
        path.string(), file.string(), JsonOf(found.geometry), found.doubt.empty() ? "" : ". " + found.doubt);
  }
  return std::make_unique<PictureRecording>(path, std::move(pictures), ReadPictureGeometry(file));
}

std::unique_ptr<RecordingSource> OpenPictureRecording(const fs::path& path, const PictureGeometry& geometry) {
  return std::make_unique<PictureRecording>(path, OpenPictures(path), geometry);
}

}  // namespace sonarcal::data_io
