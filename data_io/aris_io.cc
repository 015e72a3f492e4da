#include "data_io/aris_io.h"

#include <algorithm>
#include <cmath>

#include "data_io/aris_beam_tables.h"
#include "data_io/byte_reader.h"
#include "data_io/frames_by_size.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kMagic = 0x05464444;
constexpr std::uint64_t kHeaderBytes = 1024;  // of the file, and of each frame
constexpr std::uint32_t kMostSamplesPerBeam = 1 << 16;
constexpr double kDbSpan = 80.0;

struct ArisHeader {
  double time_s = 0.0;  // since 1970; 0 = not set
  float window_start_m = 0.0f;
  float window_length_m = 0.0f;
  std::uint32_t gain_db = 0;
  float water_temperature_c = 0.0f;
  std::uint32_t ping_mode = 0;
  bool high_frequency = false;
  std::uint32_t pulse_width_us = 0;
  std::uint32_t sample_period_us = 0;
  float frame_rate_hz = 0.0f;
  float sound_speed_m_per_s = 0.0f;
  std::uint32_t samples_per_beam = 0;
  std::uint32_t sample_start_delay_us = 0;
  ArisLens lens = ArisLens::kStandard;
  ArisSystem system = ArisSystem::kAris1800;
  std::uint32_t salinity_ppt = 0;

  int beam_count() const {
    if (ping_mode <= 2) return 48;
    if (ping_mode <= 5) return 96;
    if (ping_mode <= 8) return 64;
    return 128;
  }
  std::uint64_t frame_bytes() const {
    return kHeaderBytes + static_cast<std::uint64_t>(beam_count()) * samples_per_beam;
  }
  double bin_m() const { return sample_period_us * 1e-6 * sound_speed_m_per_s / 2.0; }
  double range_min_m() const { return sample_start_delay_us * 1e-6 * sound_speed_m_per_s / 2.0; }
  double range_max_m() const { return range_min_m() + samples_per_beam * bin_m(); }
};

ArisHeader ParseFrameHeader(const ByteReader& reader) {
  if (reader.U32(12, "Version") != kMagic) {
    throw DataError("{}: {:#010x}, expected {:#010x}", reader.Where(12, "Version"), reader.U32(12, "Version"),
                    kMagic);
  }
  ArisHeader header;
  header.time_s = static_cast<double>(reader.U64(4, "FrameTime")) * 1e-6;
  header.window_start_m = reader.F32(52, "WindowStart");
  header.window_length_m = reader.F32(56, "WindowLength");
  header.gain_db = reader.U32(68, "ReceiverGain");
  header.water_temperature_c = reader.F32(224, "WaterTemp");
  header.ping_mode = reader.U32Within(436, "PingMode", 1, 12);
  header.high_frequency = reader.U32(440, "FrequencyHiLow") != 0;
  header.pulse_width_us = reader.U32(444, "PulseWidth");
  header.sample_period_us = reader.U32Within(452, "SamplePeriod", 1, 1000);
  header.frame_rate_hz = reader.F32(460, "FrameRate");
  header.sound_speed_m_per_s = reader.F32(464, "SoundSpeed");
  if (!(header.sound_speed_m_per_s >= 1300.0f && header.sound_speed_m_per_s <= 1700.0f)) {
    throw DataError("{}: {} m/s, expected 1300..1700", reader.Where(464, "SoundSpeed"),
                    header.sound_speed_m_per_s);
  }
  header.samples_per_beam = reader.U32Within(468, "SamplesPerBeam", 1, kMostSamplesPerBeam);
  header.sample_start_delay_us = reader.U32Within(476, "SampleStartDelay", 0, 1'000'000);
  header.lens = reader.U32(480, "LargeLens") != 0 ? ArisLens::kTelephoto : ArisLens::kStandard;
  header.system = static_cast<ArisSystem>(reader.U32Within(484, "TheSystemType", 0, 2));
  if (reader.U32(516, "ReorderedSamples") == 0) {
    throw DataError("{}: 0, expected samples that are sorted by beam already",
                    reader.Where(516, "ReorderedSamples"));
  }
  header.salinity_ppt = reader.U32(520, "Salinity");
  return header;
}

std::string ModelName(const ArisHeader& header) {
  constexpr int kModel[] = {1800, 3000, 1200};
  return fmt::format("ARIS {}{}", kModel[static_cast<int>(header.system)],
                     header.lens == ArisLens::kTelephoto ? ", telephoto lens" : "");
}

double FrequencyHz(const ArisHeader& header) {
  switch (header.system) {
    case ArisSystem::kAris3000:
      return header.high_frequency ? 3.0e6 : 1.8e6;
    case ArisSystem::kAris1800:
      return header.high_frequency ? 1.8e6 : 1.1e6;
    case ArisSystem::kAris1200:
      return header.high_frequency ? 1.2e6 : 0.7e6;
  }
  return 0.0;
}

PolarAxes AxesOf(const ArisHeader& header, const std::string& what) {
  const auto centres_deg = ArisBeamCentresDeg(header.system, header.beam_count(), header.lens);
  if (centres_deg.empty()) {
    throw DataError(
        "{}: {} with {} beams (PingMode {}), expected a combination the maker has a beam table of", what,
        ModelName(header), header.beam_count(), header.ping_mode);
  }
  PolarAxes axes{header.range_min_m(), header.range_max_m(), static_cast<int>(header.samples_per_beam),
                 ArisAzimuthsRad(centres_deg)};
  axes.Validate(what);
  return axes;
}

class ArisRecording final : public RecordingSource {
 public:
  explicit ArisRecording(const fs::path& file) : file_(file), name_(file.string()) {
    const std::uint64_t size = RegularFileSize(file);
    const std::vector<std::byte> bytes =
        ReadFileRange(file, 0, std::min(size, 2 * kHeaderBytes), "file header and first frame header");
    const ByteReader reader(bytes, name_);
    if (reader.U32(0, "magic number") != kMagic) {
      throw DataError("{}: {:#010x}, expected {:#010x}", reader.Where(0, "magic number"),
                      reader.U32(0, "magic number"), kMagic);
    }
    first_ =
        ParseFrameHeader({reader.Bytes(kHeaderBytes, kHeaderBytes, "frame 0 header"), name_, kHeaderBytes});
    const FramesBySize frames = CountFramesBySize(name_, size, kHeaderBytes, first_.frame_bytes());
    if (frames.count == 0) {
      throw DataError("{}: byte {}: frame 0: the file ends at byte {}, expected {} beams x {} samples", name_,
                      2 * kHeaderBytes, size, first_.beam_count(), first_.samples_per_beam);
    }
    frame_count_ = frames.count;
    DescribeSonar();
    NoteFrameCount(frames, reader.U32(4, "FrameCount"), info_.notes);
    NoteWindow();
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return frame_count_; }

  FrameInfo frame_info(int index) const override { return InfoOf(index, ReadHeader(index)); }

  Frame ReadFrame(int index) const override {
    const ArisHeader header = ReadHeader(index);
    const int beams = header.beam_count();
    Frame frame{InfoOf(index, header),
                {AxesOf(header, FrameName(index)), info_.scale,
                 Grid<float>(static_cast<int>(header.samples_per_beam), beams)}};
    const std::vector<std::byte> grey =
        ReadFileRange(file_, Offset(index) + kHeaderBytes, frame.image.value.size(), "samples");
    const std::byte* next = grey.data();
    for (int bin = 0; bin < frame.image.value.rows(); ++bin) {
      // ARIS beams count from the right, columns from the left.
      for (int column = beams - 1; column >= 0; --column) {
        frame.image.value(bin, column) = std::to_integer<std::uint8_t>(*next++);
      }
    }
    return frame;
  }

 private:
  std::uint64_t Offset(int index) const {
    SONARCAL_CHECK(index >= 0 && index < frame_count_, "frame {} of {}", index, frame_count_);
    return kHeaderBytes + static_cast<std::uint64_t>(index) * first_.frame_bytes();
  }

  std::string FrameName(int index) const { return fmt::format("{}: frame {}", name_, index); }

  ArisHeader ReadHeader(int index) const {
    const std::uint64_t offset = Offset(index);
    const std::vector<std::byte> bytes = ReadFileRange(file_, offset, kHeaderBytes, "frame header");
    const ArisHeader header = ParseFrameHeader({bytes, name_, offset});
    if (header.ping_mode != first_.ping_mode || header.samples_per_beam != first_.samples_per_beam) {
      throw DataError("{}: PingMode {} and {} samples a beam, expected {} and {} as in frame 0",
                      FrameName(index), header.ping_mode, header.samples_per_beam, first_.ping_mode,
                      first_.samples_per_beam);
    }
    return header;
  }

  static SonarSettings SettingsOf(const ArisHeader& header) {
    return {.gain_db = header.gain_db,
            .pulse_length_us = header.pulse_width_us,
            .time_varied_gain = {},
            .compression = Compression::kLogarithm};
  }

  static FrameInfo InfoOf(int index, const ArisHeader& header) {
    return {fmt::format("frame {}", index), header.time_s > 0.0 ? std::optional(header.time_s) : std::nullopt,
            std::nullopt, SettingsOf(header)};
  }

  void DescribeSonar() {
    info_.source = name_;
    info_.format = "ARIS v5";
    info_.sonar.name = ModelName(first_);
    info_.sonar.frequency_hz = FrequencyHz(first_);
    info_.sonar.axes = AxesOf(first_, FrameName(0));
    info_.sonar.sound_speed_m_per_s = first_.sound_speed_m_per_s;
    info_.scale.full_scale = 255.0;
    info_.scale.db_span = kDbSpan;
    if (first_.lens == ArisLens::kTelephoto) {
      info_.notes.emplace_back(
          "The elevation beam width is not recorded, and not known with a telephoto lens.");
    } else {
      info_.sonar.elevation_beam_width_deg = first_.system == ArisSystem::kAris3000 ? 15.0 : 14.0;
      info_.notes.emplace_back("The elevation beam width is the maker's nominal one; it is not recorded.");
    }
    if (first_.water_temperature_c >= -3.0f && first_.water_temperature_c <= 45.0f &&
        first_.salinity_ppt <= 50) {
      info_.water = Water{.temperature_c = first_.water_temperature_c,
                          .salinity_ppt = static_cast<double>(first_.salinity_ppt)};
      info_.notes.emplace_back("Acidity and depth of the water are not recorded; defaults stand for them.");
    } else {
      info_.notes.push_back(
          fmt::format("Water temperature {} C and salinity {} ppt are no water's; left out.",
                      first_.water_temperature_c, first_.salinity_ppt));
    }
    info_.settings = SettingsOf(first_);
    info_.details = {{"frame rate", fmt::format("{:.3f} Hz", first_.frame_rate_hz)},
                     {"receiver gain", fmt::format("{} dB", first_.gain_db)},
                     {"pulse width", fmt::format("{} us", first_.pulse_width_us)},
                     {"sample period", fmt::format("{} us", first_.sample_period_us)},
                     {"ping mode", fmt::format("{} ({} beams)", first_.ping_mode, first_.beam_count())},
                     {"frequency", first_.high_frequency ? "high" : "low"},
                     {"lens", first_.lens == ArisLens::kTelephoto ? "telephoto" : "standard"},
                     {"water temperature", fmt::format("{:.1f} C", first_.water_temperature_c)},
                     {"salinity", fmt::format("{} ppt", first_.salinity_ppt)}};
  }

  void NoteWindow() {
    const double window_end_m = double{first_.window_start_m} + first_.window_length_m;
    const double tolerance_m = first_.bin_m();
    // Negated, so that a NaN in the header is noted too.
    if (!(std::abs(first_.window_start_m - first_.range_min_m()) <= tolerance_m &&
          std::abs(window_end_m - first_.range_max_m()) <= tolerance_m)) {
      info_.notes.push_back(
          fmt::format("WindowStart and WindowLength say {:.4f}..{:.4f} m; the sample timing, which is right, "
                      "{:.4f}..{:.4f} m.",
                      first_.window_start_m, window_end_m, first_.range_min_m(), first_.range_max_m()));
    }
  }

  fs::path file_;
  std::string name_;
  ArisHeader first_;
  int frame_count_ = 0;
  RecordingInfo info_;
};

}  // namespace

bool IsAris(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) < sizeof(kMagic) || error) return false;
  return LittleEndian(ReadFileRange(path, 0, sizeof(kMagic), "magic number")) == kMagic;
}

std::unique_ptr<RecordingSource> OpenAris(const fs::path& path) {
  return std::make_unique<ArisRecording>(path);
}

}  // namespace sonarcal
