// Damaged and lying bags: they open, or DataError comes out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <random>

#include "data_io/bag_trajectory.h"
#include "data_io/ros/bag.h"
#include "tests/data_io/byte_writer.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_bag.h"
#include "tests/data_io/sonar_messages.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::kProjectedType;
using testing::MadeUpMessage;
using testing::MadeUpOculusPing;
using testing::MadeUpProjected;
using testing::Wire;

constexpr std::size_t kBagHeaderEnd = 13 + 4096;

std::vector<MadeUpMessage> Messages(Wire wire, int count) {
  std::vector<MadeUpMessage> messages;
  for (int i = 0; i < count; ++i)
    messages.push_back({"/sonar", kProjectedType, i, MadeUpProjected{}.Write(wire)});
  return messages;
}

class BagHostileTest : public ::testing::Test {
 protected:
  static std::string Ros1(const testing::MadeUpRos1Bag& how, int messages = 4) {
    return testing::Ros1BagBytes(Messages(Wire::kRos1, messages), how);
  }
  std::string Ros2(const std::string& more_sql = "") {
    testing::WriteRos2Bag(dir_ / "test.db3", Messages(Wire::kCdrLittle, 4), more_sql);
    return testing::ReadFile(dir_ / "test.db3");
  }
  // What a ROS 1 bag is refused with where the first record of its kind has other bytes: `from`, as long as
  // `to`, is searched behind the bag's header.
  std::string RefusalWith(std::string bytes, const std::string& from, const std::string& to) {
    const std::size_t at = bytes.find(from, kBagHeaderEnd);
    EXPECT_NE(at, std::string::npos);
    bytes.replace(at, to.size(), to);
    testing::WriteFile(dir_ / "lies.bag", bytes);
    return testing::RefusalOf(dir_ / "lies.bag");
  }

  testing::TempDir dir_;
};

// The bag's header is 4 KB of blanks: damage goes behind it, to where the chunks are.
void ExpectSurvivesDamageBehind(std::size_t begin, const std::filesystem::path& file,
                                const std::string& bytes, unsigned seeds) {
  for (std::size_t length = 0; length < bytes.size(); length += length < 13 || length > begin ? 7 : 409) {
    testing::WriteFile(file, bytes.substr(0, length));
    testing::OpensWholly(file);
  }
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = bytes;
    for (unsigned i = 0; i < 1 + seed % 6; ++i)
      damaged[begin + random() % (bytes.size() - begin)] = static_cast<char>(random());
    testing::WriteFile(file, damaged);
    testing::OpensWholly(file);
  }
}

TEST_F(BagHostileTest, DamagedRos1BagsEndInOneSentence) {
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    for (const bool with_end : {true, false}) {
      ExpectSurvivesDamageBehind(kBagHeaderEnd, dir_ / "test.bag",
                                 Ros1({.compression = compression, .with_end = with_end}), 100);
    }
  }
  testing::ExpectOnlyDataErrors(dir_ / "test.bag", dir_ / "test.bag", Ros1({}), 200);
}

TEST_F(BagHostileTest, DamagedRos2BagsEndInOneSentence) {
  const std::string bytes = Ros2();
  testing::ExpectOnlyDataErrors(dir_ / "test.db3", dir_ / "test.db3", bytes, 120);
  ExpectSurvivesDamageBehind(0, dir_ / "test.db3", bytes, 500);
}

// Every byte of every message in turn, so that each count and length lies once.
TEST_F(BagHostileTest, MessagesWithAnyByteDamagedEndInOneSentence) {
  for (const Wire wire : testing::kWires) {
    for (const auto& [type, whole] :
         {std::pair<std::string, std::string>{kProjectedType, MadeUpProjected{}.Write(wire)},
          {"sonar_oculus/OculusPing", MadeUpOculusPing{}.Write(wire)}}) {
      std::vector<MadeUpMessage> messages;
      for (std::size_t i = 0; i < whole.size(); ++i) {
        for (const char byte : {'\0', '\x7f', '\xff'}) {
          std::string damaged = whole;
          damaged[i] = byte;
          messages.push_back({"/sonar", type, static_cast<std::int64_t>(messages.size()) + 1, damaged});
        }
        messages.push_back(
            {"/sonar", type, static_cast<std::int64_t>(messages.size()) + 1, whole.substr(0, i)});
      }
      messages.push_back({"/sonar", type, 0, whole});  // the first, which describes the sonar
      const auto path = dir_ / "test.bag";
      if (wire == Wire::kRos1) {
        testing::WriteFile(path, testing::Ros1BagBytes(messages, {.messages_a_chunk = 100}));
      } else {
        testing::WriteRos2Bag(path, messages);
      }
      const auto recording = OpenRecording(path);
      ASSERT_EQ(recording->frame_count(), static_cast<int>(messages.size()));
      for (int i = 0; i < recording->frame_count(); ++i) {
        const bool is_cut_short = i > 0 && (i - 1) % 4 == 3;
        try {
          const Frame frame = recording->ReadFrame(i);
          frame.image.axes.Validate("frame");
          EXPECT_FALSE(is_cut_short) << i;
        } catch (const DataError& error) {
          EXPECT_THAT(error.what(), HasSubstr(": /sonar: message " + std::to_string(i)));
        }
      }
    }
  }
}

TEST_F(BagHostileTest, LengthsOfRos1RecordsAreComparedWithTheFile) {
  const std::string bytes = Ros1({});
  const auto u32 = [](std::uint32_t value) {
    testing::ByteWriter writer;
    writer.U32(0, value);
    return writer.bytes();
  };
  // The first chunk's header length stands right behind the bag's header.
  std::string lies = bytes;
  lies.replace(kBagHeaderEnd, 4, u32(0xfffffff0));
  testing::WriteFile(dir_ / "lies.bag", lies);
  EXPECT_THAT(testing::RefusalOf(dir_ / "lies.bag"), HasSubstr("no topic of a sonar"));
  const auto bag = Bag::Open(dir_ / "lies.bag");
  ASSERT_EQ(bag->notes().size(), 1U);
  EXPECT_THAT(bag->notes()[0], HasSubstr("length of a header: 4294967280, expected at most"));
  // A chunk that would inflate to 4 GB.
  const std::string lz4 = Ros1({.compression = "lz4"});
  const std::size_t size_at = lz4.find("size=", kBagHeaderEnd);
  lies = lz4;
  lies.replace(size_at + 5, 4, u32(0xffffffff));
  testing::WriteFile(dir_ / "lies.bag", lies);
  EXPECT_THAT(testing::RefusalOf(dir_ / "lies.bag"),
              HasSubstr("4294967295 bytes, expected at most 268435456"));
  // An index of more messages than it has bytes for.
  EXPECT_THAT(RefusalWith(bytes, "count=", "count=" + u32(1'000'000'000)), HasSubstr("no topic of a sonar"));
  // A message that begins where the chunk ends.
  EXPECT_THAT(RefusalWith(bytes, "compression=none", "compression=nome"), HasSubstr("no topic of a sonar"));
}

// A bag that was cut off has its connections only in the chunks.
TEST_F(BagHostileTest, ADamagedChunkOfAnotherTopicDoesNotHideTheSonar) {
  std::vector<MadeUpMessage> messages(2, {"/chatter", "std_msgs/String", 0, "of no matter"});
  for (const MadeUpMessage& message : Messages(Wire::kRos1, 2)) messages.push_back(message);
  std::string bytes = testing::Ros1BagBytes(messages, {.compression = "bz2", .with_end = false});
  const std::size_t packed = bytes.find("BZh", kBagHeaderEnd);
  ASSERT_NE(packed, std::string::npos);
  bytes[packed + 4] = '\0';
  testing::WriteFile(dir_ / "test.bag", bytes);
  EXPECT_TRUE(testing::OpensWholly(dir_ / "test.bag"));
  const auto recording = OpenRecording(dir_ / "test.bag");
  EXPECT_EQ(recording->frame_count(), 2);
  EXPECT_THAT(recording->info().notes, ::testing::Contains(HasSubstr("A chunk is damaged: ")));
}

TEST_F(BagHostileTest, AnIndexThatPointsIntoAMessageIsRefused) {
  std::string bytes = Ros1({}, 1);
  const std::size_t conn = bytes.find("ver=", kBagHeaderEnd);  // of the index behind the chunk
  const std::size_t count = bytes.find("count=", conn - 60);
  ASSERT_NE(count, std::string::npos);
  // Behind the three fields stand the data's length, then seconds, nanoseconds and offset.
  std::size_t data = std::max(count + 10, conn + 8);
  data = std::max(data, bytes.find("conn=", conn - 60) + 9);
  bytes[data + 4 + 8] = static_cast<char>(bytes[data + 4 + 8] + 5);
  testing::WriteFile(dir_ / "lies.bag", bytes);
  EXPECT_THAT(testing::RefusalOf(dir_ / "lies.bag"), HasSubstr("lies.bag: byte "));
}

TEST_F(BagHostileTest, ViewsVirtualTablesAndWrongTypesAreRefused) {
  Ros2(
      "DROP TABLE messages; CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id, 1 AS timestamp, x'00' AS "
      "data");
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.db3"), HasSubstr("no table 'messages'"));
  Ros2("DROP TABLE topics");
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.db3"), HasSubstr("no table 'topics'"));
  Ros2("DROP TABLE messages; CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data)");
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.db3"), HasSubstr("no table 'messages'"));
  Ros2("UPDATE messages SET data = 'text' WHERE id = 2; UPDATE messages SET data = 5 WHERE id = 3");
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.db3"), HasSubstr("message 1: byte 0: encapsulation"));
  Ros2("UPDATE messages SET data = 5 WHERE id = 3");
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.db3"), HasSubstr("message of row 3 cannot be read"));
  Ros2("UPDATE topics SET serialization_format = 'ros2msg'");
  EXPECT_THAT(testing::RefusalOf(dir_ / "test.db3"), HasSubstr("no topic of a sonar"));
}

TEST_F(BagHostileTest, TheBagIsNotWrittenTo) {
  const std::string bytes = Ros2();
  std::filesystem::permissions(dir_ / "test.db3", std::filesystem::perms::owner_read);
  EXPECT_TRUE(testing::OpensWholly(dir_ / "test.db3"));
  EXPECT_EQ(testing::ReadFile(dir_ / "test.db3"), bytes);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "test.db3-journal"));
}

TEST_F(BagHostileTest, ALogBesideTheBagIsNoted) {
  Ros2();
  testing::WriteFile(dir_ / "test.db3-wal", "messages that came last");
  const auto bag = Bag::Open(dir_ / "test.db3");
  ASSERT_EQ(bag->notes().size(), 1U);
  EXPECT_THAT(bag->notes()[0], HasSubstr("messages that are still in this log are not read"));
}

}  // namespace
}  // namespace sonarcal::data_io
