#include "data_io/sonars/oculus_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

#include "core/types/error.h"
#include "data_io/recordings/recording_summary.h"
#include "data_io/recordings/salvaged_recording.h"
#include "tests/data_io/made_up_ping.h"
#include "tests/data_io/recording_file_test.h"

namespace sonarcal::data_io {
namespace {

using testing::ByteWriter;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::MadeUpPing;

std::string Text(const ByteWriter& writer) {
  return writer.bytes();
}

std::string Head(std::uint16_t encryption = 0) {
  ByteWriter head;
  head.U32(0, 0x11223344);
  head.U32(4, 48);
  head.U16(26, encryption);
  head.Grow(48);
  return Text(head);
}

std::string Packed(const std::string& message) {
  auto length = compressBound(static_cast<uLong>(message.size()));
  std::string packed(length, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(message.data()),
           static_cast<uLong>(message.size()));
  packed.resize(length);
  std::string whole;
  for (const int shift : {24, 16, 8, 0}) whole += static_cast<char>(message.size() >> shift);
  return whole + packed;
}

struct MadeUpItem {
  std::uint16_t type = 10;
  std::uint16_t compression = 0;
  double time_s = 1.5e9;
  std::uint32_t head_bytes = 40;

  std::string Write(const std::string& message) const {
    const std::string payload = compression == 1 ? Packed(message) : message;
    ByteWriter head;
    head.U32(0, 0xaabbccdd);
    head.U32(4, head_bytes);
    head.U16(8, type);
    head.F64(16, time_s);
    head.U16(24, compression);
    head.U32(28, static_cast<std::uint32_t>(message.size()));
    head.U32(32, static_cast<std::uint32_t>(payload.size()));
    head.Grow(head_bytes);
    return Text(head) + payload;
  }
};

class OculusLogTest : public testing::RecordingFileTest {
 protected:
  OculusLogTest() : RecordingFileTest("test.oculus") {}

  const std::string ping_ = Text(MadeUpPing{.version = 2, .ranges = 9}.Write());
};

// The same pixels as from the message alone, however it is stored.
TEST_F(OculusLogTest, GivesThePingsOfItsItems) {
  const auto plain = Open(ping_);
  const Frame expected = plain->ReadFrame(0);
  const auto log =
      Open(Head() + MadeUpItem{.time_s = 100.0}.Write(ping_) + MadeUpItem{.type = 12}.Write("a position") +
           MadeUpItem{.compression = 1, .time_s = 100.25, .head_bytes = 56}.Write(ping_));
  EXPECT_EQ(log->info().format, "Oculus simple ping result, version 2, in a log");
  EXPECT_THAT(log->info().notes, Contains(HasSubstr("1 items that are not the sonar's")));
  ASSERT_EQ(log->frame_count(), 2);
  for (const int index : {0, 1}) {
    const Frame frame = log->ReadFrame(index);
    EXPECT_TRUE(std::ranges::equal(frame.image.value.values(), expected.image.value.values()));
    EXPECT_EQ(frame.info.time_s, index == 0 ? 100.0 : 100.25);
    EXPECT_EQ(log->frame_info(index).name, expected.info.name);
  }
}

TEST_F(OculusLogTest, ItemsAfterADamagedOneAreLeftOut) {
  const std::string whole = Head() + MadeUpItem{}.Write(ping_) + MadeUpItem{.compression = 1}.Write(ping_);
  const auto cut = Open(whole.substr(0, whole.size() - 3));
  EXPECT_EQ(cut->frame_count(), 1);
  EXPECT_THAT(cut->info().notes, Contains(HasSubstr("not a whole item")));
}

TEST_F(OculusLogTest, APayloadWithAWrongChecksumIsRefused) {
  std::string bytes = Head() + MadeUpItem{.compression = 1}.Write(ping_);
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  EXPECT_THAT(Refusal(bytes), HasSubstr("the compressed payload is damaged"));
}

TEST_F(OculusLogTest, ADamagedItemDoesNotHideTheOthers) {
  const std::string good = MadeUpItem{.compression = 1}.Write(ping_);
  std::string damaged = good;
  damaged[40 + 4] = '\xff';  // first byte of the compressed stream
  std::string oversized = good;
  for (const std::size_t place : {28, 40}) oversized.replace(place, 4, 4, '\x7f');
  for (const std::string& bad : {damaged, oversized}) {
    for (const int place : {0, 1, 2}) {
      std::string bytes = Head();
      for (const int i : {0, 1, 2}) bytes += i == place ? bad : good;
      const SalvagedRecording salvaged(Open(bytes));
      EXPECT_EQ(salvaged.frame_count(), 2);
      EXPECT_EQ(salvaged.lost_count(), 1);
      EXPECT_THAT(salvaged.info().notes, Contains(HasSubstr(fmt::format("Frame {} was omitted: ", place))));
      const RecordingSummary summary = Summarize(*Open(bytes));
      EXPECT_EQ(summary.frames_without_header, 1);
      EXPECT_NE(summary.header_failure, "");
      EXPECT_EQ(summary.frames_with_time, 2);
      EXPECT_EQ(summary.first_frame.has_value(), place != 0);
      const auto described = Contains(HasSubstr("described from ping 1, the first that can be read"));
      if (place == 0) {
        EXPECT_THAT(salvaged.info().notes, described);
      } else {
        EXPECT_THAT(salvaged.info().notes, ::testing::Not(described));
      }
    }
  }
}

TEST_F(OculusLogTest, EncryptedEmptyAndOversizedLogsAreRefusedByName) {
  EXPECT_THAT(Refusal(Head(1) + MadeUpItem{}.Write(ping_)), HasSubstr("encrypted logs cannot be read"));
  EXPECT_THAT(Refusal(Head()), HasSubstr("no whole simple ping result"));
  EXPECT_THAT(Refusal(Head() + MadeUpItem{}.Write("no message of an Oculus")),
              HasSubstr("no whole simple ping result"));

  // An item that claims more than a message can have, or than comes out of it.
  std::string huge = Head() + MadeUpItem{.compression = 1}.Write(ping_);
  for (int i = 0; i < 4; ++i) {
    huge[48 + 28 + i] = '\x7f';
    huge[48 + 40 + i] = '\x7f';
  }
  EXPECT_THAT(Refusal(huge), HasSubstr("expected at most 67108864"));
  std::string longer = Head() + MadeUpItem{.compression = 1}.Write(ping_);
  longer[48 + 28] = static_cast<char>(longer[48 + 28] + 1);
  EXPECT_THAT(Refusal(longer), HasSubstr("the compressed payload announces"));
}

TEST_F(OculusLogTest, DamagedFilesEndInOneSentence) {
  const std::string bytes = Head() + MadeUpItem{}.Write(ping_) + MadeUpItem{.compression = 1}.Write(ping_);
  testing::ExpectOnlyDataErrors(path_, path_, bytes, bytes.size());
}

}  // namespace
}  // namespace sonarcal::data_io
