#include "data_io/sonars/ddf_io.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"
#include "data_io/sonars/didson_io.h"
#include "data_io/sonars/frames_by_size.h"
#include "data_io/sonars/header_gain.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMagicBytes = 4;
constexpr int kSamples = 512;

struct DdfHeader {
  int version = 3;
  std::int32_t frames = 0;
  std::int32_t frame_rate_hz = 0;
  bool high_frequency = true;
  int beams = 96;
  bool reverse = false;
  std::int32_t serial_number = 0;

  std::uint64_t file_header_bytes() const { return version == 3 ? 512 : 1024; }
  std::uint64_t frame_header_bytes() const { return version == 3 ? 256 : 1024; }
  std::uint64_t pixel_bytes() const { return static_cast<std::uint64_t>(beams) * kSamples; }
  std::uint64_t frame_bytes() const { return frame_header_bytes() + pixel_bytes(); }
};

struct DdfFrameHeader {
  std::optional<double> time_s;
  double window_start_m = 0.0;
  double window_length_m = 0.0;
  bool classic = false;
  bool long_range = false;
  std::int32_t gain_db = 0;
  float pan_deg = 0.0F;
  float tilt_deg = 0.0F;
  float roll_deg = 0.0F;
};

// Version 3 or 4 if the bytes begin a file of that version, otherwise 0.
int VersionOf(std::span<const std::byte> bytes) {
  constexpr std::array<std::byte, 3> kName = {std::byte{'D'}, std::byte{'D'}, std::byte{'F'}};
  if (bytes.size() < kMagicBytes || !std::equal(kName.begin(), kName.end(), bytes.begin())) return 0;
  const int version = std::to_integer<int>(bytes[3]);
  return version == 3 || version == 4 ? version : 0;
}

DdfHeader ParseFileHeader(const ByteReader& reader, int version) {
  DdfHeader header;
  header.version = version;
  header.frames = reader.I32(4, "frame count");
  header.frame_rate_hz = reader.I32(8, "frame rate");
  header.high_frequency = reader.I32Within(12, "resolution", 0, 1) == 1;
  header.beams = reader.I32Within(16, "beams", 48, 96);
  if (header.beams != 48 && header.beams != 96) {
    throw DataError("{}: {}, expected 48 or 96", reader.Where(16, "beams"), header.beams);
  }
  reader.I32Within(24, "samples a beam", kSamples, kSamples);
  header.reverse = reader.I32(40, "reverse") != 0;
  header.serial_number = reader.I32(44, "serial number");
  return header;
}

// Seconds since 1970 of the frame's clock fields; nothing if they are not a date.
std::optional<double> TimeOf(const ByteReader& reader) {
  const auto field = [&](int index) { return reader.I32(20 + 4 * index, "date and time"); };
  // The types of a date keep a byte of month and day, so they alone would take month 257 for January.
  constexpr std::array<std::array<std::int32_t, 2>, 7> kLimits = {
      {{1970, 2200}, {1, 12}, {1, 31}, {0, 23}, {0, 59}, {0, 59}, {0, 99}}};
  for (int i = 0; i < 7; ++i) {
    if (field(i) < kLimits[i][0] || field(i) > kLimits[i][1]) return std::nullopt;
  }
  const std::chrono::year_month_day date{std::chrono::year{field(0)},
                                         std::chrono::month{static_cast<unsigned>(field(1))},
                                         std::chrono::day{static_cast<unsigned>(field(2))}};
  if (!date.ok()) return std::nullopt;
  const double days = static_cast<double>(std::chrono::sys_days{date}.time_since_epoch().count());
  return 86400.0 * days + 3600.0 * field(3) + 60.0 * field(4) + field(5) + 0.01 * field(6);
}

double WindowLengthM(const DdfHeader& header, bool classic, bool long_range, int code) {
  // Indexed by long range, then classic.
  constexpr double kLengthM[2][2][6] = {
      {{1.25, 2.5, 5.0, 10.0, 20.0, 40.0}, {1.125, 2.25, 4.5, 9.0, 18.0, 36.0}},
      {{2.5, 5.0, 10.0, 20.0, 40.0, 70.0}, {2.25, 4.5, 9.0, 18.0, 36.0, 72.0}}};
  constexpr double kShortestOfVersion3M = 0.83;
  if (header.version == 3 && !classic && !long_range && code == 0) return kShortestOfVersion3M;
  return kLengthM[long_range ? 1 : 0][classic ? 1 : 0][code];
}

DdfFrameHeader ParseFrameHeader(const ByteReader& reader, const DdfHeader& file) {
  constexpr int kBuiltBeforeExtendedWindows = 19;  // serial numbers below
  constexpr int kLongRangeOfOld = 15;
  DdfFrameHeader header;
  const std::int32_t flags = reader.I32(192, "flags");
  header.classic = (flags & 1) != 0 || file.serial_number < kBuiltBeforeExtendedWindows;
  header.long_range = file.serial_number < kBuiltBeforeExtendedWindows ? file.serial_number == kLongRangeOfOld
                                                                       : (flags & 2) != 0;
  header.time_s = TimeOf(reader);
  const int start_code = reader.I32Within(52, "window start code", 0, 31);
  const int length_code = reader.I32Within(56, "window length code", 0, 3);
  header.window_start_m = start_code * (header.classic ? 0.375 : 0.419) * (file.high_frequency ? 1.0 : 2.0);
  header.window_length_m =
      WindowLengthM(file, header.classic, header.long_range, length_code + (file.high_frequency ? 0 : 2));
  header.gain_db = reader.I32(68, "gain");
  header.pan_deg = reader.F32(160, "sonar pan");
  header.tilt_deg = reader.F32(164, "sonar tilt");
  header.roll_deg = reader.F32(168, "sonar roll");
  return header;
}

std::vector<double> AzimuthsRad(int beams) {
  std::vector<double> of_96 = DidsonAzimuthsRad();
  if (beams == 96) return of_96;
  std::vector<double> between;
  for (std::size_t i = 0; i + 1 < of_96.size(); i += 2) between.push_back(0.5 * (of_96[i] + of_96[i + 1]));
  return between;
}

double FrequencyHz(const DdfHeader& header, bool long_range) {
  if (long_range) return header.high_frequency ? 1.2e6 : 0.7e6;
  return header.high_frequency ? 1.8e6 : 1.1e6;
}

class DdfRecording final : public RecordingSource {
 public:
  explicit DdfRecording(const fs::path& file) : file_(file), name_(file.string()) {
    const std::uint64_t size = RegularFileSize(file);
    const std::vector<std::byte> magic = ReadFileRange(file, 0, std::min(size, kMagicBytes), "magic number");
    const int version = VersionOf(magic);
    if (version == 0) {
      throw DataError("{}: byte 0: magic number, expected \"DDF\" and version 3 or 4", name_);
    }
    header_.version = version;
    const std::vector<std::byte> bytes =
        ReadFileRange(file, 0, std::min(size, header_.file_header_bytes()), "file header");
    header_ = ParseFileHeader({bytes, name_}, version);
    const FramesBySize frames =
        CountFramesBySize(name_, size, header_.file_header_bytes(), header_.frame_bytes());
    if (frames.count == 0) {
      throw DataError("{}: byte {}: frame 0: the file ends at byte {}, expected {} bytes a frame", name_,
                      header_.file_header_bytes(), size, header_.frame_bytes());
    }
    frame_count_ = frames.count;
    first_ = ReadHeader(0);
    DescribeSonar();
    NoteFrameCount(frames, header_.frames, info_.notes);
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return frame_count_; }

  FrameInfo frame_info(int index) const override { return InfoOf(index, ReadHeader(index)); }

  Frame ReadFrame(int index) const override {
    const DdfFrameHeader header = ReadHeader(index);
    Frame frame{InfoOf(index, header), {AxesOf(header), info_.scale, Grid<float>(kSamples, header_.beams)}};
    const std::vector<std::byte> grey =
        ReadFileRange(file_, Offset(index) + header_.frame_header_bytes(), header_.pixel_bytes(), "samples");
    const std::byte* next = grey.data();
    for (int bin = 0; bin < kSamples; ++bin) {
      for (int beam = 0; beam < header_.beams; ++beam) {
        const int column = header_.reverse ? beam : header_.beams - 1 - beam;
        frame.image.value(bin, column) = std::to_integer<std::uint8_t>(*next++);
      }
    }
    return frame;
  }

 private:
  std::uint64_t Offset(int index) const {
    SONARCAL_CHECK(index >= 0 && index < frame_count_, "frame {} of {}", index, frame_count_);
    return header_.file_header_bytes() + static_cast<std::uint64_t>(index) * header_.frame_bytes();
  }

  DdfFrameHeader ReadHeader(int index) const {
    const std::uint64_t offset = Offset(index);
    const std::vector<std::byte> bytes =
        ReadFileRange(file_, offset, header_.frame_header_bytes(), "frame header");
    return ParseFrameHeader({bytes, name_, offset}, header_);
  }

  static SonarSettings SettingsOf(const DdfFrameHeader& header) {
    SonarSettings settings;
    settings.gain_db = HeaderGainDb(header.gain_db);
    return settings;
  }

  static FrameInfo InfoOf(int index, const DdfFrameHeader& header) {
    return {fmt::format("frame {}", index), header.time_s, std::nullopt, SettingsOf(header)};
  }

  PolarAxes AxesOf(const DdfFrameHeader& header) const {
    return {header.window_start_m, header.window_start_m + header.window_length_m, kSamples,
            AzimuthsRad(header_.beams)};
  }

  void DescribeSonar() {
    info_.source = name_;
    info_.format = fmt::format("DIDSON DDF v{}", header_.version);
    info_.sonar.name = first_.long_range ? "DIDSON, long range" : "DIDSON";
    info_.sonar.frequency_hz = FrequencyHz(header_, first_.long_range);
    info_.sonar.axes = AxesOf(first_);
    info_.sonar.elevation_beam_width_deg = 14.0;
    info_.sonar.beam_forming = BeamForming::kLens;
    info_.scale.full_scale = 255.0;
    info_.settings = SettingsOf(first_);
    info_.details = {
        {"frame rate", fmt::format("{} Hz", header_.frame_rate_hz)},
        {"receiver gain", fmt::format("{} dB", first_.gain_db)},
        {"serial number", fmt::format("{}", header_.serial_number)},
        {"windows", first_.classic ? "classic" : "extended"},
        {"frequency", header_.high_frequency ? "high" : "low"},
        {"sonar pan, tilt, roll", fmt::format("{:g}, {:g}, {:g} degrees as recorded", first_.pan_deg,
                                              first_.tilt_deg, first_.roll_deg)}};
    info_.notes = {
        "Elevation beam width and frequency are not recorded; the manufacturer's nominal values are used.",
        "Neither sound speed, water nor dB scale is recorded.",
        "The reader follows the published layout; it was tried on no file of a real DIDSON."};
    NoteHeaderGain(first_.gain_db, info_);
    if (header_.beams == 48)
      info_.notes.emplace_back("Each of the 48 beams is assumed to lie midway between two of the 96.");
    info_.notes.emplace_back(
        first_.time_s ? "Times are those of the sonar's clock; its time zone is unknown and read as UTC."
                      : "The date fields hold no valid date; frames have no time.");
  }

  fs::path file_;
  std::string name_;
  DdfHeader header_;
  DdfFrameHeader first_;
  int frame_count_ = 0;
  RecordingInfo info_;
};

}  // namespace

bool IsDdf(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) < kMagicBytes || error) return false;
  return VersionOf(ReadFileRange(path, 0, kMagicBytes, "magic number")) != 0;
}

std::unique_ptr<RecordingSource> OpenDdf(const fs::path& path) {
  return std::make_unique<DdfRecording>(path);
}

}  // namespace sonarcal::data_io
