#include "data_io/open_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"
#include "tests/data_io/hostile.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(OpenRecording, NamesAPathThatDoesNotExist) {
  EXPECT_THAT([] { OpenRecording("no/such/recording"); },
              ThrowsMessage<DataError>("no/such/recording: no such file or folder"));
}

TEST(OpenRecording, AnUnknownFileIsRefusedWithTheListOfFormats) {
  const testing::TempDir dir;
  testing::WriteFile(dir / "notes.txt", "not a recording");
  testing::WriteFile(dir / "empty", "");
  for (const auto& path : {dir.path(), dir / "notes.txt", dir / "empty"}) {
    EXPECT_THAT([&] { OpenRecording(path); },
                ThrowsMessage<DataError>(AllOf(HasSubstr("not a recording of a known format"),
                                               HasSubstr("recording.json"), HasSubstr(".aris"),
                                               HasSubstr("Oculus"), HasSubstr("DIDSON"))))
        << path;
  }
}

TEST(OpenRecording, NoFileIsTakenForARecordingByItsFirstLettersAlone) {
  const testing::TempDir dir;
  // Both begin as a format's magic number does.
  testing::WriteFile(dir / "text", "SO far, this is a text and no Oculus message.");
  testing::WriteFile(dir / "short", "DDF\x05");
  EXPECT_THAT([&] { OpenRecording(dir / "text"); }, ThrowsMessage<DataError>(HasSubstr("known format")));
  EXPECT_THAT([&] { OpenRecording(dir / "short"); },
              ThrowsMessage<DataError>(HasSubstr("data end at byte 4")));
}

TEST(OpenRecording, OpensEveryRealRecording) {
  for (const char* name :
       {"aris1200_telephoto/sample.aris", "aris3000_broken/output.aris", "oculus_m1200d/one_ping_8bit.raw",
        "didson_hull/background", "didson_hull/test", "synthetic_tank", "synthetic_tank/recording.json",
        "synthetic_tank_ghosts", "synthetic_tank_static", "synthetic_tank_poses"}) {
    SONARCAL_NEEDS_RECORDING(path, name);
    EXPECT_TRUE(testing::OpensWholly(path)) << name;
  }
}

}  // namespace
}  // namespace sonarcal::data_io
