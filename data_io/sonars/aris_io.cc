#include "data_io/sonars/aris_io.h"

#include <algorithm>
#include <cmath>

#include "core/sonars/aris_pings.h"
#include "core/types/error.h"
#include "data_io/files/byte_reader.h"
#include "data_io/sonars/aris_empty_pings.h"
#include "data_io/sonars/aris_model.h"
#include "data_io/sonars/frames_by_size.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kMagic = 0x05464444;
constexpr std::uint64_t kHeaderBytes = 1024;  // size of the file header, and of each frame header

std::uint64_t FrameBytes(const ArisHeader& header) {
  return kHeaderBytes + static_cast<std::uint64_t>(header.beam_count()) * header.samples_per_beam;
}

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
  header.cycle_period_us = reader.U32(448, "CyclePeriod");
  header.sample_period_us = reader.U32Within(452, "SamplePeriod", 1, 1000);
  header.frame_rate_hz = reader.F32(460, "FrameRate");
  header.sound_speed_m_per_s = reader.F32(464, "SoundSpeed");
  if (!(header.sound_speed_m_per_s >= 1300.0f && header.sound_speed_m_per_s <= 1700.0f)) {
    throw DataError("{}: {} m/s, expected 1300..1700", reader.Where(464, "SoundSpeed"),
                    header.sound_speed_m_per_s);
  }
  header.samples_per_beam = reader.U32Within(468, "SamplesPerBeam", 1, kMaxArisSamplesPerBeam);
  header.sample_start_delay_us = reader.U32Within(476, "SampleStartDelay", 0, 1'000'000);
  header.lens = reader.U32(480, "LargeLens") != 0 ? ArisLens::kTelephoto : ArisLens::kStandard;
  header.system = static_cast<ArisSystem>(reader.U32Within(484, "TheSystemType", 0, 2));
  header.by_beam = reader.U32(516, "ReorderedSamples") != 0;
  if (!header.by_beam && ArisPingsPerFrame(static_cast<int>(header.ping_mode)) == 0) {
    throw DataError(
        "{}: 0 with PingMode {}, expected 1 (samples sorted by beam) or PingMode 1, 3, 6 or 9, whose sending "
        "order is "
        "known",
        reader.Where(516, "ReorderedSamples"), header.ping_mode);
  }
  header.salinity_ppt = reader.U32(520, "Salinity");
  return header;
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
    const FramesBySize frames = CountFramesBySize(name_, size, kHeaderBytes, FrameBytes(first_));
    if (frames.count == 0) {
      throw DataError("{}: byte {}: frame 0: the file ends at byte {}, expected {} beams x {} samples", name_,
                      2 * kHeaderBytes, size, first_.beam_count(), first_.samples_per_beam);
    }
    frame_count_ = frames.count;
    info_.source = name_;
    info_.format = "ARIS v5";
    DescribeAris(first_, FrameName(0), info_);
    NoteFrameCount(frames, reader.U32(4, "FrameCount"), info_.notes);
    NoteArisWindow(first_, info_);
    if (!first_.by_beam)
      info_.notes.emplace_back("Samples are in the order of sending and were sorted by beam.");
    FindEmptyPings();
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return frame_count_; }

  FrameInfo frame_info(int index) const override { return InfoOf(index, ReadHeader(index)); }

  Frame ReadFrame(int index) const override {
    const ArisHeader header = ReadHeader(index);
    const int beams = header.beam_count();
    Frame frame{InfoOf(index, header),
                {ArisAxes(header, FrameName(index)), info_.scale,
                 Grid<float>(static_cast<int>(header.samples_per_beam), beams)}};
    const std::vector<std::byte> grey = SamplesByBeam(index, header);
    const std::byte* next = grey.data();
    for (int bin = 0; bin < frame.image.value.rows(); ++bin) {
      // ARIS beams are numbered from the right, columns from the left.
      for (int column = beams - 1; column >= 0; --column) {
        frame.image.value(bin, column) = std::to_integer<std::uint8_t>(*next++);
      }
    }
    return frame;
  }

 private:
  std::uint64_t Offset(int index) const {
    SONARCAL_CHECK(index >= 0 && index < frame_count_, "frame {} of {}", index, frame_count_);
    return kHeaderBytes + static_cast<std::uint64_t>(index) * FrameBytes(first_);
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

  // By sample and ARIS beam number.
  std::vector<std::byte> SamplesByBeam(int index, const ArisHeader& header) const {
    const std::size_t count = static_cast<std::size_t>(header.beam_count()) * header.samples_per_beam;
    std::vector<std::byte> samples = ReadFileRange(file_, Offset(index) + kHeaderBytes, count, "samples");
    return header.by_beam ? samples : ArisSamplesByBeam(samples, static_cast<int>(header.ping_mode));
  }

  // Looks at some frames, and at all frames if any of those lacks a ping.
  void FindEmptyPings() {
    constexpr int kMaxFrames = 32;
    const int some = std::min(frame_count_, kMaxFrames);
    if (!EmptyPingsOf(some).any()) return;
    EmptyPingsOf(frame_count_).Describe(info_);
  }

  // Examines `count` frames, evenly spread. Frames that cannot be read are left out.
  ArisEmptyPings EmptyPingsOf(int count) const {
    ArisEmptyPings empty(static_cast<int>(first_.ping_mode));
    for (int i = 0; i < count; ++i) {
      const auto index = static_cast<int>(static_cast<std::int64_t>(i) * frame_count_ / count);
      try {
        empty.Add(index, SamplesByBeam(index, ReadHeader(index)));
      } catch (const DataError&) {
        continue;
      }
    }
    return empty;
  }

  static FrameInfo InfoOf(int index, const ArisHeader& header) {
    return {fmt::format("frame {}", index), header.time_s > 0.0 ? std::optional(header.time_s) : std::nullopt,
            std::nullopt, ArisSettings(header)};
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

}  // namespace sonarcal::data_io
