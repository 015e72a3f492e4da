#include "data_io/pictures/picture_geometry.h"

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/recording_limits.h"

namespace sonarcal::data_io {
namespace {

constexpr int kMaxBins = 1 << 14;

PictureGeometry::Polar ReadPolar(const JsonReader& json) {
  const auto angle_rad = [&](const char* key) {
    return RadFromDeg(json.At(key).Number(NumberRange::Between(-180.0, 180.0)));
  };
  const PictureGeometry::Polar polar{
      .azimuth_first_rad = angle_rad("azimuth_first_deg"),
      .azimuth_last_rad = angle_rad("azimuth_last_deg"),
      .nearest_on_top = json.At("nearest_row").Word(Words<bool, 2>{{{"top", true}, {"bottom", false}}})};
  if (polar.azimuth_first_rad == polar.azimuth_last_rad)
    json.At("azimuth_last_deg").Fail("is azimuth_first_deg, expected another angle");
  return polar;
}

std::vector<double> TwoNumbers(const JsonReader& json, const char* expected) {
  std::vector<double> numbers = json.Numbers(NumberRange::Between(-1e6, 1e6));
  if (numbers.size() != 2) json.Fail(fmt::format("has {} numbers, expected {}", numbers.size(), expected));
  return numbers;
}

const NumberRange kHalfAngleDeg = NumberRange::Between(0.5, 89.0);
const NumberRange kXScale = NumberRange::Between(0.1, 10.0);

void ReadFan(const JsonReader& json, PictureGeometry& geometry) {
  if (const auto beams = json.Find("beams")) geometry.beams = static_cast<int>(beams->Integer(2, kMaxBins));
  if (const auto bins = json.Find("range_bins"))
    geometry.range_bins = static_cast<int>(bins->Integer(1, kMaxBins));
  const auto half_angle_deg = json.FindNumber("half_angle_deg", kHalfAngleDeg);
  const auto apex = json.Find("apex_px");
  const auto radius = json.Find("radius_px");
  const auto x_scale = json.FindNumber("x_scale", kXScale);
  if (!apex && !radius) {
    if (x_scale) json.At("x_scale").Fail("is given without apex_px, radius_px and half_angle_deg");
    geometry.half_angle_deg = half_angle_deg;
    return;
  }
  if (!apex || !radius || !half_angle_deg)
    json.Fail("needs apex_px, radius_px and half_angle_deg together, or neither of the first two");
  geometry.fan = ReadFanGeometry(json);
}

}  // namespace

FanGeometry ReadFanGeometry(const JsonReader& json) {
  const std::vector<double> at = TwoNumbers(json.At("apex_px"), "a column and a row");
  const std::vector<double> radii =
      TwoNumbers(json.At("radius_px"), "that of the near arc and that of the far one");
  const FanGeometry fan{.apex_x_px = at[0],
                        .apex_y_px = at[1],
                        .radius_min_px = radii[0],
                        .radius_max_px = radii[1],
                        .half_angle_deg = json.At("half_angle_deg").Number(kHalfAngleDeg),
                        .x_scale = json.FindNumber("x_scale", kXScale).value_or(1.0)};
  fan.Validate(json.file());
  return fan;
}

Grid<float> SampleFan(const Grid<float>& picture, const FanGeometry& fan, const PolarAxes& axes,
                      const std::string& where) {
  Grid<float> polar(axes.range_bins, axes.beam_count());
  const double px_per_m = (fan.radius_max_px - fan.radius_min_px) / (axes.range_max_m - axes.range_min_m);
  for (int beam = 0; beam < polar.cols(); ++beam) {
    const double azimuth_rad = axes.beam_azimuth_rad[beam];
    for (int bin = 0; bin < polar.rows(); ++bin) {
      const double radius_px = fan.radius_min_px + (axes.range_centre_m(bin) - axes.range_min_m) * px_per_m;
      const auto row = std::lround(fan.apex_y_px - radius_px * std::cos(azimuth_rad));
      const auto col = std::lround(fan.apex_x_px + fan.x_scale * radius_px * std::sin(azimuth_rad));
      if (row < 0 || row >= picture.rows() || col < 0 || col >= picture.cols()) {
        throw DataError("{}: {} x {} pixels, which do not hold the whole fan {{{}}}", where, picture.rows(),
                        picture.cols(), JsonOf(fan));
      }
      polar(bin, beam) = picture(static_cast<int>(row), static_cast<int>(col));
    }
  }
  return polar;
}

PictureGeometry ReadPictureGeometry(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.CheckFormat("sonar-picture-geometry/1");
  PictureGeometry geometry;
  const JsonReader range_m = json.At("range_m");
  const std::vector<double> range = range_m.Numbers(kSonarRangeM);
  if (range.empty() || range.size() > 2 || !(range.back() > (range.size() == 2 ? range.front() : 0.0)))
    range_m.Fail("must be two ranges, the nearer first, or the farthest one of a fan");
  if (range.size() == 2) geometry.range_min_m = range.front();
  geometry.range_max_m = range.back();
  if (const auto name = json.Find("name")) geometry.name = name->String();
  json.Update("frequency_hz", geometry.frequency_hz, kSonarFrequencyHz);
  json.Update("sound_speed_m_per_s", geometry.sound_speed_m_per_s, kSonarSoundSpeedMPerS);
  json.Update("azimuth_beam_width_deg", geometry.azimuth_beam_width_deg, kSonarBeamWidthDeg);
  json.Update("elevation_beam_width_deg", geometry.elevation_beam_width_deg, kSonarBeamWidthDeg);
  geometry.db_span = json.FindNumber("db_span", kRecordedSpanDb);
  if (const auto synthetic = json.Find("synthetic")) geometry.synthetic = synthetic->Bool();
  const auto polar = json.Find("polar");
  const auto fan = json.Find("fan");
  if (polar && fan) json.Fail("has both 'polar' and 'fan', expected one");
  if (polar && !geometry.range_min_m) range_m.Fail("has one range, expected two for 'polar'");
  if (polar) geometry.polar = ReadPolar(*polar);
  if (fan) ReadFan(*fan, geometry);
  json.Finish();
  return geometry;
}

void PictureGeometry::TakeFound(FanGeometry found) {
  if (half_angle_deg) {
    found.x_scale *= std::tan(RadFromDeg(found.half_angle_deg)) / std::tan(RadFromDeg(*half_angle_deg));
    found.half_angle_deg = *half_angle_deg;
  }
  fan = found;
}

void PictureGeometry::Describe(RecordingInfo& info) const {
  info.sonar.name = name;
  info.sonar.frequency_hz = frequency_hz;
  info.sonar.sound_speed_m_per_s = sound_speed_m_per_s;
  info.sonar.azimuth_beam_width_deg = azimuth_beam_width_deg;
  info.sonar.elevation_beam_width_deg = elevation_beam_width_deg;
  info.scale.db_span = db_span;
  info.synthetic = synthetic;
}

std::string JsonOf(const FanGeometry& fan) {
  return fmt::format(
      "\"apex_px\": [{:.1f}, {:.1f}], \"radius_px\": [{:.1f}, {:.1f}], \"half_angle_deg\": {:.2f}, "
      "\"x_scale\": {:.3f}",
      fan.apex_x_px, fan.apex_y_px, fan.radius_min_px, fan.radius_max_px, fan.half_angle_deg, fan.x_scale);
}

PictureSampler::PictureSampler(const PictureGeometry& geometry, int rows, int cols, const std::string& where)
    : rows_(rows), cols_(cols) {
  SONARCAL_CHECK(geometry.polar || geometry.fan, "{}: neither polar nor a fan", where);
  SONARCAL_CHECK(geometry.range_min_m || geometry.fan, "{}: no nearest range", where);
  axes_.range_max_m = geometry.range_max_m;
  axes_.range_min_m = geometry.range_min_m
                          ? *geometry.range_min_m
                          : geometry.range_max_m * geometry.fan->radius_min_px / geometry.fan->radius_max_px;
  if (geometry.polar && cols < 2)
    throw DataError("{}: a picture of {} columns, expected at least 2 beams", where, cols);
  geometry.polar ? LayOutPolar(geometry) : LayOutFan(geometry);
  axes_.Validate(where);
}

void PictureSampler::LayOutPolar(const PictureGeometry& geometry) {
  const PictureGeometry::Polar& polar = *geometry.polar;
  const bool from_right = polar.azimuth_first_rad > polar.azimuth_last_rad;
  const auto [left_rad, right_rad] = std::minmax(polar.azimuth_first_rad, polar.azimuth_last_rad);
  axes_.range_bins = rows_;
  for (int beam = 0; beam < cols_; ++beam)
    axes_.beam_azimuth_rad.push_back(left_rad + (right_rad - left_rad) * beam / (cols_ - 1));
  samples_.reserve(static_cast<std::size_t>(rows_) * cols_);
  for (int bin = 0; bin < rows_; ++bin) {
    const int row = polar.nearest_on_top ? bin : rows_ - 1 - bin;
    for (int beam = 0; beam < cols_; ++beam)
      samples_.push_back({.index = row * cols_ + (from_right ? cols_ - 1 - beam : beam)});
  }
}

void PictureSampler::LayOutFan(const PictureGeometry& geometry) {
  const FanGeometry& fan = *geometry.fan;
  const double half_rad = RadFromDeg(fan.half_angle_deg);
  // Resolution of the picture: one bin per pixel of range, one beam per pixel of the far arc.
  const auto as_fine = [](double pixels, int min_count) {
    return static_cast<int>(std::clamp(std::round(pixels), static_cast<double>(min_count), double{kMaxBins}));
  };
  axes_.range_bins =
      geometry.range_bins > 0 ? geometry.range_bins : as_fine(fan.radius_max_px - fan.radius_min_px, 1);
  const int beams =
      geometry.beams > 0 ? geometry.beams : as_fine(2.0 * half_rad * fan.radius_max_px * fan.x_scale, 2);
  for (int beam = 0; beam < beams; ++beam)
    axes_.beam_azimuth_rad.push_back(half_rad * (2.0 * (beam + 0.5) / beams - 1.0));
  const double px_per_m = (fan.radius_max_px - fan.radius_min_px) / (axes_.range_max_m - axes_.range_min_m);
  samples_.reserve(static_cast<std::size_t>(axes_.range_bins) * beams);
  for (int bin = 0; bin < axes_.range_bins; ++bin) {
    const double radius_px = fan.radius_min_px + (axes_.range_centre_m(bin) - axes_.range_min_m) * px_per_m;
    for (const double azimuth_rad : axes_.beam_azimuth_rad) {
      samples_.push_back(SampleAt(fan.apex_x_px + fan.x_scale * radius_px * std::sin(azimuth_rad),
                                  fan.apex_y_px - radius_px * std::cos(azimuth_rad)));
    }
  }
}

PictureSampler::Sample PictureSampler::SampleAt(double x, double y) const {
  if (!(x >= 0.0 && x <= cols_ - 1.0 && y >= 0.0 && y <= rows_ - 1.0)) return {};
  const auto col = static_cast<int>(x);
  const auto row = static_cast<int>(y);
  return {row * cols_ + col, static_cast<float>(x - col), static_cast<float>(y - row)};
}

std::optional<Mask> PictureSampler::inside() const {
  if (std::ranges::count(samples_, -1, &Sample::index) == 0) return std::nullopt;
  Mask inside(axes_.range_bins, axes_.beam_count());
  std::ranges::transform(samples_, inside.values().begin(),
                         [](const Sample& sample) { return std::uint8_t{sample.index >= 0}; });
  return inside;
}

Grid<float> PictureSampler::Apply(const Grid<float>& picture) const {
  SONARCAL_CHECK(picture.rows() == rows_ && picture.cols() == cols_, "{} x {} pixels, expected {} x {}",
                 picture.rows(), picture.cols(), rows_, cols_);
  Grid<float> polar(axes_.range_bins, axes_.beam_count());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    if (sample.index < 0) continue;
    const float* pixel = &picture.values()[sample.index];
    // The last column and row have no neighbour and need none.
    const int right = sample.right > 0.0F ? 1 : 0;
    const int below = sample.below > 0.0F ? cols_ : 0;
    const float upper = pixel[0] + sample.right * (pixel[right] - pixel[0]);
    const float lower = pixel[below] + sample.right * (pixel[below + right] - pixel[below]);
    polar.values()[i] = upper + sample.below * (lower - upper);
  }
  return polar;
}

}  // namespace sonarcal::data_io
