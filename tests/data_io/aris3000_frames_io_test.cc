#include "data_io/aris3000_frames_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include <opencv2/imgcodecs.hpp>

#include "data_io/open_recording.h"
#include "data_io/types/units.h"
#include "tests/data_io/hostile.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::OpensWholly;
using testing::RefusalOf;
using testing::TempDir;

double Sum(const Grid<float>& grid) {
  return std::accumulate(grid.values().begin(), grid.values().end(), 0.0);
}

std::string Png(int rows, int cols, int type = CV_8UC1) {
  cv::Mat image(rows, cols, type);
  cv::randu(image, 0, 255);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(Aris3000Frames, ReadsTheRecordedFolder) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_uxo");
  const auto recording = OpenRecording(folder);
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(info.sonar.frequency_hz, 3.0e6);
  EXPECT_EQ(info.sonar.elevation_beam_width_deg, 15.0);
  EXPECT_EQ(info.sonar.axes.range_bins, 780);
  EXPECT_EQ(info.sonar.axes.range_min_m, 0.690);
  EXPECT_EQ(info.sonar.axes.range_max_m, 2.998);
  EXPECT_NEAR(info.sonar.axes.range_bin_m(), 2.96e-3, 1e-5);
  ASSERT_EQ(info.sonar.axes.beam_count(), 128);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.front()), -15.0068, 1e-9);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.back()), 15.0156, 1e-9);
  EXPECT_EQ(info.scale.full_scale, 255.0);
  ASSERT_TRUE(info.scale.db_span);
  EXPECT_NEAR(*info.scale.db_span, 97 * 80.0 / 255.0, 1e-12);
  EXPECT_FALSE(info.scale.db_min);
  EXPECT_FALSE(recording->frame_info(0).world_from_sonar);

  // From an independent decoding with Python.
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.info.name, "frame_0000_128x780.png");
  EXPECT_EQ(frame.image.value(0, 0), 36.0f);
  EXPECT_EQ(frame.image.value(0, 127), 26.0f);
  EXPECT_EQ(frame.image.value(120, 70), 115.0f);
  EXPECT_EQ(frame.image.value(779, 0), 60.0f);
  EXPECT_EQ(Sum(frame.image.value), 3326281.0);
  EXPECT_EQ(Sum(recording->ReadFrame(1).image.value), 3326028.0);
}

TEST(Aris3000Frames, ReadsTheOtherPoseFromItsFanPicture) {
  SONARCAL_NEEDS_RECORDING(picture, "aris3000_uxo/other_pose_fan.png");
  const auto recording = OpenRecording(picture);
  ASSERT_EQ(recording->frame_count(), 1);
  EXPECT_EQ(recording->info().scale.db_span, 80.0);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("nearest neighbour")));
  const Grid<float> value = recording->ReadFrame(0).image.value;
  // The strongest echo, the corners, and the sum, from an independent resampling with Python.
  EXPECT_EQ(value(250, 70), 13.0f);
  EXPECT_EQ(value(260, 60), 32.0f);
  EXPECT_EQ(value(0, 0), 16.0f);
  EXPECT_EQ(value(779, 127), 6.0f);
  EXPECT_EQ(Sum(value), 1406812.0);
}

TEST(Aris3000Frames, TakesTheCompiledBeamTableWhereTheFolderHasNone) {
  const TempDir dir;
  testing::WriteFile(dir / "frame_0007_128x780.png", Png(780, 128));
  const auto recording = OpenRecording(dir.path());
  EXPECT_NEAR(DegFromRad(recording->info().sonar.axes.beam_azimuth_rad.front()), -15.0068, 1e-9);
  EXPECT_EQ(recording->ReadFrame(0).info.name, "frame_0007_128x780.png");
}

TEST(Aris3000Frames, RefusesABeamTableThatIsNotOne) {
  const TempDir dir;
  testing::WriteFile(dir / "frame_0000_128x780.png", Png(780, 128));
  const auto refusal = [&](const std::string& table) {
    testing::WriteFile(dir / "beam_table_ARIS3000_128.csv", table);
    return RefusalOf(dir.path());
  };
  EXPECT_THAT(refusal(""), HasSubstr("0 beams, expected 128"));
  EXPECT_THAT(refusal("beam\n0,-1.0\n"), HasSubstr("1 beams, expected 128"));
  EXPECT_THAT(refusal("beam\n0,-1.0\n2,-0.5\n"), HasSubstr(":3: '2,-0.5', expected"));
  EXPECT_THAT(refusal("beam\n0,nan\n"), HasSubstr("'0,nan'"));
  EXPECT_THAT(refusal("beam\n0,1e999\n"), HasSubstr("expected"));
  EXPECT_THAT(refusal("beam\n0\n"), HasSubstr("expected"));
  std::string falling = "beam\n";
  for (int i = 0; i < 128; ++i) falling += fmt::format("{},{}\n", i, -i);
  EXPECT_THAT(refusal(falling), HasSubstr("expected left to right"));
  EXPECT_THAT(refusal(std::string(1 << 20, 'x')), HasSubstr("bytes, expected at most"));
}

TEST(Aris3000Frames, RefusesPicturesOfAnotherKind) {
  const TempDir dir;
  const auto refusal = [&](const std::string& png) {
    testing::WriteFile(dir / "frame_0000_128x780.png", png);
    return RefusalOf(dir.path());
  };
  const char* expected = "expected 8-bit grey, 780 x 128 pixels";
  EXPECT_NE(refusal("nothing"), "");
  EXPECT_THAT(refusal(Png(780, 127)), HasSubstr(expected));
  EXPECT_THAT(refusal(Png(780, 128, CV_8UC3)), HasSubstr(expected));
  EXPECT_THAT(refusal(Png(780, 128, CV_16UC1)), HasSubstr(expected));
  EXPECT_EQ(refusal(Png(780, 128)), "");
}

TEST(Aris3000Frames, DamagedPicturesEndInDataError) {
  const TempDir dir;
  testing::ExpectOnlyDataErrors(dir.path(), dir / "frame_0000_128x780.png", Png(780, 128), 64);
  testing::WriteFile(dir / "frame_0000_128x780.png", Png(780, 128).substr(0, 50000));
  EXPECT_FALSE(OpensWholly(dir.path()));
}

}  // namespace
}  // namespace sonarcal
