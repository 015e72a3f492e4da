#include "data_io/sonars/aris3000_frames_io.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/sonars/aris_beam_tables.h"
#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/files/file_bytes.h"
#include "data_io/images/grey_frame.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pictures/picture_geometry.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr int kBeams = 128;
constexpr int kRangeBins = 780;
constexpr double kRangeMinM = 0.690;
constexpr double kRangeMaxM = 2.998;
// What a sample period of 4 us makes of the bin length.
constexpr double kSoundSpeedMPerS = 1479.5;
constexpr double kDbPerCount = 80.0 / 255.0;
constexpr const char* kBeamTableName = "beam_table_ARIS3000_128.csv";
constexpr std::size_t kMostBeamTableBytes = 64 << 10;

// frame_NNNN_128x780.png, of any number of digits.
bool IsFrameName(std::string_view name) {
  constexpr std::string_view kBefore = "frame_";
  constexpr std::string_view kAfter = "_128x780.png";
  if (!name.starts_with(kBefore) || !name.ends_with(kAfter)) return false;
  if (name.size() <= kBefore.size() + kAfter.size()) return false;
  const std::string_view digits = name.substr(kBefore.size(), name.size() - kBefore.size() - kAfter.size());
  return digits.find_first_not_of("0123456789") == std::string_view::npos;
}

// In order of their names; none where `folder` is no folder.
std::vector<fs::path> FrameFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (IsFrameName(entry.path().filename().string())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Number of counts over which a picture was stretched: the N of grey = floor(count * 255 / N), from the
// levels that occur. Nullopt if no N stands out, such as in a picture that was not stretched. A few pixels
// may lie between the levels, such as interpolated ones.
std::optional<int> StretchedCounts(const Grid<float>& picture) {
  constexpr int kLevels = 256;
  constexpr int kFewest = 16;  // a picture of fewer levels shows too little to tell
  constexpr double kClear = 0.2;
  std::array<double, kLevels> share{};
  for (const float grey : picture.values())
    share[static_cast<std::size_t>(grey)] += 1.0 / static_cast<double>(picture.size());
  std::optional<int> best;
  double best_excess = kClear;
  for (int counts = kFewest; counts < kLevels - 1; ++counts) {
    // Share of the pixels on the levels that N counts can have, beyond the share of such levels.
    double excess = 0.0;
    for (int count = 0; count <= counts; ++count)
      excess += share[static_cast<std::size_t>(count * 255 / counts)] - 1.0 / kLevels;
    if (excess > best_excess) {
      best = counts;
      best_excess = excess;
    }
  }
  return best;
}

// "beam,center_deg,..." of one line; nothing where it is not that.
std::optional<std::pair<int, double>> ParseBeam(std::string_view line) {
  int beam = 0;
  double centre_deg = 0.0;
  const char* end = line.data() + line.size();
  const auto beam_end = std::from_chars(line.data(), end, beam);
  if (beam_end.ec != std::errc() || beam_end.ptr == end || *beam_end.ptr != ',') return std::nullopt;
  const auto centre_end = std::from_chars(beam_end.ptr + 1, end, centre_deg);
  if (centre_end.ec != std::errc() || !std::isfinite(centre_deg)) return std::nullopt;
  return std::pair(beam, centre_deg);
}

// Centres of a table "beam,center_deg,left_deg,right_deg" whose beams count up from 0.
std::vector<double> ReadBeamTable(const fs::path& file) {
  std::istringstream text(ReadFileBytes(file, kMostBeamTableBytes));
  std::vector<double> centre_deg;
  std::string line;
  std::getline(text, line);  // names of the columns
  for (int number = 2; std::getline(text, line); ++number) {
    const std::optional<std::pair<int, double>> beam = ParseBeam(line);
    if (!beam || beam->first != static_cast<int>(centre_deg.size())) {
      throw DataError("{}:{}: '{}', expected 'beam,center_deg,...' of beam {}", file.string(), number,
                      Printable(line), centre_deg.size());
    }
    centre_deg.push_back(beam->second);
  }
  if (centre_deg.size() != kBeams) {
    throw DataError("{}: {} beams, expected {}", file.string(), centre_deg.size(), kBeams);
  }
  return centre_deg;
}

RecordingInfo CommonInfo(const fs::path& path, std::span<const double> centre_deg) {
  RecordingInfo info;
  info.source = path.string();
  info.sonar.name = "ARIS Explorer 3000";
  info.sonar.frequency_hz = 3.0e6;
  info.sonar.axes.range_min_m = kRangeMinM;
  info.sonar.axes.range_max_m = kRangeMaxM;
  info.sonar.axes.range_bins = kRangeBins;
  for (const double centre : centre_deg) info.sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(centre));
  info.sonar.axes.Validate(path.string());
  info.sonar.elevation_beam_width_deg = 15.0;
  info.sonar.beam_forming = BeamForming::kLens;
  info.sonar.sound_speed_m_per_s = kSoundSpeedMPerS;
  info.scale.full_scale = 255.0;
  info.settings.compression = Compression::kLogarithm;
  info.details = {{"source", "dfki-ric/uxo-dataset2024"},
                  {"licence", "none stated: evaluation only"},
                  {"object", "100 lb bomb, body of revolution, length 737 mm, diameter 208 mm, ogive nose"}};
  info.notes = {
      "The range window 0.690..2.998 m and the sound speed are inferred from the sensor's timing, "
      "not recorded.",
      "No pose is recorded, nor time, gain or water."};
  return info;
}

class FrameFolder final : public RecordingSource {
 public:
  explicit FrameFolder(const fs::path& folder) : files_(FrameFiles(folder)) {
    const fs::path table = folder / kBeamTableName;
    std::error_code error;
    const bool has_table = fs::exists(table, error);
    const std::span<const double> compiled =
        ArisBeamCentresDeg(ArisSystem::kAris3000, kBeams, ArisLens::kStandard);
    info_ = CommonInfo(
        folder, has_table ? ReadBeamTable(table) : std::vector<double>(compiled.begin(), compiled.end()));
    info_.format = "ARIS 3000 frames, recovered from fan pictures";
    info_.details.emplace_back("beam table",
                               has_table ? kBeamTableName : "ARIS File SDK, ARIS 3000, 128 beams");
    TellStretching();
    info_.notes.emplace_back(
        "0.95 % of the samples are interpolated: the frames were recovered from published fan pictures.");
    info_.notes.emplace_back(
        "The frames are of one static scene, their speckle frozen: a second frame tests receiver noise "
        "only.");
    info_.notes.emplace_back(
        "Left and right are probably exchanged: column 0 is ARIS beam 0, which the maker calls the "
        "right-most.");
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(files_.size()); }
  FrameInfo frame_info(int index) const override {
    return {files_.at(index).filename().string(), {}, {}, info_.settings};
  }

  Frame ReadFrame(int index) const override {
    Frame frame{frame_info(index),
                {info_.sonar.axes, info_.scale, ReadGreyFrame(files_.at(index), kRangeBins, kBeams)}};
    if (!scale_counts_ || counts_[index] == *scale_counts_) return frame;
    for (float& grey : frame.image.value.values()) {
      const int count = (static_cast<int>(grey) * *counts_[index] + 254) / 255;
      grey = static_cast<float>(count * 255 / *scale_counts_);
    }
    return frame;
  }

 private:
  // Frames of other counts than the largest are shown on its scale, so that a grey level is as many dB in
  // all.
  void TellStretching() {
    for (const fs::path& file : files_)
      counts_.push_back(StretchedCounts(ReadGreyFrame(file, kRangeBins, kBeams)));
    if (std::find(counts_.begin(), counts_.end(), std::nullopt) != counts_.end()) {
      info_.notes.emplace_back(
          "By the grey levels that occur it cannot be told how each frame was stretched: the dB scale is "
          "unknown.");
      return;
    }
    const auto [fewest, most] = std::minmax_element(counts_.begin(), counts_.end());
    scale_counts_ = **most;
    info_.scale.db_span = *scale_counts_ * kDbPerCount;
    info_.notes.push_back(fmt::format(
        "Grey values were stretched, frame by frame: grey = floor(count * 255 / N), N = {}, a count being "
        "80/255 dB.",
        *fewest == *most ? fmt::format("{}", **most)
                         : fmt::format("{} to {} (all are shown as with N = {})", **fewest, **most, **most)));
  }

  std::vector<fs::path> files_;
  std::vector<std::optional<int>> counts_;  // by frame
  std::optional<int> scale_counts_;         // of the grey values given
  RecordingInfo info_;
};

class FanPicture final : public RecordingSource {
 public:
  FanPicture(fs::path file, const FanGeometry& fan)
      : file_(std::move(file)),
        fan_(fan),
        info_(CommonInfo(file_, ArisBeamCentresDeg(ArisSystem::kAris3000, kBeams, ArisLens::kStandard))) {
    info_.format = "ARIS 3000 fan picture";
    info_.scale.db_span = 255.0 * kDbPerCount;
    info_.notes.emplace_back(
        "The fan picture, itself resized and colour-mapped, was resampled to 128 beams x 780 ranges by "
        "nearest neighbour: neighbouring samples repeat.");
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return 1; }
  FrameInfo frame_info(int) const override { return {file_.filename().string(), {}, {}, info_.settings}; }

  Frame ReadFrame(int index) const override {
    const Grid<float> picture = OpenPictures(file_)->Read(0);
    Frame frame{frame_info(index), {info_.sonar.axes, info_.scale, Grid<float>(kRangeBins, kBeams)}};
    const double px_per_m = (fan_.radius_max_px - fan_.radius_min_px) / (kRangeMaxM - kRangeMinM);
    for (int beam = 0; beam < kBeams; ++beam) {
      const double azimuth_rad = info_.sonar.axes.beam_azimuth_rad[beam];
      for (int bin = 0; bin < kRangeBins; ++bin) {
        const double radius_px =
            fan_.radius_min_px + (info_.sonar.axes.range_centre_m(bin) - kRangeMinM) * px_per_m;
        const auto row = std::lround(fan_.apex_y_px - radius_px * std::cos(azimuth_rad));
        const auto col = std::lround(fan_.apex_x_px + fan_.x_scale * radius_px * std::sin(azimuth_rad));
        if (row < 0 || row >= picture.rows() || col < 0 || col >= picture.cols()) {
          throw DataError("{}: {} x {} pixels, which do not hold the whole fan {{{}}}", file_.string(),
                          picture.rows(), picture.cols(), JsonOf(fan_));
        }
        frame.image.value(bin, beam) = picture(static_cast<int>(row), static_cast<int>(col));
      }
    }
    return frame;
  }

 private:
  fs::path file_;
  FanGeometry fan_;
  RecordingInfo info_;
};

}  // namespace

bool IsAris3000Frames(const fs::path& path) {
  return !FrameFiles(path).empty();
}

std::unique_ptr<RecordingSource> OpenAris3000Frames(const fs::path& path) {
  if (!FrameFiles(path).empty()) return std::make_unique<FrameFolder>(path);
  throw DataError("{}: expected a folder of frame_NNNN_128x780.png", path.string());
}

std::unique_ptr<RecordingSource> OpenAris3000FanPicture(const fs::path& picture, const FanGeometry& fan) {
  fan.Validate(picture.string());
  return std::make_unique<FanPicture>(picture, fan);
}

}  // namespace sonarcal::data_io
