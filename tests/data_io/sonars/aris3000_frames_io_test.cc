#include "data_io/sonars/aris3000_frames_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
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

FanGeometry OtherPoseFan() {
  return {.apex_x_px = 361.9,
          .apex_y_px = 1343.0,
          .radius_min_px = 309.0,
          .radius_max_px = 1340.0,
          .half_angle_deg = 15.13};
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
  const auto recording = OpenAris3000FanPicture(picture, OtherPoseFan());
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

// Fan pictures of any size say nothing of what they show: only a geometry does.
TEST(Aris3000Frames, NoPictureIsRecognisedByItsSize) {
  const TempDir dir;
  cv::Mat image(1079, 726, CV_8UC1, cv::Scalar(0));
  cv::ellipse(image, {363, 1000}, {800, 800}, -90.0, -20.0, 20.0, 90, cv::FILLED);
  ASSERT_TRUE(cv::imwrite((dir / "fan.png").string(), image));
  EXPECT_THAT(RefusalOf(dir / "fan.png"), HasSubstr("fan.png.geometry.json"));
  testing::WriteFile(dir / "fan.png.geometry.json", R"({"format": "sonar-picture-geometry/1",
      "range_m": [2, 7], "name": "another sonar", "fan": {"apex_px": [363, 1000], "radius_px": [10, 800],
      "half_angle_deg": 20}})");
  const auto recording = OpenRecording(dir / "fan.png");
  EXPECT_EQ(recording->info().sonar.name, "another sonar");
  EXPECT_EQ(recording->info().sonar.axes.range_max_m, 7.0);
}

TEST(Aris3000Frames, AGeometryBesideThemWins) {
  const TempDir dir;
  testing::WriteFile(dir / "frame_0000_128x780.png", Png(780, 128));
  EXPECT_EQ(OpenRecording(dir.path())->info().sonar.name, "ARIS Explorer 3000");
  testing::WriteFile(dir / "geometry.json", R"({"format": "sonar-picture-geometry/1", "range_m": [1, 5],
      "polar": {"azimuth_first_deg": -10, "azimuth_last_deg": 10, "nearest_row": "top"}})");
  EXPECT_EQ(OpenRecording(dir.path())->info().sonar.axes.range_max_m, 5.0);
}

TEST(Aris3000Frames, AFanThatThePictureDoesNotHoldIsRefused) {
  const TempDir dir;
  testing::WriteFile(dir / "fan.png", Png(500, 300));
  const auto recording = OpenAris3000FanPicture(dir / "fan.png", OtherPoseFan());
  EXPECT_THAT(
      [&] { recording->ReadFrame(0); },
      ::testing::ThrowsMessage<DataError>(HasSubstr("500 x 300 pixels, which do not hold the whole fan")));
}

// Counts about a smooth slope, stretched over `counts` levels; one pixel in `interpolated` lies between.
cv::Mat Stretched(int counts, int interpolated) {
  cv::Mat image(780, 128, CV_8UC1);
  for (int i = 0; i < 780 * 128; ++i) {
    const int count = (i * 7 + i / 128) % (counts + 1);
    const int grey = count * 255 / counts;
    image.data[i] =
        static_cast<std::uint8_t>(i % interpolated == interpolated - 1 ? std::min(255, grey + 1) : grey);
  }
  return image;
}

TEST(Aris3000Frames, CountsOfTheStretchingFollowFromTheLevels) {
  for (const int counts : {97, 96, 95, 60, 31}) {
    const TempDir dir;
    ASSERT_TRUE(cv::imwrite((dir / "frame_0000_128x780.png").string(), Stretched(counts, 100)));
    const auto recording = OpenRecording(dir.path());
    ASSERT_TRUE(recording->info().scale.db_span) << counts;
    EXPECT_NEAR(*recording->info().scale.db_span, counts * 80.0 / 255.0, 1e-12);
    EXPECT_THAT(recording->info().notes, Contains(HasSubstr(fmt::format("N = {}, a count", counts))));
  }
}

TEST(Aris3000Frames, FramesOfOtherCountsAreShownOnOneScale) {
  const TempDir dir;
  ASSERT_TRUE(cv::imwrite((dir / "frame_0000_128x780.png").string(), Stretched(95, 1 << 20)));
  ASSERT_TRUE(cv::imwrite((dir / "frame_0001_128x780.png").string(), Stretched(97, 1 << 20)));
  const auto recording = OpenRecording(dir.path());
  EXPECT_NEAR(recording->info().scale.db_span.value(), 97 * 80.0 / 255.0, 1e-12);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("N = 95 to 97")));
  for (const int counts : {95, 97}) {
    const Grid<float> grey = recording->ReadFrame(counts == 95 ? 0 : 1).image.value;
    for (int i = 0; i < 780 * 128; ++i) {
      const int count = (i * 7 + i / 128) % (counts + 1);
      ASSERT_EQ(grey.values()[i], count * 255 / 97) << counts << " " << i;
    }
  }
}

TEST(Aris3000Frames, AnUnknownStretchingIsSaid) {
  const TempDir dir;
  testing::WriteFile(dir / "frame_0000_128x780.png", Png(780, 128));
  const auto recording = OpenRecording(dir.path());
  EXPECT_FALSE(recording->info().scale.db_span);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("the dB scale is unknown")));
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
}  // namespace sonarcal::data_io
