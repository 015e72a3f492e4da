#include "data_io/open_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_io/types/error.h"
#include "tests/support/temp_dir.h"

namespace sonarcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(OpenRecording, NamesAPathThatDoesNotExist) {
  EXPECT_THAT([] { OpenRecording("no/such/recording"); },
              ThrowsMessage<DataError>("no/such/recording: no such file or folder"));
}

TEST(OpenRecording, ListsWhatItUnderstandsWhereNothingFits) {
  const testing::TempDir dir;
  testing::WriteFile(dir / "notes.txt", "not a recording");
  testing::WriteFile(dir / "empty", "");
  for (const auto& path : {dir.path(), dir / "notes.txt", dir / "empty"}) {
    EXPECT_THAT([&] { OpenRecording(path); },
                ThrowsMessage<DataError>(AllOf(HasSubstr("not a recording of a known format"),
                                               HasSubstr("frame_NNNN_128x780.png"))))
        << path;
  }
}

}  // namespace
}  // namespace sonarcal
