#include "data_io/sonars/aris_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numeric>
#include <set>

#include "core/types/units.h"
#include "data_io/recordings/recording_io.h"
#include "tests/data_io/byte_writer.h"
#include "tests/data_io/recording_file_test.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

using testing::ByteWriter;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::uint32_t kMagic = 0x05464444;
constexpr int kSamples = 20;

// What a small ARIS 3000 recording at 64 beams says; a test changes what it is about.
struct SyntheticAris {
  int frames = 2;
  std::uint32_t header_frame_count = 2;
  std::uint32_t ping_mode = 6;
  std::uint32_t system = 1;
  std::uint32_t high_frequency = 0;
  std::uint32_t large_lens = 0;
  std::uint32_t samples = kSamples;
  std::uint32_t sample_period_us = 10;
  std::uint32_t cycle_period_us = 0;
  std::uint32_t reordered = 1;
  float sound_speed_m_per_s = 1500.0f;
  float water_temperature_c = 12.5f;
  float window_start_m = 0.75f;
  float window_length_m = 0.15f;
  int beams = 64;
  std::uint32_t gain_db = 18;
  std::uint32_t pulse_width_us = 15;

  std::size_t FrameOffset(int frame) const {
    return 1024 + static_cast<std::size_t>(frame) * (1024 + std::size_t(beams) * kSamples);
  }

  // Pixel (sample, ARIS beam) of frame k is (7 sample + beam + 100 k) mod 256.
  ByteWriter Write() const {
    ByteWriter file;
    file.U32(0, kMagic);
    file.U32(4, header_frame_count);
    file.Grow(FrameOffset(frames));
    for (int k = 0; k < frames; ++k) {
      const std::size_t at = FrameOffset(k);
      file.U32(at + 0, k);
      file.U64(at + 4, 1'371'198'079'122'519 + 150'000ull * k);
      file.U32(at + 12, kMagic);
      file.F32(at + 52, window_start_m);
      file.F32(at + 56, window_length_m);
      file.U32(at + 68, gain_db);
      file.F32(at + 224, water_temperature_c);
      file.U32(at + 436, ping_mode);
      file.U32(at + 440, high_frequency);
      file.U32(at + 444, pulse_width_us);
      file.U32(at + 448, cycle_period_us);
      file.U32(at + 452, sample_period_us);
      file.F32(at + 460, 6.5f);
      file.F32(at + 464, sound_speed_m_per_s);
      file.U32(at + 468, samples);
      file.U32(at + 476, 1000);
      file.U32(at + 480, large_lens);
      file.U32(at + 484, system);
      file.U32(at + 516, reordered);
      file.U32(at + 520, 35);
      for (int i = 0; i < kSamples; ++i) {
        for (int b = 0; b < beams; ++b) {
          file.U8(at + 1024 + std::size_t(i) * beams + b, static_cast<std::uint8_t>(7 * i + b + 100 * k));
        }
      }
    }
    return file;
  }
};

class ArisTest : public testing::RecordingFileTest {
 protected:
  ArisTest() : RecordingFileTest("test.aris") {}
  std::string Refusal(const SyntheticAris& aris) { return RecordingFileTest::Refusal(aris.Write().bytes()); }
};

TEST(ArisSample, FieldsEqualThoseOfTheMakersFile) {
  SONARCAL_NEEDS_RECORDING(path, "aris1200_telephoto/sample.aris");
  const auto recording = OpenRecording(path);
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.format, "ARIS v5");
  EXPECT_EQ(info.sonar.name, "ARIS 1200, telephoto lens");
  EXPECT_EQ(info.sonar.frequency_hz, 1.2e6);
  EXPECT_EQ(info.settings.compression, Compression::kLogarithm);
  EXPECT_EQ(info.settings.time_varied_gain, std::nullopt) << "not recorded";
  EXPECT_EQ(recording->frame_info(3).settings, info.settings);
  EXPECT_EQ(recording->frame_count(), 6);
  EXPECT_EQ(info.sonar.axes.range_bins, 2000);
  EXPECT_NEAR(info.sonar.axes.range_min_m, 3.2976, 5e-5);
  EXPECT_NEAR(info.sonar.axes.range_max_m, 23.4007, 5e-5);
  ASSERT_EQ(info.sonar.axes.beam_count(), 48);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.front()), -7.339, 1e-9);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.back()), 7.339, 1e-9);
  EXPECT_NEAR(info.sonar.sound_speed_m_per_s, 1435.933, 1e-3);
  ASSERT_TRUE(info.water);
  EXPECT_EQ(info.water->temperature_c, 9.0);
  EXPECT_EQ(info.water->salinity_ppt, 0.0);
  EXPECT_EQ(info.scale.db_span, 80.0);
  EXPECT_THAT(info.notes, Contains(HasSubstr("3.3299..23.6299 m")));

  // From an independent decoding with NumPy, mirrored left to right.
  const Frame frame = recording->ReadFrame(0);
  ASSERT_TRUE(frame.info.time_s);
  EXPECT_NEAR(*frame.info.time_s, 1371198079.122519, 1e-5);
  const auto& value = frame.image.value;
  EXPECT_EQ(value(0, 0), 131.0f);
  EXPECT_EQ(value(0, 47), 119.0f);
  EXPECT_EQ(value(1000, 5), 92.0f);
  EXPECT_EQ(value(1999, 47), 46.0f);
  EXPECT_EQ(std::accumulate(value.values().begin(), value.values().end(), 0.0), 8735309.0);
  const auto last = recording->ReadFrame(5);
  EXPECT_EQ(std::accumulate(last.image.value.values().begin(), last.image.value.values().end(), 0.0),
            8763677.0);
}

TEST_F(ArisTest, ReadsFramesWithTheLastBeamInTheLeftmostColumn) {
  const auto recording = Open(SyntheticAris{}.Write().bytes());
  ASSERT_EQ(recording->frame_count(), 2);
  const PolarAxes& axes = recording->info().sonar.axes;
  EXPECT_NEAR(axes.range_min_m, 0.75, 1e-9);
  EXPECT_NEAR(axes.range_max_m, 0.75 + kSamples * 0.0075, 1e-9);
  EXPECT_EQ(axes.beam_count(), 64);
  EXPECT_LT(axes.beam_azimuth_rad.front(), 0.0);
  EXPECT_EQ(recording->info().sonar.frequency_hz, 1.8e6);
  EXPECT_THAT(recording->info().notes, Not(Contains(HasSubstr("WindowStart"))));
  EXPECT_THAT(recording->info().notes, Not(Contains(HasSubstr("frames"))));
  const Frame frame = recording->ReadFrame(1);
  EXPECT_EQ(frame.info.name, "frame 1");
  EXPECT_EQ(frame.image.value(0, 63), 100.0f);  // sample 0, ARIS beam 0
  EXPECT_EQ(frame.image.value(0, 0), 163.0f);   // sample 0, ARIS beam 63
  EXPECT_EQ(frame.image.value(3, 60), 100.0f + 21 + 3);
}

TEST_F(ArisTest, TakesBeamTableAndFrequencyFromTheHeader) {
  SyntheticAris aris{.ping_mode = 9, .high_frequency = 1, .beams = 128};
  auto recording = Open(aris.Write().bytes());
  EXPECT_EQ(recording->info().sonar.axes.beam_count(), 128);
  EXPECT_EQ(recording->info().sonar.frequency_hz, 3.0e6);

  aris = {.ping_mode = 3, .system = 0, .large_lens = 1, .beams = 96};
  recording = Open(aris.Write().bytes());
  EXPECT_EQ(recording->info().sonar.frequency_hz, 1.1e6);
  EXPECT_NEAR(DegFromRad(recording->info().sonar.axes.beam_azimuth_rad.front()), -7.419, 1e-9);

  aris.system = 2;
  aris.large_lens = 0;
  EXPECT_THAT(Refusal(aris), HasSubstr("ARIS 1200 with 96 beams (PingMode 3)"));
}

TEST_F(ArisTest, CountsFramesByTheFilesSize) {
  SyntheticAris aris{.header_frame_count = 4'000'000'000};
  std::string bytes = aris.Write().bytes();
  auto recording = Open(bytes);
  EXPECT_EQ(recording->frame_count(), 2);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("4000000000 frames; the file's size gives 2")));

  recording = Open(bytes.substr(0, bytes.size() - 1));
  EXPECT_EQ(recording->frame_count(), 1);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("2303 bytes are not a whole frame")));
  recording->ReadFrame(0);
  EXPECT_THROW(recording->ReadFrame(1), std::logic_error);
}

TEST_F(ArisTest, NotesAWindowThatDisagreesWithTheTiming) {
  for (const float start_m : {0.8f, std::numeric_limits<float>::quiet_NaN()}) {
    const SyntheticAris aris{.window_start_m = start_m};
    EXPECT_THAT(Open(aris.Write().bytes())->info().notes, Contains(HasSubstr("WindowStart")));
  }
}

TEST_F(ArisTest, LeavesOutWaterThatCannotBe) {
  for (const float temperature_c : {-300.0f, 1e30f, std::numeric_limits<float>::quiet_NaN()}) {
    const SyntheticAris aris{.water_temperature_c = temperature_c};
    const auto recording = Open(aris.Write().bytes());
    EXPECT_FALSE(recording->info().water);
    EXPECT_THAT(recording->info().notes, Contains(HasSubstr("are impossible")));
  }
}

TEST_F(ArisTest, LeavesOutGainsAndPulsesThatCannotBe) {
  const auto recording = Open(SyntheticAris{}.Write().bytes());
  EXPECT_EQ(recording->info().settings.gain_db, 18.0);
  EXPECT_EQ(recording->info().settings.pulse_length_us, 15.0);
  EXPECT_THAT(recording->info().notes, Not(Contains(HasSubstr("impossible"))));
  for (const std::uint32_t pulse_width_us : {0U, 1'000'001U}) {
    const SyntheticAris aris{.gain_db = 0xffffffff, .pulse_width_us = pulse_width_us};
    const auto odd = Open(aris.Write().bytes());
    EXPECT_EQ(odd->info().settings.gain_db, std::nullopt);
    EXPECT_EQ(odd->frame_info(1).settings.pulse_length_us, std::nullopt);
    EXPECT_THAT(odd->info().notes, Contains(HasSubstr("Receiver gain 4294967295 dB is impossible")));
    EXPECT_THAT(odd->info().notes,
                Contains(fmt::format("Pulse width {} us is impossible and was omitted.", pulse_width_us)));
    const testing::TempDir dir;
    WriteRecording(*odd, dir / "copy");
    EXPECT_EQ(OpenRecording(dir / "copy")->info().settings, odd->info().settings);
  }
}

TEST_F(ArisTest, RefusesFieldsOutsideTheirDomain) {
  EXPECT_THAT(Refusal({.ping_mode = 0}), HasSubstr("byte 1460: PingMode: 0, expected 1..12"));
  EXPECT_THAT(Refusal({.ping_mode = 13}), HasSubstr("PingMode"));
  EXPECT_THAT(Refusal({.system = 3}), HasSubstr("TheSystemType"));
  EXPECT_THAT(Refusal({.samples = 0}), HasSubstr("SamplesPerBeam"));
  EXPECT_THAT(Refusal({.samples = 0xffffffff}), HasSubstr("SamplesPerBeam"));
  EXPECT_THAT(Refusal({.samples = 60000}), HasSubstr("the file ends at byte"));
  EXPECT_THAT(Refusal({.sample_period_us = 0}), HasSubstr("SamplePeriod"));
  EXPECT_THAT(Refusal({.ping_mode = 7, .reordered = 0}),
              HasSubstr("byte 1540: ReorderedSamples: 0 with PingMode 7, expected 1"));
  for (const float c : {0.0f, -1500.0f, 1e9f, std::numeric_limits<float>::quiet_NaN(),
                        std::numeric_limits<float>::infinity()}) {
    EXPECT_THAT(Refusal({.sound_speed_m_per_s = c}), HasSubstr("SoundSpeed"));
  }
}

TEST_F(ArisTest, RefusesAFrameOfAnotherShapeOrNoFrame) {
  const SyntheticAris aris;
  ByteWriter file = aris.Write();
  file.U32(aris.FrameOffset(1) + 468, kSamples - 1);
  EXPECT_THAT(RecordingFileTest::Refusal(file.bytes()),
              HasSubstr("frame 1: PingMode 6 and 19 samples a beam, expected 6 and 20"));

  file = aris.Write();
  file.U32(aris.FrameOffset(1) + 12, 0);
  EXPECT_THAT(RecordingFileTest::Refusal(file.bytes()),
              HasSubstr("byte 3340: Version: 0x00000000, expected 0x05464444"));
}

TEST_F(ArisTest, SamplesInTheOrderOfSendingAreSortedByBeam) {
  // Channels of a ping in the order of sending, as beams of the ping.
  constexpr std::array kBeamOfChannel = {10, 2, 14, 6, 8, 0, 12, 4, 11, 3, 15, 7, 9, 1, 13, 5};
  SyntheticAris aris;
  const auto sorted = Open(aris.Write().bytes());
  const Grid<float> expected = sorted->ReadFrame(1).image.value;
  EXPECT_THAT(sorted->info().notes, Not(Contains(HasSubstr("order of sending"))));
  aris.reordered = 0;
  ByteWriter file = aris.Write();
  for (int k = 0; k < aris.frames; ++k) {
    std::size_t at = aris.FrameOffset(k) + 1024;
    for (int ping = 0; ping < 4; ++ping) {
      for (int i = 0; i < kSamples; ++i) {
        for (const int beam : kBeamOfChannel)
          file.U8(at++, static_cast<std::uint8_t>(7 * i + 4 * beam + ping + 100 * k));
      }
    }
  }
  const auto sent = Open(file.bytes());
  EXPECT_EQ(sent->ReadFrame(1).image.value, expected);
  EXPECT_THAT(sent->info().notes, Contains(HasSubstr("order of sending")));
  testing::ExpectOnlyDataErrors(path_, path_, file.bytes(), 2048);
}

// The manufacturer's frame has only three fields in its header; the others are given here.
TEST_F(ArisTest, TheMakersFrameIsSortedLikeItsResult) {
  SONARCAL_NEEDS_RECORDING(input, "aris_sdk_frames/reorder_frame_input.dat");
  SONARCAL_NEEDS_RECORDING(result, "aris_sdk_frames/reorder_frame_result.dat");
  const auto file_of = [](const std::filesystem::path& frame) {
    ByteWriter file;
    file.U32(0, kMagic);
    std::string bytes = file.bytes();
    bytes.resize(1024);
    bytes += testing::ReadFile(frame);
    ByteWriter header;
    header.Grow(1024);
    header.U64(4, 1'371'198'079'122'519);
    header.U32(12, kMagic);
    header.F32(224, 10.0F);
    header.U32(452, 10);
    header.F32(464, 1450.0F);
    header.U32(476, 1000);
    for (const auto& [at, count] : {std::pair{4, 12}, {224, 4}, {452, 4}, {464, 4}, {476, 12}, {520, 4}})
      bytes.replace(1024 + at, count, header.bytes(), at, count);
    return bytes;
  };
  const Grid<float> sorted = Open(file_of(result))->ReadFrame(0).image.value;
  EXPECT_EQ(sorted.rows(), 512);
  EXPECT_EQ(sorted.cols(), 48);
  const auto recording = Open(file_of(input));
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("order of sending")));
  EXPECT_EQ(recording->ReadFrame(0).image.value, sorted);
}

std::string Detail(const RecordingInfo& info, const std::string& name) {
  for (const auto& [key, value] : info.details) {
    if (key == name) return value;
  }
  return {};
}

// Column 0 is the leftmost beam, which the sonar numbers last.
TEST_F(ArisTest, KnowsThePingOfEachColumn) {
  SyntheticAris aris{.cycle_period_us = 7120};
  const PingPattern pings = Open(aris.Write().bytes())->info().sonar.pings;
  ASSERT_EQ(pings.of_beam.size(), 64U);
  EXPECT_EQ(pings.count(), 4);
  for (int column = 0; column < 64; ++column) EXPECT_EQ(pings.of_beam[column], (63 - column) % 4) << column;
  EXPECT_DOUBLE_EQ(pings.period_s, 7.12e-3);
  aris.cycle_period_us = 0;
  EXPECT_FALSE(Open(aris.Write().bytes())->info().sonar.pings.is_timed());
}

TEST_F(ArisTest, SaysWhichPingABeamBelongsTo) {
  SyntheticAris aris{.cycle_period_us = 7120};
  EXPECT_EQ(
      Detail(Open(aris.Write().bytes())->info(), "pings"),
      "4 pings make a frame, 7.12 ms apart: beam k, counted from 0 at the right, belongs to ping k mod 4");
  aris.cycle_period_us = 0xaaaaaaaa;
  EXPECT_EQ(Detail(Open(aris.Write().bytes())->info(), "pings"),
            "4 pings make a frame: beam k, counted from 0 at the right, belongs to ping k mod 4");
  aris.ping_mode = 7;
  EXPECT_EQ(Detail(Open(aris.Write().bytes())->info(), "pings"), "");
}

// Columns that info.valid excludes in all bins.
std::set<int> EmptyColumns(const RecordingInfo& info) {
  std::set<int> columns;
  if (!info.valid) return columns;
  for (int column = 0; column < info.valid->cols(); ++column) {
    bool any = false;
    for (int bin = 0; bin < info.valid->rows(); ++bin) any = any || (*info.valid)(bin, column) != 0;
    if (!any) columns.insert(column);
  }
  return columns;
}

// Sets the samples of `frame` to 0 for which `dark(sample, beam)` is true.
template <typename Dark>
void Darken(const SyntheticAris& aris, ByteWriter& file, int frame, const Dark& dark) {
  for (int i = 0; i < kSamples; ++i) {
    for (int b = 0; b < aris.beams; ++b) {
      if (dark(i, b)) file.U8(aris.FrameOffset(frame) + 1024 + std::size_t(i) * aris.beams + b, 0);
    }
  }
}

TEST_F(ArisTest, PingsThatNoFrameHoldsAreMarkedAsNotMeasured) {
  const SyntheticAris aris{.frames = 3};
  ByteWriter file = aris.Write();
  for (int k = 0; k < 3; ++k)
    Darken(aris, file, k, [](int i, int b) { return b % 4 == 1 || b % 4 == 3 || i >= 15; });
  const auto recording = Open(file.bytes());
  const RecordingInfo& info = recording->info();
  EXPECT_THAT(info.notes,
              Contains("The beams of 2 of 4 pings are empty (only zeros) in 3 of 3 frames: 32 of 64 beams "
                       "are marked as not measured."));
  EXPECT_THAT(info.notes,
              Contains("No beam of any frame has a sample other than 0 beyond the first 15 of 20 range "
                       "bins: the other bins are marked as not measured."));
  const std::set<int> empty = EmptyColumns(info);
  EXPECT_EQ(empty.size(), 32U);
  // Column 0 is beam 63, which belongs to ping 3.
  EXPECT_TRUE(empty.contains(0) && !empty.contains(1) && empty.contains(2) && !empty.contains(63));
  EXPECT_EQ(CountSet(*info.valid), 32 * 15);
  testing::ExpectOnlyDataErrors(path_, path_, file.bytes(), 2048);
}

TEST_F(ArisTest, PingsThatSomeFramesLackAreOnlyNoted) {
  const SyntheticAris aris{.frames = 40};
  ByteWriter file = aris.Write();
  for (const int k : {6, 7, 20}) Darken(aris, file, k, [](int, int b) { return b % 4 == 2; });
  const auto recording = Open(file.bytes());
  EXPECT_FALSE(recording->info().valid);
  EXPECT_THAT(
      recording->info().notes,
      Contains(
          "The beams of 1 of 4 pings are empty (only zeros) in 3 of 40 frames, the first of which is frame "
          "6; they are not marked, because other frames hold these beams."));
}

// Zeros of a sonar that works.
TEST_F(ArisTest, DarkFramesAreNotCalledBroken) {
  const SyntheticAris aris;
  const auto expect_whole = [&](const char* what, const auto& dark) {
    ByteWriter file = aris.Write();
    for (int k = 0; k < 2; ++k) Darken(aris, file, k, dark);
    const auto recording = Open(file.bytes());
    EXPECT_FALSE(recording->info().valid) << what;
    EXPECT_THAT(recording->info().notes, Not(Contains(HasSubstr("empty")))) << what;
  };
  expect_whole("nothing at all", [](int, int) { return true; });
  expect_whole("one sample", [](int i, int b) { return i != 9 || b != 21; });
  expect_whole("a target in three beams", [](int, int b) { return b < 20 || b > 22; });
  expect_whole("two targets in the same ping", [](int, int b) { return b != 20 && b != 44; });
  expect_whole("half of the fan", [](int, int b) { return b < 32; });
  expect_whole("one sample in each beam", [](int i, int) { return i != 3; });
  expect_whole("a shadow to the end of the window", [](int i, int) { return i > 5; });
}

// 27 frames with good headers. An independent decoding with NumPy found samples in beams 0, 8, 16, ...
// only, and there in the first 205 of 946 bins only.
TEST(ArisBroken, EmptyPingsAreNoticedAndNotMeasured) {
  SONARCAL_NEEDS_RECORDING(path, "aris3000_broken/output.aris");
  const auto recording = OpenRecording(path);
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(recording->frame_count(), 27);
  EXPECT_EQ(
      Detail(info, "pings"),
      "8 pings make a frame, 7.12 ms apart: beam k, counted from 0 at the right, belongs to ping k mod 8");
  EXPECT_THAT(info.notes,
              Contains("The beams of 7 of 8 pings are empty (only zeros) in 27 of 27 frames: 112 of 128 "
                       "beams are marked as not measured."));
  EXPECT_THAT(info.notes,
              Contains("No beam of any frame has a sample other than 0 beyond the first 205 of 946 range "
                       "bins: the other bins are marked as not measured."));
  ASSERT_TRUE(info.valid);
  EXPECT_EQ(CountSet(*info.valid), 16 * 205);
  EXPECT_EQ((*info.valid)(0, 127), 1);
  EXPECT_EQ((*info.valid)(0, 126), 0);
  EXPECT_EQ((*info.valid)(204, 119), 1);
  EXPECT_EQ((*info.valid)(205, 119), 0);
  // A copy keeps the mask.
  const testing::TempDir dir;
  WriteRecording(*recording, dir / "copy");
  EXPECT_EQ(OpenRecording(dir / "copy")->info().valid, info.valid);
}

TEST_F(ArisTest, HostileFilesEndInDataError) {
  testing::ExpectOnlyDataErrors(path_, path_, SyntheticAris{}.Write().bytes(), 2048);
}

}  // namespace
}  // namespace sonarcal::data_io
