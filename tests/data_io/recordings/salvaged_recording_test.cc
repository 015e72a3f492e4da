#include "data_io/recordings/salvaged_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Frame k is of grey k.
void WriteSmallRecording(const std::filesystem::path& folder, int frames) {
  RecordingInfo info;
  info.sonar.axes = {
      .range_min_m = 1.0, .range_max_m = 2.0, .range_bins = 3, .beam_azimuth_rad = {-0.1, 0.1}};
  std::vector<Frame> all;
  for (int k = 0; k < frames; ++k) {
    all.push_back({{}, {info.sonar.axes, info.scale, Grid<float>(3, 2, static_cast<float>(k))}});
  }
  WriteRecording(MemoryRecording(info, all), folder);
}

TEST(SalvagedRecording, ReadableFramesAreKept) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "rec", 4);
  testing::WriteFile(dir / "rec/frame_0001.png", "not a picture");
  std::filesystem::remove(dir / "rec/frame_0003.png");
  int done = 0;
  const SalvagedRecording salvaged(OpenRecording(dir / "rec"), [&](int frames) { done = frames; });
  EXPECT_EQ(done, 4);
  ASSERT_EQ(salvaged.frame_count(), 2);
  EXPECT_EQ(salvaged.lost_count(), 2);
  EXPECT_EQ(salvaged.ReadFrame(0).image.value(0, 0), 0.0F);
  EXPECT_EQ(salvaged.ReadFrame(1).image.value(0, 0), 2.0F);
  EXPECT_EQ(salvaged.frame_info(1).name, "frame_0002.png");
  EXPECT_THAT(salvaged.info().notes, Contains(HasSubstr("Frame 1 was omitted: ")));
  EXPECT_THAT(salvaged.info().notes, Contains("2 of 4 frames could not be read and were omitted."));
}

TEST(SalvagedRecording, AnUndamagedRecordingGetsNoNote) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "rec", 2);
  const SalvagedRecording salvaged(OpenRecording(dir / "rec"));
  EXPECT_EQ(salvaged.frame_count(), 2);
  EXPECT_THAT(salvaged.info().notes, ::testing::Not(Contains(HasSubstr("omitted"))));
}

TEST(SalvagedRecording, ManyThatAreLostAreNotAllNamed) {
  const testing::TempDir dir;
  WriteSmallRecording(dir / "rec", 40);
  for (int k = 1; k < 40; ++k)
    std::filesystem::remove(dir /
                            ("rec/frame_00" + std::string(k < 10 ? "0" : "") + std::to_string(k) + ".png"));
  const SalvagedRecording salvaged(OpenRecording(dir / "rec"));
  EXPECT_EQ(salvaged.frame_count(), 1);
  EXPECT_LT(salvaged.info().notes.size(), 20U);
  std::filesystem::remove(dir / "rec/frame_0000.png");
  EXPECT_THAT([&] { SalvagedRecording(OpenRecording(dir / "rec")); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("none of 40 frames can be read")));
}

}  // namespace
}  // namespace sonarcal::data_io
