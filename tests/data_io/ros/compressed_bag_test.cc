// Bags of ROS 2 that rosbag2 has compressed, by file or by message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <iterator>

#include "data_io/bag_trajectory.h"
#include "data_io/recordings/salvaged_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_mcap.h"
#include "tests/data_io/refusal.h"
#include "tests/data_io/sonar_messages.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kProjectedType;
using testing::MadeUpMessage;
using testing::MadeUpProjected;
using testing::Wire;

std::vector<MadeUpMessage> Messages(int first, int count, bool compressed) {
  std::vector<MadeUpMessage> messages;
  for (int i = first; i < first + count; ++i) {
    const std::string bytes = MadeUpProjected{.seconds = 100, .add = i}.Write(Wire::kCdrLittle);
    messages.push_back(
        {"/sonar", kProjectedType, i, compressed ? testing::PackedBytes(bytes, "zstd") : bytes});
  }
  return messages;
}

class CompressedBagTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(dir_ / "scratch");
    setenv("TMPDIR", (dir_ / "scratch").c_str(), 1);
  }
  void TearDown() override {
    // No copy is left behind, whatever happened.
    EXPECT_TRUE(std::filesystem::is_empty(dir_ / "scratch"));
    unsetenv("TMPDIR");
  }

  std::string BagBytes(const std::string& kind, const std::vector<MadeUpMessage>& messages) {
    if (kind == "mcap") return testing::McapBytes(messages, {});
    testing::WriteRos2Bag(dir_ / "plain", messages);
    std::string bytes = testing::ReadFile(dir_ / "plain");
    std::filesystem::remove(dir_ / "plain");
    return bytes;
  }
  std::filesystem::path Write(const std::string& name, const std::string& bytes) {
    testing::WriteFile(dir_ / name, bytes);
    return dir_ / name;
  }
  static std::vector<float> FirstValues(const RecordingSource& recording) {
    std::vector<float> values;
    for (int i = 0; i < recording.frame_count(); ++i) {
      EXPECT_EQ(*recording.frame_info(i).time_s, 100.25);
      values.push_back(recording.ReadFrame(i).image.value(0, 0));
    }
    return values;
  }

  testing::TempDir dir_;
};

TEST_F(CompressedBagTest, EitherStorageIsReadInEitherMode) {
  for (const std::string kind : {"db3", "mcap"}) {
    const std::string by_message = BagBytes(kind, Messages(5, 3, true));
    EXPECT_THAT(FirstValues(*OpenRecording(Write("message." + kind, by_message))), ElementsAre(5, 6, 7));
    const std::string plain = BagBytes(kind, Messages(5, 3, false));
    const auto path = Write("file." + kind + ".zstd", testing::PackedBytes(plain, "zstd"));
    EXPECT_THAT(FirstValues(*OpenRecording(path)), ElementsAre(5, 6, 7));
    EXPECT_EQ(OpenRecording(path)->info().source, path.string());
    // Frames may follow each other in one file.
    const std::string half = testing::PackedBytes(plain.substr(0, plain.size() / 2), "zstd") +
                             testing::PackedBytes(plain.substr(plain.size() / 2), "zstd");
    EXPECT_THAT(FirstValues(*OpenRecording(Write("halves." + kind + ".zstd", half))), ElementsAre(5, 6, 7));
  }
}

TEST_F(CompressedBagTest, FilesOfAFolderAreInOrderAndNoneIsReadTwice) {
  std::filesystem::create_directory(dir_ / "dive");
  for (const int i : {2, 10}) {
    const std::string bytes = BagBytes("db3", Messages(i, 1, false));
    const std::string name = "dive/dive_" + std::to_string(i) + ".db3";
    Write(name + ".zstd", testing::PackedBytes(bytes, "zstd"));
    if (i == 2) Write(name, bytes);  // as the tools of ROS 2 leave it
  }
  EXPECT_THAT(FirstValues(*OpenRecording(dir_ / "dive")), ElementsAre(2, 10));
}

TEST_F(CompressedBagTest, ADamagedMessageEndsARunAndIsSalvaged) {
  for (const std::string kind : {"db3", "mcap"}) {
    std::vector<MadeUpMessage> messages = Messages(0, 4, true);
    messages[1].bytes.resize(messages[1].bytes.size() - 20);
    messages[2].bytes[12] = static_cast<char>(~messages[2].bytes[12]);
    messages[2].bytes[13] = static_cast<char>(~messages[2].bytes[13]);
    const auto path = Write("test." + kind, BagBytes(kind, messages));
    EXPECT_THAT(testing::RefusalOf(path), HasSubstr("the compressed message is not whole"));
    const SalvagedRecording salvaged(OpenRecording(path));
    EXPECT_GE(salvaged.lost_count(), 1);
    EXPECT_EQ(salvaged.ReadFrame(0).image.value(0, 0), 0.0F);
  }
}

TEST_F(CompressedBagTest, DamagedFilesAreRefused) {
  const std::string plain = BagBytes("db3", Messages(0, 30, false));
  const std::string packed = testing::PackedBytes(plain, "zstd");
  EXPECT_THAT(testing::RefusalOf(Write("cut.db3.zstd", packed.substr(0, packed.size() - 5))),
              HasSubstr("within a frame: the file was cut off"));
  std::string damaged = packed;
  for (std::size_t i = 60; i < 90; ++i) damaged[i] = '\xff';
  EXPECT_THAT(testing::RefusalOf(Write("damaged.db3.zstd", damaged)),
              AnyOf(HasSubstr("the compressed content is damaged"), HasSubstr("not a recording")));
  EXPECT_THAT(testing::RefusalOf(Write("text.db3.zstd", testing::PackedBytes("no bag", "zstd"))),
              HasSubstr("is no bag of ROS 2"));
  testing::ExpectSurvivesDamage(packed, 100, 200, [&](const std::string& bytes) {
    testing::OpensWholly(Write("test.db3.zstd", bytes));
  });
}

// A bag and then zeros, which compress more than any recording does.
TEST_F(CompressedBagTest, ABombIsRefused) {
  std::string bytes = BagBytes("mcap", Messages(0, 1, false));
  bytes.resize(100 << 20, '\0');
  EXPECT_THAT(testing::RefusalOf(Write("bomb.mcap.zstd", testing::PackedBytes(bytes, "zstd"))),
              HasSubstr("inflate to more than 67108864, expected at most 1000 times as many"));
  std::vector<MadeUpMessage> messages = Messages(0, 1, false);
  messages.push_back(messages[0]);
  messages[1].bytes = testing::PackedBytes(std::string(300 << 20, '\0'), "zstd");
  messages[1].log_time_ns = 5;
  EXPECT_THAT(testing::RefusalOf(Write("bomb.db3", BagBytes("db3", messages))),
              HasSubstr("the message inflates to more than the max of 268435456 bytes"));
}

}  // namespace
}  // namespace sonarcal::data_io
