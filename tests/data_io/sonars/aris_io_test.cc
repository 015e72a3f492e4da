#include "data_io/sonars/aris_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "core/types/units.h"
#include "tests/data_io/byte_writer.h"
#include "tests/data_io/recording_file_test.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

using testing::ByteWriter;
using ::testing::Contains;
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
  std::uint32_t reordered = 1;
  float sound_speed_m_per_s = 1500.0f;
  float water_temperature_c = 12.5f;
  float window_start_m = 0.75f;
  float window_length_m = 0.15f;
  int beams = 64;

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
      file.U32(at + 68, 18);
      file.F32(at + 224, water_temperature_c);
      file.U32(at + 436, ping_mode);
      file.U32(at + 440, high_frequency);
      file.U32(at + 444, 15);
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

TEST_F(ArisTest, RefusesFieldsOutsideTheirDomain) {
  EXPECT_THAT(Refusal({.ping_mode = 0}), HasSubstr("byte 1460: PingMode: 0, expected 1..12"));
  EXPECT_THAT(Refusal({.ping_mode = 13}), HasSubstr("PingMode"));
  EXPECT_THAT(Refusal({.system = 3}), HasSubstr("TheSystemType"));
  EXPECT_THAT(Refusal({.samples = 0}), HasSubstr("SamplesPerBeam"));
  EXPECT_THAT(Refusal({.samples = 0xffffffff}), HasSubstr("SamplesPerBeam"));
  EXPECT_THAT(Refusal({.samples = 60000}), HasSubstr("the file ends at byte"));
  EXPECT_THAT(Refusal({.sample_period_us = 0}), HasSubstr("SamplePeriod"));
  EXPECT_THAT(Refusal({.reordered = 0}), HasSubstr("ReorderedSamples"));
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

TEST_F(ArisTest, HostileFilesEndInDataError) {
  testing::ExpectOnlyDataErrors(path_, path_, SyntheticAris{}.Write().bytes(), 2048);
}

}  // namespace
}  // namespace sonarcal::data_io
