#include "data_io/sonars/oculus_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "core/types/units.h"
#include "tests/data_io/made_up_ping.h"
#include "tests/data_io/recording_file_test.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using testing::ByteWriter;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class OculusTest : public testing::RecordingFileTest {
 protected:
  OculusTest() : RecordingFileTest("ping.raw") {}
};

TEST(OculusSample, HoldsOnePingOfTheHighFrequency) {
  SONARCAL_NEEDS_RECORDING(path, "oculus_m1200d/one_ping_8bit.raw");
  const auto recording = OpenRecording(path);
  const RecordingInfo& info = recording->info();
  ASSERT_EQ(recording->frame_count(), 1);
  EXPECT_EQ(info.sonar.name, "Oculus M1200d");
  EXPECT_NEAR(info.sonar.frequency_hz, 2.0989e6, 50.0);
  EXPECT_NEAR(info.sonar.sound_speed_m_per_s, 1490.66, 5e-3);
  const PolarAxes& axes = info.sonar.axes;
  EXPECT_EQ(axes.range_bins, 703);
  EXPECT_EQ(axes.range_min_m, 0.0);
  EXPECT_NEAR(axes.range_bin_m(), 2.84219e-3, 5e-9);
  EXPECT_NEAR(axes.range_max_m, 1.998, 5e-4);
  ASSERT_EQ(axes.beam_count(), 256);
  EXPECT_NEAR(DegFromRad(axes.beam_azimuth_rad.front()), -30.0, 1e-9);
  EXPECT_NEAR(DegFromRad(axes.beam_azimuth_rad[1]), -29.74, 1e-9);
  EXPECT_NEAR(DegFromRad(axes.beam_azimuth_rad.back()), 30.0, 1e-9);
  ASSERT_TRUE(info.display_gamma);
  EXPECT_NEAR(*info.display_gamma, 127.0 / 255.0, 1e-12);
  EXPECT_FALSE(info.scale.db_span);
  // Temperature 2.6e-76 C and pressure -1.4e194 bar.
  EXPECT_FALSE(info.water);
  EXPECT_THAT(info.notes, AllOf(Contains(HasSubstr("Temperature 2.59965e-76 C")),
                                Contains(HasSubstr("Pressure -1.37331e+194 bar"))));

  // From an independent decoding with NumPy.
  const Grid<float> value = recording->ReadFrame(0).image.value;
  EXPECT_EQ(value(0, 0), 42.0f);
  EXPECT_EQ(value(100, 10), 17.0f);
  EXPECT_EQ(value(350, 128), 237.0f);
  EXPECT_EQ(value(702, 255), 55.0f);
  EXPECT_EQ(std::accumulate(value.values().begin(), value.values().end(), 0.0), 10052524.0);
}

TEST_F(OculusTest, ReadsBothVersionsInEverySampleSize) {
  for (const int version : {1, 2}) {
    for (const int bytes : {1, 2, 3, 4}) {
      const testing::MadeUpPing ping{.version = version, .bytes_per_sample = bytes};
      const auto recording = Open(ping.Write().bytes());
      const Frame frame = recording->ReadFrame(0);
      EXPECT_EQ(frame.info.name, "ping 77");
      EXPECT_EQ(frame.info.time_s, version == 2 ? std::optional(12.25) : std::nullopt);
      EXPECT_NEAR(frame.image.axes.range_max_m, 0.05, 1e-12);
      EXPECT_EQ(frame.image.scale.full_scale, std::pow(2.0, 8 * bytes) - 1.0);
      for (int range = 0; range < 5; ++range) {
        for (int beam = 0; beam < 4; ++beam) {
          EXPECT_EQ(frame.image.value(range, beam),
                    static_cast<float>(testing::MadeUpPing::Sample(range, beam, bytes)));
        }
      }
      ASSERT_TRUE(recording->info().water);
      EXPECT_EQ(recording->info().water->temperature_c, 11.5);
      EXPECT_EQ(recording->info().sonar.sound_speed_m_per_s, 1490.0);
    }
  }
}

TEST_F(OculusTest, ReadsVersion2WithoutExtendedFlags) {
  const testing::MadeUpPing ping{.version = 2, .extended_flags = false, .bytes_per_sample = 2};
  const auto recording = Open(ping.Write().bytes());
  EXPECT_EQ(recording->ReadFrame(0).image.value(4, 3), 43.0f * 257.0f);
  EXPECT_EQ(recording->info().sonar.frequency_hz, 2.1e6);
}

TEST_F(OculusTest, DividesByTheRootOfEachRowsGain) {
  for (const int bytes : {1, 2, 4}) {
    const testing::MadeUpPing ping{.bytes_per_sample = bytes, .gain = 7};
    const Grid<float> value = Open(ping.Write().bytes())->ReadFrame(0).image.value;
    for (int range = 0; range < 5; ++range) {
      const double expected = testing::MadeUpPing::Sample(range, 2, bytes) / std::sqrt(7.0 + range);
      EXPECT_NEAR(value(range, 2), expected, 1e-6 * expected);
    }
  }
  testing::MadeUpPing ping{.gain = 7};
  ByteWriter file = ping.Write();
  file.U32(ping.ImageOffset() + ping.RowBytes(), 0);
  EXPECT_THAT(Refusal(file.bytes()), HasSubstr("gain of a row: 0"));
}

TEST_F(OculusTest, TurnsBearingsThatRunFromRightToLeft) {
  const testing::MadeUpPing ping{.bearing_centideg = {300, 90, -90, -300}};
  const auto recording = Open(ping.Write().bytes());
  EXPECT_NEAR(DegFromRad(recording->info().sonar.axes.beam_azimuth_rad.front()), -3.0, 1e-12);
  EXPECT_EQ(recording->ReadFrame(0).image.value(0, 0), 3.0f);
}

TEST_F(OculusTest, WalksThroughMessagesAndKeepsTheWholePings) {
  const std::string ping = testing::MadeUpPing{}.Write().bytes();
  ByteWriter status;
  status.U16(0, 0x4f53);
  status.U16(6, 0x80);
  status.U32(10, 30);
  status.Grow(46);
  auto recording = Open(ping + status.bytes() + ping + ping.substr(0, ping.size() - 1));
  EXPECT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->ReadFrame(1).image.value(4, 3), 43.0f);
  EXPECT_THAT(recording->info().notes, AllOf(Contains(HasSubstr("1 messages that are not pings")),
                                             Contains(HasSubstr("is truncated"))));

  recording = Open(ping + "and then some text that is no message");
  EXPECT_EQ(recording->frame_count(), 1);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("are not an Oculus message")));

  EXPECT_THAT(Refusal(status.bytes()), HasSubstr("no whole simple ping result"));
}

TEST_F(OculusTest, LeavesOutGarbageAndSaysSo) {
  for (const double garbage : {kNaN, 1e300, -1e9, 2.6e-76}) {
    const testing::MadeUpPing ping{.frequency_hz = garbage,
                                   .temperature_c = garbage,
                                   .pressure_bar = garbage,
                                   .sound_speed_m_per_s = garbage};
    const auto recording = Open(ping.Write().bytes());
    const RecordingInfo& info = recording->info();
    EXPECT_EQ(info.sonar.frequency_hz, 0.0);
    EXPECT_EQ(info.sonar.sound_speed_m_per_s, 0.0);
    EXPECT_FALSE(info.water);
    for (const char* what : {"Frequency", "Temperature", "Pressure", "Sound speed"}) {
      EXPECT_THAT(info.notes, Contains(AllOf(HasSubstr(what), HasSubstr("is invalid"))));
    }
  }
}

TEST_F(OculusTest, GammaByteZeroMeansNoGamma) {
  EXPECT_EQ(Open(testing::MadeUpPing{.gamma = 0}.Write().bytes())->info().display_gamma, 1.0);
  EXPECT_EQ(Open(testing::MadeUpPing{.gamma = 255}.Write().bytes())->info().display_gamma, 1.0);
}

TEST_F(OculusTest, RefusesFieldsThatContradictEachOther) {
  for (const double resolution_m : {0.0, -1.0, kNaN, 1e300}) {
    EXPECT_THAT(Refusal(testing::MadeUpPing{.range_resolution_m = resolution_m}.Write().bytes()),
                HasSubstr("range resolution"));
  }
  EXPECT_THAT(Refusal(testing::MadeUpPing{.ranges = 0}.Write().bytes()), HasSubstr("ranges: 0"));
  EXPECT_THAT(Refusal(testing::MadeUpPing{.beams = 1}.Write().bytes()), HasSubstr("beams: 1"));
  EXPECT_THAT(Refusal(testing::MadeUpPing{.bearing_centideg = {-300, 90, 90, 300}}.Write().bytes()),
              HasSubstr("azimuth of beam 2"));

  for (const int version : {1, 2}) {
    const testing::MadeUpPing ping{.version = version};
    ByteWriter file = ping.Write();
    file.U16(ping.DataSizeOffset() + 9, 0xffff);
    EXPECT_THAT(Refusal(file.bytes()), HasSubstr("image size: 20, expected 262140 for 65535 ranges"));
    file = ping.Write();
    file.U8(ping.DataSizeOffset(), 4);
    EXPECT_THAT(Refusal(file.bytes()), HasSubstr("data size: 4"));
    file = ping.Write();
    file.U32(ping.ImageOffsetOffset(), 0xffffffff);
    EXPECT_THAT(Refusal(file.bytes()), HasSubstr("image offset"));
    file = ping.Write();
    file.U16(8, 3);
    EXPECT_THAT(Refusal(file.bytes()), HasSubstr("byte 8: version: 3"));
  }
}

TEST_F(OculusTest, HostileFilesEndInDataError) {
  for (const int version : {1, 2}) {
    const std::string ping = testing::MadeUpPing{.version = version, .gain = 3}.Write().bytes();
    testing::ExpectOnlyDataErrors(path_, path_, ping + ping, ping.size() + 200);
  }
}

}  // namespace
}  // namespace sonarcal::data_io
