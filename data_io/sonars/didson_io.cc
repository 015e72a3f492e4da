#include "data_io/sonars/didson_io.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/units.h"
#include "data_io/images/grey_frame.h"
#include "data_io/json/json_reader.h"
#include "data_io/sonars/header_gain.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr int kBeams = 96;
constexpr int kMaxRangeBins = 1 << 16;
constexpr double kMaxDidsonRangeM = 1000.0;

// Time in the file name of a ping: only digits, at least as many as a time in seconds since 1970 has.
std::optional<std::uint64_t> TimeInMicroseconds(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::uint64_t time_us = 0;
  if (!ParseNumber(stem, time_us) || stem.size() < 10) return std::nullopt;
  return time_us;
}

struct Ping {
  std::uint64_t time_us = 0;
  fs::path stem;  // without ".png" and ".json"

  fs::path png() const { return fs::path(stem) += ".png"; }
  fs::path json() const { return fs::path(stem) += ".json"; }
  bool operator<(const Ping& other) const { return time_us < other.time_us; }
};

// Ping to which `file` belongs.
std::optional<Ping> PingOf(const fs::path& file) {
  if (file.extension() != ".png" && file.extension() != ".json") return std::nullopt;
  const std::optional<std::uint64_t> time_us = TimeInMicroseconds(file);
  if (!time_us) return std::nullopt;
  Ping ping{*time_us, file.parent_path() / file.stem()};
  std::error_code error;
  if (!fs::is_regular_file(ping.png(), error) || !fs::is_regular_file(ping.json(), error))
    return std::nullopt;
  return ping;
}

std::vector<Ping> PingsOf(const fs::path& path) {
  std::vector<Ping> pings;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    if (const auto ping = PingOf(path)) pings.push_back(*ping);
    return pings;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    if (entry.path().extension() != ".json") continue;  // each ping once
    if (const auto ping = PingOf(entry.path())) pings.push_back(*ping);
  }
  std::sort(pings.begin(), pings.end());
  return pings;
}

struct Settings {
  PolarAxes axes;
  double field_of_view_rad = 0.0;
  std::vector<double> psf;
  std::vector<double> taper;
  double noise = 0.0;
  double receiver_gain_db = 0.0;
};

Settings ReadSettings(const fs::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  Settings settings;
  settings.axes.range_min_m = json.At("min_range").Number(NumberRange::Between(0.0, kMaxDidsonRangeM));
  settings.axes.range_max_m = json.At("max_range").Number(NumberRange::AboveUpTo(0.0, kMaxDidsonRangeM));
  settings.axes.range_bins = static_cast<int>(json.At("num_bins").Integer(1, kMaxRangeBins));
  json.At("num_beams").Integer(kBeams, kBeams);
  settings.axes.beam_azimuth_rad = DidsonAzimuthsRad();
  settings.axes.Validate(file.string());
  settings.field_of_view_rad = json.At("fov").Number(NumberRange::AboveUpTo(0.0, kPi));
  settings.noise = json.At("noise").Number();
  settings.receiver_gain_db = json.At("rx_gain").Number();
  for (const auto& [key, values] : {std::pair("psf", &settings.psf), std::pair("taper", &settings.taper)}) {
    *values = json.At(key).Numbers(NumberRange::AtLeast(0.0));
    if (values->size() != kBeams) {
      json.At(key).Fail(fmt::format("has {} numbers, expected one per beam, {}", values->size(), kBeams));
    }
  }
  return settings;
}

SonarSettings SonarSettingsOf(const Settings& settings) {
  SonarSettings of_ping;
  of_ping.gain_db = HeaderGainDb(settings.receiver_gain_db);
  return of_ping;
}

class DidsonRecording final : public RecordingSource {
 public:
  DidsonRecording(const fs::path& path, std::vector<Ping> pings) : pings_(std::move(pings)) {
    const Settings first = ReadSettings(pings_.front().json());
    info_.source = path.string();
    info_.format = "DIDSON pings (PNG + JSON)";
    info_.sonar.name = "DIDSON";
    info_.sonar.frequency_hz = 1.8e6;
    info_.sonar.axes = first.axes;
    info_.sonar.elevation_beam_width_deg = 14.0;
    info_.sonar.beam_forming = BeamForming::kLens;
    info_.scale.full_scale = 255.0;
    info_.settings = SonarSettingsOf(first);
    info_.azimuth_psf = first.psf;
    info_.beam_taper = first.taper;
    info_.details = {{"field of view", fmt::format("{:.2f} degrees", DegFromRad(first.field_of_view_rad))},
                     {"noise", fmt::format("{} (no unit given)", first.noise)},
                     {"receiver gain", fmt::format("{} dB", first.receiver_gain_db)}};
    info_.notes = {
        "Frequency and elevation beam width are those of a DIDSON with 96 beams; they are not recorded.",
        "Neither sound speed, water, dB scale nor pose is recorded."};
    NoteHeaderGain(first.receiver_gain_db, info_);
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(pings_.size()); }

  FrameInfo frame_info(int index) const override {
    return InfoOf(pings_.at(index), ReadSettings(pings_.at(index).json()));
  }

  Frame ReadFrame(int index) const override {
    const Ping& ping = pings_.at(index);
    const Settings settings = ReadSettings(ping.json());
    return {InfoOf(ping, settings),
            {settings.axes, info_.scale, ReadGreyFrame(ping.png(), settings.axes.range_bins, kBeams)}};
  }

 private:
  static FrameInfo InfoOf(const Ping& ping, const Settings& settings) {
    return {ping.png().filename().string(), static_cast<double>(ping.time_us) * 1e-6, std::nullopt,
            SonarSettingsOf(settings)};
  }

  std::vector<Ping> pings_;
  RecordingInfo info_;
};

}  // namespace

bool IsDidson(const fs::path& path) {
  return !PingsOf(path).empty();
}

std::unique_ptr<RecordingSource> OpenDidson(const fs::path& path) {
  std::vector<Ping> pings = PingsOf(path);
  if (pings.empty()) {
    throw DataError("{}: expected a DIDSON ping, or a folder of them: <microseconds>.png and .json",
                    path.string());
  }
  return std::make_unique<DidsonRecording>(path, std::move(pings));
}

std::vector<double> DidsonAzimuthsRad() {
  std::vector<double> azimuth_rad(kBeams);
  double t_deg = -14.0;  // near beam 0; then each beam starts from its neighbour
  for (int beam = 0; beam < kBeams; ++beam) {
    // Newton's method. It converges immediately, because the slope is between 2.67 and 4.8 beams per degree.
    for (int step = 0; step < 20; ++step) {
      const double value = ((0.0030 * t_deg - 0.0055) * t_deg + 2.6829) * t_deg + 48.04 - beam;
      const double slope = (3.0 * 0.0030 * t_deg - 2.0 * 0.0055) * t_deg + 2.6829;
      t_deg -= value / slope;
    }
    azimuth_rad[beam] = RadFromDeg(t_deg);
  }
  return azimuth_rad;
}

}  // namespace sonarcal::data_io
