#include "data_io/ros/oculus_interfaces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/ros/bag_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_mcap.h"
#include "tests/data_io/made_up_ping.h"
#include "tests/data_io/message_writer.h"
#include "tests/data_io/refusal.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::MadeUpPing;
using testing::MessageWriter;
using ::testing::Not;
using ::testing::Pair;
using testing::Wire;

// oculus_interfaces/Ping. `data` is the image, or the sonar's own message.
std::string Ping(Wire wire, const MadeUpPing& ping, const std::string& data, std::uint32_t more_step = 0) {
  MessageWriter message(wire);
  message.Header(100, 500'000'000, "sonar").U32(77).U32(123).F64(2.0).F64(50.0);
  message.F64(ping.frequency_hz).F64(ping.sound_speed_m_per_s).F64(ping.range_resolution_m);
  message.F64(ping.temperature_c).F64(ping.pressure_bar).U8(2).U8(ping.gain > 0 ? 1 : 0);
  message.U16(static_cast<std::uint16_t>(ping.ranges)).U16(static_cast<std::uint16_t>(ping.beams));
  message.U32(static_cast<std::uint32_t>(ping.RowBytes()) + more_step);
  message.U8(static_cast<std::uint8_t>(ping.bytes_per_sample));
  message.U32(static_cast<std::uint32_t>(ping.bearing_centideg.size()));
  for (const std::int16_t bearing : ping.bearing_centideg) message.U16(static_cast<std::uint16_t>(bearing));
  message.Blob(data);
  return message.bytes();
}

// The image at the end of the sonar's own message.
std::string ImageOf(const MadeUpPing& ping) {
  return ping.Write().bytes().substr(ping.ImageOffset());
}

enum class Kind { kOculusPing, kStamped, kStampedWithoutInnerHeader };

std::string OculusPingMessage(Wire wire, Kind kind, const std::string& data) {
  MessageWriter message(wire);
  message.Header(100, 500'000'000, "sonar");
  if (kind == Kind::kStamped) message.Header(3, 0, "inner");
  for (int i = 0; i < 5; ++i) message.U16(0x4f53);
  message.U32(1).U16(0);
  for (std::uint8_t i = 0; i < 5; ++i) message.U8(i);
  for (int i = 0; i < 4; ++i) message.F64(i);
  message.U32(77).U32(0).F64(2.1e6).F64(11.5).F64(1.2).F64(1490.0).U32(5).U8(0).F64(0.01);
  message.U16(5).U16(4).U32(1).U32(2).U32(3).Blob(data);
  return message.bytes();
}

class OculusInterfacesTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& type, const std::string& bytes,
                              Wire wire = Wire::kCdrLittle) {
    testing::WriteFile(dir_ / "test.mcap",
                       testing::McapBytes({{"/oculus", type, 1, bytes}},
                                          {.message_encoding = wire == Wire::kRos1 ? "ros1" : "cdr"}));
    return dir_ / "test.mcap";
  }
  testing::TempDir dir_;
};

void ExpectFrame(const RecordingSource& recording, const MadeUpPing& ping) {
  ASSERT_EQ(recording.frame_count(), 1);
  EXPECT_EQ(*recording.frame_info(0).time_s, 100.5);
  const PolarImage image = recording.ReadFrame(0).image;
  EXPECT_EQ(image.axes.range_max_m, ping.ranges * ping.range_resolution_m);
  ASSERT_EQ(image.axes.beam_count(), ping.beams);
  EXPECT_NEAR(DegFromRad(image.axes.beam_azimuth_rad[1]), 0.01 * ping.bearing_centideg[1], 1e-9);
  for (int range = 0; range < ping.ranges; ++range) {
    for (int beam = 0; beam < ping.beams; ++beam) {
      const double gain = ping.gain > 0 ? ping.gain + range : 1.0;
      EXPECT_NEAR(image.value(range, beam),
                  MadeUpPing::Sample(range, beam, ping.bytes_per_sample) / std::sqrt(gain), 0.01);
    }
  }
}

TEST_F(OculusInterfacesTest, APingIsReadFromItsImageAndFromTheSonarsOwnMessage) {
  for (const Wire wire : {Wire::kCdrLittle, Wire::kCdrBig}) {
    for (const int bytes : {1, 2}) {
      for (const std::uint32_t gain : {0, 9}) {
        const MadeUpPing ping{.bytes_per_sample = bytes, .gain = gain};
        const auto by_image = OpenRecording(Write("oculus_interfaces/Ping", Ping(wire, ping, ImageOf(ping))));
        ExpectFrame(*by_image, ping);
        EXPECT_EQ(by_image->info().sonar.name, "Oculus M1200d");
        EXPECT_EQ(by_image->info().sonar.sound_speed_m_per_s, 1490.0);
        EXPECT_FALSE(by_image->info().display_gamma);
        EXPECT_FALSE(by_image->info().water);
        EXPECT_THAT(by_image->info().notes, Contains("Neither gamma nor salinity is recorded."));
        EXPECT_THAT(by_image->info().details, Contains(Pair("temperature", "11.50 C")));
        const auto by_message =
            OpenRecording(Write("oculus_interfaces/Ping", Ping(wire, ping, ping.Write().bytes())));
        ExpectFrame(*by_message, ping);
        EXPECT_NEAR(*by_message->info().display_gamma, 127.0 / 255.0, 1e-12);
        EXPECT_EQ(by_message->info().water->salinity_ppt, 0.5);
      }
    }
  }
}

TEST_F(OculusInterfacesTest, AStampedPingIsReadFromTheSonarsOwnMessage) {
  for (const int version : {1, 2}) {
    const MadeUpPing ping{.version = version, .gain = 4};
    const std::string own = ping.Write().bytes();
    ExpectFrame(*OpenRecording(Write("oculus_interfaces/OculusStampedPing",
                                     OculusPingMessage(Wire::kCdrLittle, Kind::kStamped, own))),
                ping);
    ExpectFrame(*OpenRecording(Write("oculus_interfaces/OculusPing",
                                     OculusPingMessage(Wire::kCdrBig, Kind::kOculusPing, own))),
                ping);
    ExpectFrame(*OpenRecording(Write("oculus_sonar/OculusStampedPing",
                                     OculusPingMessage(Wire::kRos1, Kind::kStampedWithoutInnerHeader, own),
                                     Wire::kRos1)),
                ping);
  }
}

// Real messages that a driver sent without a sonar: all fields are 0, and there is no data.
TEST(OculusInterfacesSample, RealStampedPingsWithoutDataAreRefused) {
  SONARCAL_NEEDS_RECORDING(path, "ros2_oculus_db3/rosbag2_2022_11_18-23_20_16_0.db3");
  EXPECT_EQ(Bag::Open(path)->topics().at(2).count, 17U);
  EXPECT_THAT(testing::RefusalOf(path),
              HasSubstr("/topic: message 0: data has 0 bytes, expected the sonar's own message"));
}

TEST_F(OculusInterfacesTest, LeftAndRightCanBeExchanged) {
  const MadeUpPing ping{.bearing_centideg = {-300, -90, 90, 400}};
  const auto recording =
      OpenBagRecording(Write("oculus_interfaces/Ping", Ping(Wire::kCdrLittle, ping, ImageOf(ping))),
                       {.message = {.mirrored = true}});
  EXPECT_NEAR(DegFromRad(recording->info().sonar.axes.beam_azimuth_rad[0]), -4.0, 1e-9);
  EXPECT_THAT(recording->ReadFrame(0).image.value.row(0), ::testing::ElementsAre(3, 2, 1, 0));
}

TEST_F(OculusInterfacesTest, SizesThatDisagreeAreRefused) {
  const MadeUpPing ping;
  const auto refusal = [&](const std::string& bytes, const std::string& type) {
    return testing::RefusalOf(Write(type, bytes));
  };
  EXPECT_THAT(refusal(Ping(Wire::kCdrLittle, ping, ImageOf(ping).substr(1)), "oculus_interfaces/Ping"),
              HasSubstr("message 0: ping_data has 19 bytes with 4 bytes per row, expected the sonar's own "
                        "message, or an image of 5 rows of 4 bytes"));
  EXPECT_THAT(refusal(Ping(Wire::kCdrLittle, ping, ImageOf(ping), 1), "oculus_interfaces/Ping"),
              HasSubstr("with 5 bytes per row"));
  EXPECT_THAT(
      refusal(Ping(Wire::kCdrLittle, ping, ping.Write().bytes().substr(0, 150)), "oculus_interfaces/Ping"),
      HasSubstr("ping_data: the sonar's own message has 156 bytes, of which 150 are there"));
  EXPECT_THAT(refusal(Ping(Wire::kCdrLittle, {.bytes_per_sample = 5}, ""), "oculus_interfaces/Ping"),
              HasSubstr("of 5 bytes, expected"));
  EXPECT_THAT(refusal(Ping(Wire::kCdrLittle, {.bearing_centideg = {1, 2}}, ""), "oculus_interfaces/Ping"),
              HasSubstr("4 beams and 2 bearings"));
  EXPECT_THAT(refusal(OculusPingMessage(Wire::kCdrLittle, Kind::kStamped, "an image alone"),
                      "oculus_interfaces/OculusStampedPing"),
              HasSubstr("data has 14 bytes, expected the sonar's own message"));
}

// Every byte of every message in turn.
TEST_F(OculusInterfacesTest, MessagesWithAnyByteDamagedEndInOneSentence) {
  const MadeUpPing ping{.gain = 3};
  const std::pair<std::string, std::string> messages[] = {
      {"oculus_interfaces/Ping", Ping(Wire::kCdrLittle, ping, ImageOf(ping))},
      {"oculus_interfaces/Ping", Ping(Wire::kCdrLittle, ping, ping.Write().bytes())},
      {"oculus_interfaces/OculusStampedPing",
       OculusPingMessage(Wire::kCdrLittle, Kind::kStamped, ping.Write().bytes())}};
  for (const auto& [type, whole] : messages) {
    const auto read = [&type = type](const std::string& bytes) {
      ReadOculusInterfaces(type, std::as_bytes(std::span(bytes)), MessageEncoding::kCdr, "m");
    };
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const char byte : {'\0', '\x7f', '\xff'}) {
        std::string damaged = whole;
        damaged[i] = byte;
        try {
          read(damaged);
        } catch (const DataError& error) {
          EXPECT_THAT(error.what(), ::testing::StartsWith("m: "));
        }
      }
      EXPECT_THROW(read(whole.substr(0, i)), DataError);
    }
  }
}

}  // namespace
}  // namespace sonarcal::data_io
