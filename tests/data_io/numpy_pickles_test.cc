// Pickles that NumPy itself writes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "data_io/open_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

TEST(NumpyPickles, EveryProtocolAndLayoutGivesTheSameFrame) {
  const testing::TempDir dir;
  const std::string command = fmt::format("{} {}/write_pickles.py '{}' >'{}'", SONARCAL_PYTHON,
                                          SONARCAL_SCRIPTS, dir.path().string(), (dir / "count").string());
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  EXPECT_THAT(testing::RefusalOf(dir / "refused.pkl"), ::testing::HasSubstr("multiarray.scalar"));
  std::filesystem::remove(dir / "refused.pkl");
  const auto recording = OpenRecording(dir.path());
  ASSERT_EQ(recording->frame_count(), std::stoi(testing::ReadFile(dir / "count")));
  ASSERT_EQ(recording->frame_count(), 15);
  for (int i = 0; i < recording->frame_count(); ++i) {
    const Frame frame = recording->ReadFrame(i);
    EXPECT_EQ(frame.info.name, fmt::format("{}.pkl", i));
    EXPECT_THAT(frame.image.value.values(), ::testing::ElementsAre(2, 1, 0, 5, 4, 3, 8, 7, 6, 11, 10, 9))
        << i;
    ASSERT_TRUE(frame.info.world_from_sonar) << i;
    const Eigen::Vector3d ahead = *frame.info.world_from_sonar * Eigen::Vector3d(0, 1, 0);
    EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d(2, 2, 3), 1e-9)) << i;
  }
}

}  // namespace
}  // namespace sonarcal::data_io
