#include "data_io/pictures/fan_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/math/statistics.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::data_io {
namespace {

int Even(int extent) {
  return extent + extent % 2;
}

}  // namespace

FanPainter::FanPainter(const RecordingInfo& info, const FanOptions& options)
    : info_(info),
      map_(info.sonar.axes, options),
      rows_(Even(map_.axes().rows)),
      cols_(Even(map_.axes().cols)) {
  if (info.scale.quantity != Quantity::kGrey) {
    throw DataError("{}: values are {}, expected grey: only those have a brightness", info.source,
                    ToString(info.scale.quantity));
  }
}

Grid<std::uint8_t> FanPainter::Paint(const Frame& frame) const {
  std::string why;
  if (!frame.image.axes.Matches(info_.sonar.axes, &why))
    throw DataError("{}: {} differs from that of the first frame: {}", info_.source, frame.info.name, why);
  const Grid<float> fan = map_.Apply(frame.image.value);
  const double factor = 255.0 / frame.image.scale.full_scale;
  Grid<std::uint8_t> picture(rows_, cols_);
  for (int row = 0; row < fan.rows(); ++row) {
    for (int col = 0; col < fan.cols(); ++col) {
      picture(row, col) =
          static_cast<std::uint8_t>(std::lround(std::clamp(fan(row, col) * factor, 0.0, 255.0)));
    }
  }
  return picture;
}

std::string FanPainter::GeometryJson() const {
  const PolarAxes& polar = info_.sonar.axes;
  const FanAxes& fan = map_.axes();
  const double half_rad = polar.OuterEdgeRad();
  const double spacing_rad = polar.field_of_view_rad() / polar.beam_count();
  nlohmann::ordered_json json = {{"format", "sonar-picture-geometry/1"},
                                 {"range_m", {polar.range_min_m, polar.range_max_m}}};
  const auto add = [&json](const char* key, double value) {
    if (value > 0.0) json[key] = value;
  };
  if (!info_.sonar.name.empty()) json["name"] = info_.sonar.name;
  add("frequency_hz", info_.sonar.frequency_hz);
  add("sound_speed_m_per_s", info_.sonar.sound_speed_m_per_s);
  add("azimuth_beam_width_deg", info_.sonar.azimuth_beam_width_deg);
  add("elevation_beam_width_deg", info_.sonar.elevation_beam_width_deg);
  const ImageScale& scale = info_.scale;
  if (scale.db_span) {
    add("db_span", *scale.db_span);
  } else if (scale.db_min && scale.db_max) {
    add("db_span", *scale.db_max - *scale.db_min);
  }
  if (info_.synthetic) json["synthetic"] = true;
  json["fan"] = {{"apex_px", {-fan.x_min_m / fan.pixel_m - 0.5, fan.y_max_m / fan.pixel_m - 0.5}},
                 {"radius_px", {polar.range_min_m / fan.pixel_m, polar.range_max_m / fan.pixel_m}},
                 {"half_angle_deg", DegFromRad(half_rad)},
                 {"beams", std::lround(2.0 * half_rad / spacing_rad)},
                 {"range_bins", polar.range_bins}};
  return JsonText(json);
}

void WriteFanPngs(const RecordingSource& recording, const FanPainter& painter,
                  const std::filesystem::path& folder, const std::function<void(int frames_done)>& progress) {
  for (int i = 0; i < recording.frame_count(); ++i) {
    WritePng(folder / fmt::format("fan_{:04}.png", i), painter.Paint(recording.ReadFrame(i)));
    if (progress) progress(i + 1);
  }
  WriteFileWhole(folder / "geometry.json", painter.GeometryJson());
}

namespace {

int CountFrames(const std::filesystem::path& video_file) {
  cv::VideoCapture video(video_file.string(), cv::CAP_FFMPEG);
  int frames = 0;
  while (video.grab()) ++frames;
  return frames;
}

}  // namespace

void WriteFanVideo(const RecordingSource& recording, const FanPainter& painter, double frames_per_s,
                   const std::filesystem::path& file, const std::function<void(int frames_done)>& progress) {
  cv::VideoWriter video(file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                        frames_per_s, cv::Size(painter.cols(), painter.rows()));
  if (!video.isOpened()) {
    throw DataError("{}: cannot be written: FFmpeg makes no video of {} x {} at {:g} frames a second there",
                    file.string(), painter.cols(), painter.rows(), frames_per_s);
  }
  for (int i = 0; i < recording.frame_count(); ++i) {
    Grid<std::uint8_t> picture = painter.Paint(recording.ReadFrame(i));
    const cv::Mat grey(picture.rows(), picture.cols(), CV_8UC1, picture.values().data());
    cv::Mat colour;
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
    video.write(colour);
    if (progress) progress(i + 1);
  }
  video.release();
  // OpenCV and FFmpeg do not report a write that failed.
  if (const int frames = CountFrames(file); frames != recording.frame_count()) {
    throw DataError("{}: cannot be written: FFmpeg wrote {} of {} frames that can be read; is the disk full?",
                    file.string(), frames, recording.frame_count());
  }
}

double RecordedFramesPerS(const RecordingSource& recording) {
  std::vector<double> intervals_s;
  std::optional<double> before_s;
  for (int i = 0; i < recording.frame_count(); ++i) {
    const std::optional<double> time_s = recording.frame_info(i).time_s;
    if (time_s && before_s) intervals_s.push_back(*time_s - *before_s);
    before_s = time_s;
  }
  if (intervals_s.empty()) return 0.0;
  const double interval_s = UpperMedian(std::move(intervals_s));
  return interval_s > 0.0 ? 1.0 / interval_s : 0.0;
}

}  // namespace sonarcal::data_io
