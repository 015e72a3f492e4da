#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/bag_trajectory.h"
#include "data_io/mcap/mcap_file.h"
#include "data_io/recordings/salvaged_recording.h"
#include "data_io/ros/bag.h"
#include "data_io/ros/bag_recording.h"
#include "tests/data_io/byte_writer.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_mcap.h"
#include "tests/data_io/refusal.h"
#include "tests/data_io/sonar_messages.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::kProjectedType;
using testing::MadeUpMcap;
using testing::MadeUpMcapPlaces;
using testing::MadeUpMessage;
using testing::MadeUpProjected;
using testing::MessageWriter;
using ::testing::Not;
using testing::Wire;

constexpr std::size_t kMessageHeadBytes = 9 + 22;

std::string U32(std::uint32_t value) {
  testing::ByteWriter writer;
  writer.U32(0, value);
  return writer.bytes();
}
std::string U64(std::uint64_t value) {
  testing::ByteWriter writer;
  writer.U64(0, value);
  return writer.bytes();
}

std::string PoseStamped(Wire wire, std::uint32_t seconds) {
  MessageWriter message(wire);
  message.Header(seconds, 0, "map");
  for (const double value : {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}) message.F64(value);
  return message.bytes();
}

// `frames` sonar images, of which frame i begins with the grey value i, and a pose after each.
std::vector<MadeUpMessage> Messages(int frames, Wire wire = Wire::kCdrLittle) {
  std::vector<MadeUpMessage> messages;
  for (int i = 0; i < frames; ++i) {
    const auto seconds = static_cast<std::uint32_t>(100 + i);
    messages.push_back({"/sonar", kProjectedType, std::int64_t{seconds} * 1'000'000'000,
                        MadeUpProjected{.seconds = seconds, .nanoseconds = 0, .add = i}.Write(wire)});
    messages.push_back({"/pose", "geometry_msgs/PoseStamped", std::int64_t{seconds} * 1'000'000'000 + 1,
                        PoseStamped(wire, seconds)});
  }
  return messages;
}

class McapBagTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& bytes, const std::string& name = "test.mcap") {
    testing::WriteFile(dir_ / name, bytes);
    return dir_ / name;
  }
  static std::string Bytes(const MadeUpMcap& how, int frames = 4, MadeUpMcapPlaces* places = nullptr) {
    return testing::McapBytes(Messages(frames), how, places);
  }
  // The notes of the bag made of these bytes.
  std::vector<std::string> Notes(const std::string& bytes) { return Bag::Open(Write(bytes))->notes(); }
  // First grey values of the frames that remain when unreadable ones are left out.
  std::vector<float> Salvaged(const std::string& bytes) {
    const SalvagedRecording recording(OpenRecording(Write(bytes)));
    std::vector<float> values;
    for (int i = 0; i < recording.frame_count(); ++i)
      values.push_back(recording.ReadFrame(i).image.value(0, 0));
    return values;
  }

  testing::TempDir dir_;
};

constexpr const char* kCompressions[] = {"", "lz4", "zstd"};

TEST_F(McapBagTest, EveryCompressionIsReadWithAndWithoutAnIndex) {
  for (const std::string compression : kCompressions) {
    for (const std::size_t messages_a_chunk : {0, 1, 3, 100}) {
      for (const bool with_index : {true, false}) {
        const auto path = Write(Bytes(
            {.compression = compression, .messages_a_chunk = messages_a_chunk, .with_index = with_index}));
        const auto recording = OpenRecording(path);
        EXPECT_EQ(recording->info().format, std::string("MCAP, ") + kProjectedType);
        EXPECT_THAT(Bag::Open(path)->notes(), ::testing::IsEmpty());
        ASSERT_EQ(recording->frame_count(), 4) << compression << messages_a_chunk << with_index;
        for (int i = 0; i < 4; ++i) {
          EXPECT_EQ(*recording->frame_info(i).time_s, 100.0 + i);
          EXPECT_EQ(recording->ReadFrame(i).image.value(0, 0), static_cast<float>(i));
        }
        const auto poses = ReadBagTrajectory(path, {.topic = "/pose"});
        ASSERT_EQ(poses.size(), 4U);
        EXPECT_EQ(poses[2].time_s, 102.0);
        EXPECT_EQ(poses[2].world_from_body.position_m, Eigen::Vector3d(1.0, 2.0, 3.0));
      }
    }
  }
}

TEST_F(McapBagTest, MessagesOfRos1AreReadToo) {
  const auto path = Write(testing::McapBytes(Messages(2, Wire::kRos1), {.message_encoding = "ros1"}));
  EXPECT_EQ(OpenRecording(path)->ReadFrame(1).image.value(0, 0), 1.0F);
  EXPECT_THAT(testing::RefusalOf(Write(Bytes({.message_encoding = "json"}))),
              HasSubstr("Topic /sonar is serialised as 'json', not as cdr or ros1, and was left out."));
}

TEST_F(McapBagTest, MessagesAreInOrderOfTheirLogTime) {
  std::vector<MadeUpMessage> messages = Messages(4);
  std::swap(messages[0], messages[6]);
  const auto recording = OpenRecording(Write(testing::McapBytes(messages, {})));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(recording->ReadFrame(i).image.value(0, 0), static_cast<float>(i));
}

TEST_F(McapBagTest, FilesOfAFolderAreOneBag) {
  std::filesystem::create_directory(dir_ / "dive");
  Write(testing::McapBytes({Messages(2)[2]}, {.compression = "zstd"}), "dive/dive_10.mcap");
  Write(testing::McapBytes({Messages(1)[0]}, {.compression = "lz4"}), "dive/dive_9.mcap");
  const auto recording = OpenRecording(dir_ / "dive");
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->ReadFrame(0).image.value(0, 0), 0.0F);
  EXPECT_EQ(recording->ReadFrame(1).image.value(0, 0), 1.0F);
}

// Kinds that the specification reserves, and fields that it may add, are skipped.
TEST_F(McapBagTest, UnknownRecordsAndFieldsAreSkipped) {
  MadeUpMcapPlaces places;
  std::string bytes = Bytes({.messages_a_chunk = 3, .with_crc = false}, 4, &places);
  bytes.insert(places.chunk[1], testing::McapRecord(0x42, "of the future") +
                                    testing::McapRecord('\x90', "of an application") +
                                    testing::McapRecord(9, "no attachment that anyone can read"));
  EXPECT_THAT(Notes(bytes), ::testing::IsEmpty());
  EXPECT_EQ(OpenRecording(dir_ / "test.mcap")->frame_count(), 4);
}

// A file that was cut off is read as far as it goes. The incomplete message ends a run, and is
// left out when the file is salvaged.
TEST_F(McapBagTest, ATruncatedFileIsReadAsFarAsItGoes) {
  for (const std::string compression : kCompressions) {
    for (const bool with_index : {true, false}) {
      MadeUpMcapPlaces places;
      const std::string bytes =
          Bytes({.compression = compression, .messages_a_chunk = 2, .with_index = with_index}, 4, &places);
      // Behind the second chunk's records: its message indices are missing.
      const std::string without_end = bytes.substr(0, places.chunk[2]);
      EXPECT_THAT(Notes(without_end), Contains(HasSubstr("without a footer: it was cut off")));
      EXPECT_EQ(testing::RefusalOf(Write(without_end)), "");
      EXPECT_THAT(Salvaged(without_end), ::testing::ElementsAre(0, 1));
      EXPECT_THAT(OpenRecording(dir_ / "test.mcap")->info().notes, Contains(HasSubstr("it was cut off")));
    }
  }
}

TEST_F(McapBagTest, AMessageThatIsThereInPartEndsARunAndIsSalvaged) {
  MadeUpMcapPlaces places;
  const std::string chunked = Bytes({.messages_a_chunk = 2}, 4, &places);
  const std::size_t in_chunk = places.chunk_records[2] + kMessageHeadBytes + 40;
  const std::string bare = Bytes({.messages_a_chunk = 0}, 4, &places);
  const std::size_t in_file = places.bare_message[4] + kMessageHeadBytes + 40;
  for (const std::string& cut : {chunked.substr(0, in_chunk), bare.substr(0, in_file)}) {
    EXPECT_EQ(OpenRecording(Write(cut))->frame_count(), 3);
    EXPECT_THAT(testing::RefusalOf(dir_ / "test.mcap"),
                HasSubstr("of which 62 are there: the file was cut off"));
    EXPECT_THAT(Salvaged(cut), ::testing::ElementsAre(0, 1));
    const SalvagedRecording salvaged(OpenRecording(dir_ / "test.mcap"));
    EXPECT_THAT(salvaged.info().notes, AllOf(Contains(HasSubstr("Frame 2 was omitted")),
                                             Contains(HasSubstr("1 of 3 frames could not be read"))));
  }
}

// Reads all that can be inflated of a compressed chunk at the end of a truncated file.
TEST_F(McapBagTest, TheStartOfACutCompressedChunkIsRead) {
  std::vector<MadeUpMessage> messages = Messages(60);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    // Bytes that do not compress, so that the frame has many blocks.
    if (messages[i].topic != "/pose") continue;
    for (int k = 0; k < 20'000; ++k) messages[i].bytes += static_cast<char>((k * k + 31 * k * i) >> 3);
  }
  for (const std::string compression : {"lz4", "zstd"}) {
    MadeUpMcapPlaces places;
    const std::string bytes =
        testing::McapBytes(messages, {.compression = compression, .messages_a_chunk = 1000}, &places);
    const std::size_t packed = places.message_index[0] - places.chunk_records[0];
    const auto path = Write(bytes.substr(0, places.chunk_records[0] + packed / 2));
    const std::vector<float> values = Salvaged(testing::ReadFile(path));
    EXPECT_GT(values.size(), 5U) << compression;
    EXPECT_LT(values.size(), 60U);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], static_cast<float>(i));
  }
}

TEST_F(McapBagTest, ADamagedChunkEndsARunAndIsSalvaged) {
  for (const std::string compression : kCompressions) {
    for (const bool with_index : {true, false}) {
      MadeUpMcapPlaces places;
      std::string bytes =
          Bytes({.compression = compression, .messages_a_chunk = 2, .with_index = with_index}, 4, &places);
      // The last byte of the second chunk: of the sonar's or the pose's data, or of the compressed frame.
      const std::size_t last = (with_index ? places.message_index[2] : places.chunk[2]) - 1;
      bytes[last] = static_cast<char>(bytes[last] ^ 0x55);
      const std::string refusal = testing::RefusalOf(Write(bytes));
      if (with_index || compression.empty()) {
        EXPECT_THAT(refusal, HasSubstr("test.mcap: inside the chunk at byte " +
                                       std::to_string(places.chunk_records[1])))
            << compression;
        if (compression.empty()) {
          EXPECT_THAT(refusal, HasSubstr("the CRC is"));
        }
      }
      EXPECT_THAT(Salvaged(bytes), ::testing::ElementsAre(0, 2, 3)) << compression << with_index;
    }
  }
}

TEST_F(McapBagTest, ADamagedFirstChunkDoesNotHideTheOthers) {
  MadeUpMcapPlaces places;
  std::string bytes = Bytes({.messages_a_chunk = 2}, 4, &places);
  const std::size_t last = places.message_index[0] - 1;
  bytes[last] = static_cast<char>(bytes[last] ^ 1);
  EXPECT_THAT(OpenRecording(Write(bytes))->info().notes,
              Contains(AllOf(HasSubstr("described from message 1, the first that can be read"),
                             HasSubstr("the CRC is"))));
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.mcap"), HasSubstr("the CRC is"));
  EXPECT_THAT(Salvaged(bytes), ::testing::ElementsAre(1, 2, 3));
}

// The messages of a chunk with a damaged index are listed from the chunk, each once.
TEST_F(McapBagTest, ADamagedMessageIndexNeitherRepeatsNorHidesFrames) {
  MadeUpMcapPlaces places;
  const std::string bytes = Bytes({.messages_a_chunk = 100}, 4, &places);
  ASSERT_EQ(places.message_index.size(), 2U);  // of the sonar and of the poses
  constexpr std::size_t kThirdPosition = 9 + 6 + 2 * 16 + 8;
  for (const std::vector<std::size_t>& damaged_indices : {std::vector<std::size_t>{0}, {1}, {0, 1}}) {
    std::string damaged = bytes;
    for (const std::size_t index : damaged_indices)
      damaged[places.message_index[index] + kThirdPosition + 5] = '\1';  // 2^40 bytes too far
    EXPECT_THAT(Notes(damaged), Contains(HasSubstr("position of a message: 1099511")));
    EXPECT_THAT(Salvaged(damaged), ::testing::ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(testing::RefusalOf(dir_ / "test.mcap"), "");
    EXPECT_EQ(ReadBagTrajectory(dir_ / "test.mcap", {.topic = "/pose"}).size(), 4U);
  }
}

TEST_F(McapBagTest, ChecksumsOfDataAndSummaryAreCompared) {
  MadeUpMcapPlaces places;
  std::string bytes = Bytes({.messages_a_chunk = 0}, 2, &places);
  char& byte = bytes[places.bare_message[0] + kMessageHeadBytes + 60];
  byte = static_cast<char>(byte ^ 1);
  EXPECT_THAT(Notes(bytes), ::testing::ElementsAre(HasSubstr("The CRC of the data is")));
  bytes = Bytes({}, 2, &places);
  bytes[places.footer - 1] = '\7';
  EXPECT_THAT(Notes(bytes), ::testing::ElementsAre(HasSubstr("The CRC of the summary is")));
  bytes = Bytes({.with_crc = false}, 2, &places);
  bytes[places.footer - 1] = '\7';
  EXPECT_THAT(Notes(bytes), ::testing::IsEmpty());
}

TEST_F(McapBagTest, StatisticsThatDisagreeAreNoted) {
  MadeUpMcapPlaces places;
  std::string bytes = Bytes({.with_crc = false}, 4, &places);
  const std::size_t statistics = bytes.find(std::string(1, '\x0b') + U64(46), places.summary);
  ASSERT_NE(statistics, std::string::npos);
  bytes.replace(statistics + 9, 8, U64(11));
  EXPECT_THAT(Notes(bytes),
              ::testing::ElementsAre("The file's statistics count 11 messages, but 8 were found."));
}

// False sizes: none is allocated, and each gives one sentence.
TEST_F(McapBagTest, SizesAreComparedWithWhatIsThere) {
  MadeUpMcapPlaces places;
  const std::string zstd = Bytes({.compression = "zstd", .messages_a_chunk = 100}, 4, &places);
  const std::size_t inflated_at = places.chunk[0] + 9 + 16;
  const auto with = [](std::string bytes, std::size_t at, const std::string& lie) {
    return bytes.replace(at, lie.size(), lie);
  };
  EXPECT_THAT(testing::RefusalOf(Write(with(zstd, inflated_at, U64(0xffff'ffff'ffff'0000)))),
              HasSubstr("18446744073709486080 bytes, expected at most 268435456"));
  EXPECT_THAT(testing::RefusalOf(Write(with(zstd, inflated_at, U64(200'000'000)))),
              HasSubstr("expected the 200000000 that the chunk announces"));
  EXPECT_THAT(testing::RefusalOf(Write(with(zstd, inflated_at, U64(1000)))),
              AnyOf(HasSubstr("more bytes come out than the 1000"), HasSubstr("position of a message: ")));
  // A chunk's record that reaches behind the end of the file.
  EXPECT_THAT(Notes(with(zstd, places.chunk[0] + 1, U64(~std::uint64_t{0}))),
              Contains(HasSubstr("it was cut off")));
  // Packed bytes that reach behind the record.
  EXPECT_THAT(testing::RefusalOf(Write(with(zstd, places.chunk_records[0] - 8, U64(1'000'000'000'000)))),
              HasSubstr("length of a chunk: 1000000000000, of which the record holds"));
  // A message that is longer than its chunk.
  const std::string plain = Bytes({.messages_a_chunk = 2, .with_crc = false}, 2, &places);
  const std::size_t second = plain.find(std::string(1, '\5'), places.chunk_records[1]);
  EXPECT_THAT(testing::RefusalOf(Write(with(plain, second + 1, U64(1'000'000)))),
              HasSubstr("length of a message: 1000000, of which"));
  // A message index of more entries than its record has.
  EXPECT_THAT(Notes(with(plain, places.message_index[0] + 11, U32(0x7fff'fff0))),
              Contains(HasSubstr("length of a message index: 2147483632, expected a multiple of 16")));
  // An index that points behind the chunk, and one that points into a message.
  EXPECT_THAT(Notes(with(plain, places.message_index[0] + 15 + 8, U64(1'000'000'000))),
              Contains(HasSubstr("position of a message: 1000000000, expected less than")));
  EXPECT_THAT(testing::RefusalOf(Write(with(plain, places.message_index[0] + 15 + 8, U64(5)))),
              AnyOf(HasSubstr("expected a message of time"), HasSubstr("byte")));
  // A topic of 4 GB.
  const std::size_t topic = plain.find("/sonar", places.summary) - 4;
  EXPECT_THAT(Notes(with(plain, topic, U32(0xffff'fff0))), Contains(HasSubstr("topic of a channel")));
}

// A small file that inflates to a thousand times its size, again and again.
TEST_F(McapBagTest, ABombIsLeftOut) {
  const std::string message = testing::McapRecord(5, std::string(22, '\0'));
  std::string records;
  while (records.size() < 20'000'000) records += message;
  const std::string packed = testing::PackedBytes(records, "zstd");
  std::string bytes("\x89MCAP0\r\n", 8);
  for (int i = 0; i < 5; ++i) {
    bytes += testing::McapRecord(
        6, U64(0) + U64(0) + U64(records.size()) + U32(0) + U32(4) + "zstd" + U64(packed.size()) + packed);
  }
  ASSERT_LT(bytes.size(), 20'000U);
  EXPECT_THAT(Notes(bytes), Contains(HasSubstr("in as many bytes, expected fewer: the file is damaged")));
}

// Chunks that inflate enormously, and messages of a channel that none of them defines.
TEST_F(McapBagTest, AMissingChannelIsNotSearchedInBombs) {
  constexpr std::size_t kInflated = 200 << 20;
  const std::string packed = testing::PackedBytes(std::string(kInflated, '\0'), "zstd");
  std::string bytes("\x89MCAP0\r\n", 8);
  for (int i = 0; i < 20; ++i) {
    bytes += testing::McapRecord(
        6, U64(0) + U64(0) + U64(kInflated) + U32(0) + U32(4) + "zstd" + U64(packed.size()) + packed);
    bytes += testing::McapRecord(7, std::string("\1\0", 2) + U32(16) + U64(0) + U64(0));
  }
  EXPECT_THAT(Notes(bytes),
              AllOf(Contains(HasSubstr("1000 times the size of the file: this chunk was left out")),
                    Contains(HasSubstr("20 messages are of no known channel"))));
}

TEST_F(McapBagTest, UnknownCompressionIsNamed) {
  EXPECT_THAT(testing::RefusalOf(Write(Bytes({.compression = "brotli"}))),
              HasSubstr("compression 'brotli', expected '', lz4 or zstd"));
  std::string bytes = Bytes({});
  bytes[5] = '1';
  EXPECT_THAT(testing::RefusalOf(Write(bytes)), HasSubstr("expected the magic number of MCAP, version 0"));
}

TEST_F(McapBagTest, DamagedFilesEndInOneSentence) {
  for (const std::string compression : kCompressions) {
    for (const std::size_t messages_a_chunk : {0, 3}) {
      for (const bool with_index : {true, false}) {
        const std::string bytes = Bytes({.compression = compression,
                                         .messages_a_chunk = messages_a_chunk,
                                         .with_index = with_index,
                                         .with_crc = messages_a_chunk == 0});
        testing::ExpectSurvivesDamage(
            bytes, 200, 300, [&](const std::string& damaged) { testing::OpensWholly(Write(damaged)); });
      }
    }
  }
}

}  // namespace
}  // namespace sonarcal::data_io
