#include "data_io/sonars/ddf_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/units.h"
#include "data_io/sonars/didson_io.h"
#include "tests/data_io/byte_writer.h"
#include "tests/data_io/recording_file_test.h"

namespace sonarcal::data_io {
namespace {

using testing::ByteWriter;
using ::testing::Contains;
using ::testing::HasSubstr;

// A small made-up recording, by the published layout; a test changes what it is about.
struct MadeUpDdf {
  int version = 4;
  int frames = 2;
  std::uint32_t header_frames = 2;
  std::uint32_t resolution = 1;
  std::uint32_t beams = 96;
  std::uint32_t samples = 512;
  std::uint32_t reverse = 1;
  std::uint32_t serial = 200;
  std::uint32_t flags = 0;
  std::uint32_t start_code = 5;
  std::uint32_t length_code = 1;
  std::uint32_t year = 2016;
  std::uint32_t month = 7;
  std::uint32_t day = 19;
  std::uint32_t gain_db = 40;

  std::size_t FrameOffset(int frame) const {
    const std::size_t header = version == 3 ? 512 : 1024;
    const std::size_t frame_header = version == 3 ? 256 : 1024;
    return header + static_cast<std::size_t>(frame) * (frame_header + std::size_t{beams} * 512);
  }

  // Pixel (range, beam in the file) of frame k is (7 range + beam + 100 k) mod 256.
  ByteWriter Write() const {
    ByteWriter file;
    for (int i = 0; i < 3; ++i) file.U8(i, "DDF"[i]);
    file.U8(3, static_cast<std::uint8_t>(version));
    file.U32(4, header_frames);
    file.U32(8, 10);
    file.U32(12, resolution);
    file.U32(16, beams);
    file.U32(24, samples);
    file.U32(40, reverse);
    file.U32(44, serial);
    file.Grow(FrameOffset(frames));
    for (int k = 0; k < frames; ++k) {
      const std::size_t at = FrameOffset(k);
      const std::uint32_t clock[] = {year, month, day, 22, 12, 56, 47U + static_cast<std::uint32_t>(k)};
      for (int i = 0; i < 7; ++i) file.U32(at + 20 + 4 * i, clock[i]);
      file.U32(at + 52, start_code);
      file.U32(at + 56, length_code);
      file.U32(at + 68, gain_db);
      file.F32(at + 164, -12.5F);
      file.U32(at + 192, flags);
      const std::size_t pixels = at + (version == 3 ? 256 : 1024);
      for (std::size_t i = 0; i < 512; ++i) {
        for (std::size_t b = 0; b < beams; ++b)
          file.U8(pixels + i * beams + b, static_cast<std::uint8_t>(7 * i + b + 100 * k));
      }
    }
    return file;
  }
};

class DdfTest : public testing::RecordingFileTest {
 protected:
  DdfTest() : RecordingFileTest("test.ddf") {}
  std::unique_ptr<RecordingSource> Open(const MadeUpDdf& ddf) {
    return RecordingFileTest::Open(ddf.Write().bytes());
  }
  std::string Refusal(const MadeUpDdf& ddf) { return RecordingFileTest::Refusal(ddf.Write().bytes()); }
};

TEST_F(DdfTest, BothVersionsGiveTheirPixels) {
  for (const int version : {3, 4}) {
    for (const std::uint32_t reverse : {0U, 1U}) {
      const auto recording = Open({.version = version, .reverse = reverse});
      EXPECT_EQ(recording->info().format, version == 3 ? "DIDSON DDF v3" : "DIDSON DDF v4");
      ASSERT_EQ(recording->frame_count(), 2);
      const Frame frame = recording->ReadFrame(1);
      ASSERT_EQ(frame.image.value.rows(), 512);
      ASSERT_EQ(frame.image.value.cols(), 96);
      // The leftmost column is the file's first beam where it is reversed already, else its last.
      EXPECT_EQ(frame.image.value(3, 0), (7 * 3 + (reverse == 1 ? 0 : 95) + 100) % 256);
      EXPECT_EQ(frame.image.value(511, 95), (7 * 511 + (reverse == 1 ? 95 : 0) + 100) % 256);
    }
  }
}

// Start and length in metres, from the tables of the maker's readers.
TEST_F(DdfTest, WindowsFollowCodesFlagsAndSerialNumber) {
  struct Case {
    MadeUpDdf ddf;
    double start_m;
    double length_m;
  };
  const Case cases[] = {
      {{.flags = 1, .start_code = 2, .length_code = 3}, 0.75, 9.0},
      {{.flags = 0, .start_code = 2, .length_code = 0}, 0.838, 1.25},
      {{.version = 3, .flags = 0, .start_code = 2, .length_code = 0}, 0.838, 0.83},
      {{.version = 3, .flags = 1, .start_code = 2, .length_code = 0}, 0.75, 1.125},
      {{.resolution = 0, .beams = 48, .flags = 1, .start_code = 3, .length_code = 3}, 2.25, 36.0},
      {{.resolution = 0, .beams = 48, .flags = 2, .start_code = 3, .length_code = 3}, 2.514, 70.0},
      {{.flags = 3, .start_code = 1, .length_code = 1}, 0.375, 4.5},
      {{.serial = 18, .flags = 0, .start_code = 1, .length_code = 2}, 0.375, 4.5},
      {{.serial = 15, .flags = 0, .start_code = 1, .length_code = 2}, 0.375, 9.0},
  };
  for (const Case& of : cases) {
    const auto recording = Open(of.ddf);
    const PolarAxes& axes = recording->info().sonar.axes;
    EXPECT_NEAR(axes.range_min_m, of.start_m, 1e-12);
    EXPECT_NEAR(axes.range_max_m - axes.range_min_m, of.length_m, 1e-12);
  }
}

TEST_F(DdfTest, BeamsAreThoseOfTheLens) {
  const std::vector<double> of_96 = DidsonAzimuthsRad();
  EXPECT_EQ(Open({})->info().sonar.axes.beam_azimuth_rad, of_96);
  const auto low = Open({.resolution = 0, .beams = 48});
  const std::vector<double>& of_48 = low->info().sonar.axes.beam_azimuth_rad;
  ASSERT_EQ(of_48.size(), 48U);
  EXPECT_NEAR(of_48[10], 0.5 * (of_96[20] + of_96[21]), 1e-12);
  EXPECT_EQ(low->info().sonar.frequency_hz, 1.1e6);
  EXPECT_THAT(low->info().notes, Contains(HasSubstr("midway between two")));
}

TEST_F(DdfTest, TimesComeFromTheClockFields) {
  // 2016-07-19 22:12:56 UTC is 1468966376 s after 1970.
  EXPECT_NEAR(*Open({})->frame_info(1).time_s, 1468966376.48, 1e-6);
  const auto undated = Open({.month = 13});
  EXPECT_FALSE(undated->frame_info(0).time_s);
  EXPECT_THAT(undated->info().notes, Contains(HasSubstr("no valid date")));
}

// 257 and 275 are 1 and 19 in their last byte.
TEST_F(DdfTest, MonthsAndDaysOfMoreThanAByteAreNoDate) {
  EXPECT_FALSE(Open({.month = 257})->frame_info(0).time_s);
  EXPECT_FALSE(Open({.day = 275})->frame_info(0).time_s);
  EXPECT_FALSE(Open({.month = 2, .day = 30})->frame_info(0).time_s);
}

TEST_F(DdfTest, GainsThatCannotBeAreLeftOut) {
  EXPECT_EQ(Open({})->info().settings.gain_db, 40.0);
  const auto odd = Open({.gain_db = 1001});
  EXPECT_FALSE(odd->info().settings.gain_db);
  EXPECT_FALSE(odd->frame_info(1).settings.gain_db);
  EXPECT_THAT(odd->info().notes, ::testing::Contains("Receiver gain 1001 dB is impossible and was omitted."));
}

TEST_F(DdfTest, UntestedFormatsAndContradictoryCountsAreNoted) {
  const auto recording = Open({.header_frames = 7});
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("tried on no file of a real DIDSON")));
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("gives 7 frames; the file's size gives 2")));
  EXPECT_EQ(recording->info().sonar.sound_speed_m_per_s, 0.0);
  EXPECT_FALSE(recording->info().scale.db_span);
}

TEST_F(DdfTest, AFrameThatIsCutShortIsLeftOut) {
  const std::string bytes = MadeUpDdf{}.Write().bytes();
  testing::WriteFile(path_, bytes.substr(0, bytes.size() - 1));
  const auto recording = OpenRecording(path_);
  EXPECT_EQ(recording->frame_count(), 1);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("not a whole frame")));
}

TEST_F(DdfTest, FieldsOutsideTheirDomainAreRefusedByName) {
  EXPECT_THAT(Refusal({.beams = 64}), HasSubstr("byte 16: beams: 64, expected 48 or 96"));
  EXPECT_THAT(Refusal({.samples = 400}), HasSubstr("samples a beam: 400, expected 512..512"));
  EXPECT_THAT(Refusal({.start_code = 32}), HasSubstr("window start code: 32, expected 0..31"));
  EXPECT_THAT(Refusal({.length_code = 4}), HasSubstr("window length code: 4, expected 0..3"));
  EXPECT_THAT(Refusal({.frames = 0}), HasSubstr("frame 0: the file ends at byte 1024"));
  EXPECT_THAT(Refusal({.version = 2}), HasSubstr("not a recording of a known format"));
}

TEST_F(DdfTest, DamagedFilesEndInOneSentence) {
  const std::string bytes = MadeUpDdf{.version = 3, .frames = 1, .beams = 48}.Write().bytes();
  testing::ExpectOnlyDataErrors(path_, path_, bytes, 512 + 256);
}

}  // namespace
}  // namespace sonarcal::data_io
