#include "data_io/fan_picture_io.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "data_io/fan_geometry.h"
#include "data_io/json_reader.h"
#include "data_io/picture_frames.h"
#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

fs::path DescriptionOf(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return path / "fan.json";
  return fs::path(path).concat(".fan.json");
}

struct Description {
  RecordingInfo info;  // but for the beams, where not given
  std::optional<FanGeometry> geometry;
  std::optional<double> half_angle_deg;  // without the rest of the geometry
  int beams = 0;                         // 0: by the picture
};

Description ReadDescription(const fs::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  if (json.At("format").String() != "sonar-fan-picture/1")
    json.At("format").Fail("is another format, expected \"sonar-fan-picture/1\"");
  Description description;
  RecordingInfo& info = description.info;
  constexpr double kMostRangeM = 10'000.0;
  const JsonReader range_m = json.At("range_m");
  const std::vector<double> range = range_m.Numbers(NumberRange::Between(0.0, kMostRangeM));
  if (range.size() != 2 || !(range[1] > range[0])) range_m.Fail("must be two ranges, the nearer first");
  info.sonar.axes.range_min_m = range[0];
  info.sonar.axes.range_max_m = range[1];
  if (const auto bins = json.Find("range_bins"))
    info.sonar.axes.range_bins = static_cast<int>(bins->Integer(1, 65536));
  if (const auto beams = json.Find("beams")) description.beams = static_cast<int>(beams->Integer(2, 4096));
  if (const auto name = json.Find("name")) info.sonar.name = name->String();
  json.Update("frequency_hz", info.sonar.frequency_hz, NumberRange::Above(0.0));
  json.Update("sound_speed_m_per_s", info.sonar.sound_speed_m_per_s, NumberRange::Between(1300.0, 1700.0));
  json.Update("azimuth_beam_width_deg", info.sonar.azimuth_beam_width_deg, NumberRange::AboveUpTo(0.0, 90.0));
  json.Update("elevation_beam_width_deg", info.sonar.elevation_beam_width_deg,
              NumberRange::AboveUpTo(0.0, 180.0));
  info.scale.db_span = json.FindNumber("db_span", NumberRange::AboveUpTo(0.0, 1000.0));

  const auto half_angle = json.FindNumber("half_angle_deg", NumberRange::Between(0.5, 89.0));
  const auto apex = json.Find("apex_px");
  const auto radius = json.Find("radius_px");
  const auto x_scale = json.FindNumber("x_scale", NumberRange::Between(0.1, 10.0));
  if (!apex && !radius) {
    if (x_scale) json.At("x_scale").Fail("stands without apex_px, radius_px and half_angle_deg");
    description.half_angle_deg = half_angle;
  } else {
    if (!apex || !radius || !half_angle)
      json.Fail("needs apex_px, radius_px and half_angle_deg together, or none of the first two");
    const std::vector<double> at = apex->Numbers();
    const std::vector<double> radii = radius->Numbers();
    if (at.size() != 2) apex->Fail("must be two numbers, x and y");
    if (radii.size() != 2) radius->Fail("must be two numbers, of the near and the far arc");
    description.geometry = FanGeometry{at[0], at[1], radii[0], radii[1], *half_angle, x_scale.value_or(1.0)};
    description.geometry->Validate(file.string());
  }
  json.Finish();
  return description;
}

// Pixels that are not black in any of the frames looked at.
Mask LitPixels(const PictureFrames& pictures) {
  constexpr int kMostFrames = 32;
  constexpr float kLossyBlack = 24.0F;  // what rings about an edge in a compressed picture
  const int count = std::min(pictures.count(), kMostFrames);
  Mask lit;
  for (int i = 0; i < count; ++i) {
    const int index = static_cast<int>(static_cast<std::int64_t>(i) * pictures.count() / count);
    const Grid<float> grey = pictures.Read(index);
    if (lit.empty()) lit = Mask(grey.rows(), grey.cols());
    if (grey.rows() != lit.rows() || grey.cols() != lit.cols()) {
      throw DataError("{}: {} x {} pixels, expected those of the first picture, {} x {}",
                      pictures.name(index), grey.rows(), grey.cols(), lit.rows(), lit.cols());
    }
    const float black = pictures.is_lossy() ? kLossyBlack : 0.0F;
    for (std::size_t k = 0; k < lit.size(); ++k) {
      if (grey.values()[k] > black) lit.values()[k] = 1;
    }
  }
  return lit;
}

std::string JsonOf(const FanGeometry& fan) {
  return fmt::format(
      "\"apex_px\": [{:.1f}, {:.1f}], \"radius_px\": [{:.1f}, {:.1f}], \"half_angle_deg\": {:.2f}, "
      "\"x_scale\": "
      "{:.3f}",
      fan.apex_x_px, fan.apex_y_px, fan.radius_min_px, fan.radius_max_px, fan.half_angle_deg, fan.x_scale);
}

FanGeometry FoundIn(const PictureFrames& pictures, const std::string& path) {
  const std::optional<FanGeometry> fan = FindFanGeometry(LitPixels(pictures));
  if (!fan) {
    throw DataError(
        "{}: no fan could be made out in the picture; give apex_px, radius_px and half_angle_deg in {}", path,
        DescriptionOf(path).string());
  }
  return *fan;
}

// Four picture pixels about a polar pixel's centre; weights of the right and the lower ones.
struct Sample {
  int picture_index = -1;  // of the upper left; -1 outside the picture
  float right = 0.0F;
  float below = 0.0F;
};

class FanPictures final : public RecordingSource {
 public:
  FanPictures(const fs::path& path, std::unique_ptr<PictureFrames> pictures, Description description)
      : pictures_(std::move(pictures)), info_(std::move(description.info)) {
    const bool given = description.geometry.has_value();
    FanGeometry fan = given ? *description.geometry : FoundIn(*pictures_, path.string());
    if (description.half_angle_deg) {
      fan.x_scale *=
          std::tan(RadFromDeg(fan.half_angle_deg)) / std::tan(RadFromDeg(*description.half_angle_deg));
      fan.half_angle_deg = *description.half_angle_deg;
    }
    const Grid<float> first = pictures_->Read(0);
    rows_ = first.rows();
    cols_ = first.cols();
    info_.source = path.string();
    info_.format = pictures_->is_lossy() ? "fan pictures, compressed with losses" : "fan pictures";
    LayOutAxes(fan, description.beams);
    LayOutSamples(fan);
    info_.details.emplace_back("fan in the picture", JsonOf(fan));
    info_.notes.push_back(fmt::format("Where the fan lies in the picture was {}.",
                                      given ? "given" : "found by its edges, to about a pixel"));
    info_.notes.emplace_back(
        "Resampled from fan pictures, bilinear: neighbouring samples are not independent, and grey values "
        "are "
        "the viewer's.");
    if (pictures_->is_lossy())
      info_.notes.emplace_back(
          "The pictures were compressed with losses: grey values are not the recorded ones.");
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return pictures_->count(); }
  FrameInfo frame_info(int index) const override {
    return {pictures_->name(index), pictures_->time_s(index), {}};
  }

  Frame ReadFrame(int index) const override {
    const Grid<float> picture = pictures_->Read(index);
    if (picture.rows() != rows_ || picture.cols() != cols_) {
      throw DataError("{}: {}: {} x {} pixels, expected those of the first picture, {} x {}", info_.source,
                      pictures_->name(index), picture.rows(), picture.cols(), rows_, cols_);
    }
    const PolarAxes& axes = info_.sonar.axes;
    Frame frame{frame_info(index), {axes, info_.scale, Grid<float>(axes.range_bins, axes.beam_count())}};
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& sample = samples_[i];
      if (sample.picture_index < 0) continue;
      const float* pixel = &picture.values()[sample.picture_index];
      const float above = pixel[0] + sample.right * (pixel[1] - pixel[0]);
      const float below = pixel[cols_] + sample.right * (pixel[cols_ + 1] - pixel[cols_]);
      frame.image.value.values()[i] = above + sample.below * (below - above);
    }
    return frame;
  }

 private:
  void LayOutAxes(const FanGeometry& fan, int beams) {
    PolarAxes& axes = info_.sonar.axes;
    const double half_rad = RadFromDeg(fan.half_angle_deg);
    // As fine as the picture: a bin a pixel of range, a beam a pixel of the far arc.
    if (axes.range_bins == 0)
      axes.range_bins = std::max(1, static_cast<int>(std::lround(fan.radius_max_px - fan.radius_min_px)));
    if (beams == 0)
      beams = std::clamp(static_cast<int>(std::lround(2.0 * half_rad * fan.radius_max_px * fan.x_scale)), 2,
                         4096);
    for (int beam = 0; beam < beams; ++beam)
      axes.beam_azimuth_rad.push_back(half_rad * (2.0 * (beam + 0.5) / beams - 1.0));
    axes.Validate(info_.source);
  }

  void LayOutSamples(const FanGeometry& fan) {
    const PolarAxes& axes = info_.sonar.axes;
    const double px_per_m = (fan.radius_max_px - fan.radius_min_px) / (axes.range_max_m - axes.range_min_m);
    samples_.reserve(static_cast<std::size_t>(axes.range_bins) * axes.beam_count());
    std::int64_t outside = 0;
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      const double radius_px = fan.radius_min_px + (axes.range_centre_m(bin) - axes.range_min_m) * px_per_m;
      for (const double azimuth_rad : axes.beam_azimuth_rad) {
        samples_.push_back(SampleAt(fan.apex_x_px + fan.x_scale * radius_px * std::sin(azimuth_rad),
                                    fan.apex_y_px - radius_px * std::cos(azimuth_rad)));
        outside += samples_.back().picture_index < 0 ? 1 : 0;
      }
    }
    if (outside > 0) {
      info_.notes.push_back(
          fmt::format("{:.2g} % of the samples lie outside the picture and are 0.",
                      100.0 * static_cast<double>(outside) / static_cast<double>(samples_.size())));
    }
  }

  Sample SampleAt(double x, double y) const {
    if (!(x >= 0.0 && x <= cols_ - 1.0 && y >= 0.0 && y <= rows_ - 1.0)) return {};
    const int col = std::min(static_cast<int>(x), cols_ - 2);
    const int row = std::min(static_cast<int>(y), rows_ - 2);
    if (col < 0 || row < 0) return {};  // a picture of a single row or column
    return {row * cols_ + col, static_cast<float>(x - col), static_cast<float>(y - row)};
  }

  std::unique_ptr<PictureFrames> pictures_;
  RecordingInfo info_;
  int rows_ = 0;
  int cols_ = 0;
  std::vector<Sample> samples_;  // of the polar image
};

}  // namespace

bool IsFanPictures(const fs::path& path) {
  return IsPicture(path) || IsVideo(path) || !PicturesOf(path).empty();
}

std::unique_ptr<RecordingSource> OpenFanPictures(const fs::path& path) {
  std::unique_ptr<PictureFrames> pictures = OpenPictures(path);
  const fs::path file = DescriptionOf(path);
  std::error_code error;
  if (!fs::exists(file, error)) {
    const FanGeometry fan = FoundIn(*pictures, path.string());
    throw DataError(
        "{}: a picture does not say how far it reaches; write that into {}: {{\"format\": "
        "\"sonar-fan-picture/1\", \"range_m\": [nearest, farthest], {}}}",
        path.string(), file.string(), JsonOf(fan));
  }
  return std::make_unique<FanPictures>(path, std::move(pictures), ReadDescription(file));
}

}  // namespace sonarcal
