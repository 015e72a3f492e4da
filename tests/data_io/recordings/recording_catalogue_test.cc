#include "data_io/recordings/recording_catalogue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "data_io/files/hash.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

TEST(RecordingCatalogue, EveryEntrySaysWhoseItIs) {
  std::set<std::string> names;
  for (const PublicRecording& recording : RecordingCatalogue()) {
    EXPECT_TRUE(names.insert(recording.name).second) << recording.name;
    for (const std::string* field : {&recording.sensor, &recording.shows, &recording.licence})
      EXPECT_FALSE(field->empty()) << recording.name;
    EXPECT_TRUE(recording.source.starts_with("https://")) << recording.name;
    EXPECT_TRUE(recording.data.empty() || recording.data.starts_with("https://")) << recording.name;
    EXPECT_TRUE(recording.commit.empty() || recording.data.empty()) << recording.name << ": git has the data";
    EXPECT_TRUE(recording.commit.empty() || recording.commit.size() == 40) << recording.name;
    EXPECT_EQ(recording.commit.empty(), recording.paths.empty()) << recording.name;
    EXPECT_EQ(recording.witness_sha256.size(), recording.witness.empty() ? 0U : 64U) << recording.name;
    // A script moves them: nothing may lead out of the folder.
    for (const PublicRecording::Path& path : recording.paths) {
      EXPECT_EQ(path.to.find('/'), std::string::npos) << path.to;
      EXPECT_EQ(path.from.find(".."), std::string::npos) << path.from;
    }
  }
}

TEST(RecordingCatalogue, NamesTheRecordingsWithPoses) {
  std::set<std::string> posed;
  for (const PublicRecording& recording : RecordingCatalogue()) {
    if (recording.truth.find("pose") != std::string::npos ||
        recording.truth.find("odometry") != std::string::npos)
      posed.insert(recording.name);
  }
  EXPECT_EQ(posed, (std::set<std::string>{"neusis", "opti_acoustic_2025", "sonarsplat", "uxo_dataset2024"}));
}

TEST(RecordingCatalogue, KnowsARecordingByItsWitness) {
  const testing::TempDir dir;
  const PublicRecording recording{.name = "a",
                                  .sensor = {},
                                  .shows = {},
                                  .licence = {},
                                  .source = {},
                                  .commit = {},
                                  .paths = {},
                                  .witness = "w",
                                  .witness_sha256 = Sha256("right")};
  EXPECT_EQ(PresenceOf(recording, dir.path()), RecordingPresence::kAbsent);
  std::filesystem::create_directory(dir / "a");
  EXPECT_EQ(PresenceOf(recording, dir.path()), RecordingPresence::kDifferent);
  testing::WriteFile(dir / "a/w", "wrong");
  EXPECT_EQ(PresenceOf(recording, dir.path()), RecordingPresence::kDifferent);
  testing::WriteFile(dir / "a/w", "right");
  EXPECT_EQ(PresenceOf(recording, dir.path()), RecordingPresence::kPresent);
}

// The recordings that are here are those of the catalogue.
TEST(RecordingCatalogue, ChecksumsAreThoseOfTheRecordings) {
  for (const PublicRecording& recording : RecordingCatalogue()) {
    if (recording.name.ends_with("three_pings") || recording.witness.empty()) continue;
    SONARCAL_NEEDS_RECORDING(path, fmt::format("{}/{}", recording.name, recording.witness));
    EXPECT_EQ(Sha256OfFile(path), recording.witness_sha256) << recording.name;
  }
}

}  // namespace
}  // namespace sonarcal::data_io
