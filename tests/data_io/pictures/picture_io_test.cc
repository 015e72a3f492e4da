#include "data_io/pictures/picture_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/imaging/fan_image.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/pictures/picture_frames.h"
#include "tests/data_io/hostile.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::RefusalOf;
using testing::TempDir;

constexpr int kBins = 300;
constexpr int kBeams = 96;

PolarAxes Axes() {
  PolarAxes axes{.range_min_m = 1.0, .range_max_m = 4.0, .range_bins = kBins, .beam_azimuth_rad = {}};
  for (int beam = 0; beam < kBeams; ++beam)
    axes.beam_azimuth_rad.push_back(RadFromDeg(20.0 * (2.0 * (beam + 0.5) / kBeams - 1.0)));
  return axes;
}

// Smooth, nowhere black, bright on the right and far away: what is mirrored or turned shows.
float Grey(double range_m, double azimuth_rad, int frame = 0) {
  return static_cast<float>(60.0 + 30.0 * range_m + 100.0 * azimuth_rad + 20.0 * std::sin(4.0 * range_m) +
                            frame);
}

// A viewer's picture: the fan on black, a margin about it.
Grid<std::uint8_t> Picture(int frame = 0) {
  const PolarAxes axes = Axes();
  Grid<float> polar(kBins, kBeams);
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam)
      polar(bin, beam) = Grey(axes.range_centre_m(bin), axes.beam_azimuth_rad[beam], frame);
  }
  const FanMap map(axes, FanOptions{.pixel_m = 0.008});
  const Grid<float> fan = map.Apply(polar);
  constexpr int kMargin = 7;
  Grid<std::uint8_t> picture(fan.rows() + 2 * kMargin, fan.cols() + 2 * kMargin);
  for (int row = 0; row < fan.rows(); ++row) {
    for (int col = 0; col < fan.cols(); ++col)
      picture(row + kMargin, col + kMargin) = static_cast<std::uint8_t>(std::lround(fan(row, col)));
  }
  return picture;
}

// The largest difference from what was drawn, but for the outermost pixels, half of which are black.
double WorstDifference(const Frame& frame, int number = 0) {
  double worst = 0.0;
  const PolarAxes& axes = frame.image.axes;
  for (int bin = 4; bin + 4 < axes.range_bins; ++bin) {
    for (int beam = 4; beam + 4 < axes.beam_count(); ++beam) {
      worst = std::max(worst, std::abs(double{frame.image.value(bin, beam)} -
                                       Grey(axes.range_centre_m(bin), axes.beam_azimuth_rad[beam], number)));
    }
  }
  return worst;
}

TEST(Pictures, PixelsAreSampledByRangeAndAzimuth) {
  const TempDir dir;
  WritePng(dir / "fan.png", Picture());
  testing::WriteFile(
      dir / "fan.png.geometry.json",
      R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4], "name": "a sonar", "db_span": 60})");
  const auto recording = OpenRecording(dir / "fan.png");
  EXPECT_EQ(recording->info().format, "fan pictures");
  EXPECT_EQ(recording->info().sonar.name, "a sonar");
  EXPECT_EQ(recording->info().scale.db_span, 60.0);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("found by its edges")));
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("bilinear")));
  const Frame frame = recording->ReadFrame(0);
  // As fine as the picture: 8 mm a pixel.
  EXPECT_NEAR(frame.image.axes.range_bins, 375, 3);
  EXPECT_NEAR(DegFromRad(frame.image.axes.BeamEdgesRad().back()), 20.0, 0.1);
  // A pixel of range is 0.3 grey levels and more, rounding half a one.
  EXPECT_LT(WorstDifference(frame), 2.0);
}

TEST(Pictures, GeometryAndGridAsGiven) {
  const TempDir dir;
  fs::create_directory(dir / "pictures");
  const Grid<std::uint8_t> picture = Picture();
  for (int k = 0; k < 3; ++k) WritePng(dir.path() / "pictures" / fmt::format("{}.png", k), Picture(10 * k));
  // The apex of the drawn fan: its far arc touches the upper margin.
  const double apex_y = 7 + 4.0 / 0.008 - 0.5;
  const double apex_x = 0.5 * picture.cols() - 0.5;
  testing::WriteFile(
      dir.path() / "pictures" / "geometry.json",
      fmt::format(
          R"({{"format": "sonar-picture-geometry/1", "range_m": [1, 4], "fan": {{"beams": 50, "range_bins": 200,
                      "apex_px": [{}, {}], "radius_px": [125, 500], "half_angle_deg": 20}}}})",
          apex_x, apex_y));
  const auto recording = OpenRecording(dir / "pictures");
  ASSERT_EQ(recording->frame_count(), 3);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("was given")));
  for (int k = 0; k < 3; ++k) {
    const Frame frame = recording->ReadFrame(k);
    EXPECT_EQ(frame.info.name, fmt::format("{}.png", k));
    EXPECT_EQ(frame.image.value.rows(), 200);
    EXPECT_EQ(frame.image.value.cols(), 50);
    EXPECT_LT(WorstDifference(frame, 10 * k), 0.8);
  }
}

// A fan is to scale: its arcs lie at 1 m and 4 m.
TEST(Pictures, TheFarthestRangeIsEnoughForAFan) {
  const TempDir dir;
  WritePng(dir / "fan.png", Picture());
  testing::WriteFile(dir / "fan.png.geometry.json",
                     R"({"format": "sonar-picture-geometry/1", "range_m": [4]})");
  const auto recording = OpenRecording(dir / "fan.png");
  EXPECT_NEAR(recording->info().sonar.axes.range_min_m, 1.0, 0.016) << "two pixels";
  EXPECT_EQ(recording->info().sonar.axes.range_max_m, 4.0);
  EXPECT_LT(WorstDifference(recording->ReadFrame(0)), 2.0);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("by the radii of the fan")));
  testing::WriteFile(dir / "fan.png.geometry.json",
                     R"({"format": "sonar-picture-geometry/1", "range_m": [4], "polar": {
                         "azimuth_first_deg": -30, "azimuth_last_deg": 30, "nearest_row": "top"}})");
  EXPECT_THAT(RefusalOf(dir / "fan.png"), HasSubstr("has one range, expected two for 'polar'"));
}

TEST(Pictures, FramesAreInTheOrderOfTheirNumbers) {
  const TempDir dir;
  for (const int k : {10, 2, 1}) WritePng(dir / fmt::format("frame_{}.png", k), Picture(k));
  testing::WriteFile(dir / "geometry.json", R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4]})");
  const auto recording = OpenRecording(dir.path());
  std::vector<std::string> names;
  for (int k = 0; k < recording->frame_count(); ++k) names.push_back(recording->ReadFrame(k).info.name);
  EXPECT_THAT(names, ElementsAre("frame_1.png", "frame_2.png", "frame_10.png"));
}

TEST(Pictures, APictureOfOtherSizeIsRefused) {
  const TempDir dir;
  fs::create_directory(dir / "pictures");
  WritePng(dir.path() / "pictures" / "0.png", Picture());
  WritePng(dir.path() / "pictures" / "1.png", Grid<std::uint8_t>(30, 40, 9));
  testing::WriteFile(dir.path() / "pictures" / "geometry.json",
                     R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4], "fan": {
                        "apex_px": [100, 500], "radius_px": [125, 400], "half_angle_deg": 20}})");
  EXPECT_THAT(RefusalOf(dir / "pictures"), HasSubstr("1.png: 30 x 40 pixels, expected those of the first"));
}

// Two windows of range, drawn to one size as a viewer does.
TEST(Pictures, AMixtureOfWindowsIsRefused) {
  const TempDir dir;
  const auto draw = [](double apex_y, double near_px, double far_px, double x_scale, double dark) {
    Grid<std::uint8_t> picture(480, 320);
    for (int row = 0; row < 480; ++row) {
      for (int col = 0; col < 320; ++col) {
        const double right = (col - 159.5) / x_scale;
        const double radius = std::hypot(right, apex_y - row);
        const bool is_inside = radius >= near_px && radius <= far_px &&
                               std::abs(std::atan2(right, apex_y - row)) <= RadFromDeg(15.13);
        const bool is_dark = std::fmod(7.31 * row + 3.7 * col, 1.0) < dark;
        picture(row, col) = is_inside && !is_dark ? 90 : 0;
      }
    }
    return picture;
  };
  for (int k = 0; k < 5; ++k)
    WritePng(dir / fmt::format("{}.png", k), draw(600.0, 136.4, 574.4, 1.0, 0.1 * k));
  testing::WriteFile(dir / "geometry.json", R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4]})");
  EXPECT_EQ(RefusalOf(dir.path()), "");
  WritePng(dir / "5.png", draw(745.0, 288.0, 717.0, 0.8, 0.2));
  EXPECT_THAT(RefusalOf(dir.path()), HasSubstr("show another fan than the others"));
  // The fan as given is the user's word.
  testing::WriteFile(dir / "geometry.json", R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4],
      "fan": {"apex_px": [159.5, 600], "radius_px": [136.4, 574.4], "half_angle_deg": 15.13}})");
  EXPECT_EQ(RefusalOf(dir.path()), "");
}

TEST(Pictures, AGeometryFromElsewhereNeedsNoFileBesideThem) {
  const TempDir dir;
  WritePng(dir / "fan.png", Picture());
  const auto recording = OpenPictureRecording(dir / "fan.png", {.range_min_m = 1.0, .range_max_m = 4.0});
  EXPECT_LT(WorstDifference(recording->ReadFrame(0)), 2.0);
}

// A picture of ranges and beams, as some recorders keep them.
TEST(Pictures, PolarPicturesAreTurnedAsTheirGeometryFileStates) {
  const TempDir dir;
  Grid<std::uint8_t> picture(2, 3);
  for (int i = 0; i < 6; ++i) picture.values()[i] = static_cast<std::uint8_t>(10 * i);
  WritePng(dir / "polar.png", picture);
  testing::WriteFile(dir / "polar.png.geometry.json",
                     R"({"format": "sonar-picture-geometry/1", "range_m": [1, 3],
                     "polar": {"azimuth_first_deg": 20, "azimuth_last_deg": -10, "nearest_row": "bottom"}})");
  const Frame frame = OpenRecording(dir / "polar.png")->ReadFrame(0);
  EXPECT_THAT(frame.image.value.values(), ::testing::ElementsAre(50, 40, 30, 20, 10, 0));
  EXPECT_NEAR(DegFromRad(frame.image.axes.beam_azimuth_rad[0]), -10.0, 1e-9);
}

// What is cut off stays 0 and does not count, and the share of it is said.
TEST(Pictures, SamplesOutsideThePictureAreInvalid) {
  const TempDir dir;
  WritePng(dir / "fan.png", Grid<std::uint8_t>(200, 100, 50));
  testing::WriteFile(dir / "fan.png.geometry.json",
                     R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4],
                     "fan": {"apex_px": [49.5, 199], "radius_px": [20, 190], "half_angle_deg": 30, "beams": 20}})");
  const auto recording = OpenRecording(dir / "fan.png");
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("% of the samples lie outside the picture")));
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.image.value(frame.image.axes.range_bins - 1, 0), 0.0F);
  EXPECT_EQ(frame.image.value(frame.image.axes.range_bins - 1, 10), 50.0F);
  const std::optional<Mask>& valid = recording->info().valid;
  ASSERT_TRUE(valid);
  for (std::size_t i = 0; i < valid->size(); ++i)
    EXPECT_EQ(valid->values()[i] != 0, frame.image.value.values()[i] > 0.0F);
}

TEST(Pictures, JpegsAndVideosAreReadWithTheirLosses) {
  const TempDir dir;
  const char* description =
      R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4], "fan": {"beams": 60, "range_bins": 200}})";
  const auto mat = [](Grid<std::uint8_t>& picture) {
    return cv::Mat(picture.rows(), picture.cols(), CV_8UC1, picture.values().data());
  };
  Grid<std::uint8_t> still = Picture();
  ASSERT_TRUE(cv::imwrite((dir / "fan.jpg").string(), mat(still), {cv::IMWRITE_JPEG_QUALITY, 95}));
  testing::WriteFile(dir / "fan.jpg.geometry.json", description);
  const auto jpeg = OpenRecording(dir / "fan.jpg");
  EXPECT_THAT(jpeg->info().notes, Contains(HasSubstr("compressed with losses")));
  EXPECT_LT(WorstDifference(jpeg->ReadFrame(0)), 6.0);

  {
    cv::VideoWriter writer((dir / "fan.avi").string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5.0,
                           cv::Size(still.cols(), still.rows()), false);
    ASSERT_TRUE(writer.isOpened());
    for (int k = 0; k < 4; ++k) {
      Grid<std::uint8_t> picture = Picture(10 * k);
      writer.write(mat(picture));
    }
  }
  testing::WriteFile(dir / "fan.avi.geometry.json", description);
  const auto video = OpenRecording(dir / "fan.avi");
  ASSERT_EQ(video->frame_count(), 4);
  EXPECT_NEAR(video->frame_info(3).time_s.value(), 0.6, 1e-9);
  // In any order.
  for (const int k : {0, 1, 3, 2}) EXPECT_LT(WorstDifference(video->ReadFrame(k), 10 * k), 6.0) << k;
}

TEST(Pictures, AVideoThatCannotBeDecodedIsRefusedWithItsCodec) {
  const TempDir dir;
  Grid<std::uint8_t> picture = Picture();
  {
    cv::VideoWriter writer((dir / "fan.avi").string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5.0,
                           cv::Size(picture.cols(), picture.rows()), false);
    ASSERT_TRUE(writer.isOpened());
    writer.write(cv::Mat(picture.rows(), picture.cols(), CV_8UC1, picture.values().data()));
  }
  std::string bytes = testing::ReadFile(dir / "fan.avi");
  for (std::size_t at = bytes.find("MJPG"); at != std::string::npos; at = bytes.find("MJPG", at))
    bytes.replace(at, 4, "ZZ9Z");
  testing::WriteFile(dir / "fan.avi", bytes);
  EXPECT_THAT(
      RefusalOf(dir / "fan.avi"),
      HasSubstr("fan.avi: a video that OpenCV and FFmpeg on this machine cannot decode (codec ZZ9Z)"));
  testing::WriteFile(dir / "fan.avi", bytes.substr(0, 60));
  EXPECT_THAT(RefusalOf(dir / "fan.avi"), HasSubstr("cannot decode"));
}

TEST(Pictures, HostileVideosAreRefused) {
  const TempDir dir;
  {
    cv::VideoWriter writer((dir / "fan.avi").string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5.0, cv::Size(48, 48), false);
    ASSERT_TRUE(writer.isOpened());
    cv::Mat fan(48, 48, CV_8UC1, cv::Scalar(0));
    for (int row = 4; row < 44; ++row) fan.row(row).colRange(4 + row / 3, 44 - row / 3).setTo(200);
    for (int k = 0; k < 3; ++k) writer.write(fan);
  }
  testing::WriteFile(
      dir / "fan.avi.geometry.json",
      R"({"format": "sonar-picture-geometry/1", "range_m": [4], "fan": {"beams": 6, "range_bins": 9}})");
  const std::string bytes = testing::ReadFile(dir / "fan.avi");
  testing::ExpectOnlyDataErrors(dir / "fan.avi", dir / "fan.avi", bytes, 300);
}

TEST(Pictures, WithoutADescriptionTheSentenceHoldsOne) {
  const TempDir dir;
  WritePng(dir / "fan.png", Picture());
  const std::string refusal = RefusalOf(dir / "fan.png");
  EXPECT_THAT(refusal, HasSubstr("fan.png.geometry.json"));
  EXPECT_THAT(refusal, HasSubstr("\"range_m\": [farthest], \"fan\": {\"apex_px\": ["));
  WritePng(dir / "square.png", Grid<std::uint8_t>(40, 40, 200));
  EXPECT_THAT(RefusalOf(dir / "square.png"), HasSubstr("no fan could be made out"));
}

TEST(Pictures, DescriptionsAreRefusedByKey) {
  const TempDir dir;
  WritePng(dir / "fan.png", Picture());
  const auto refusal = [&](const std::string& members) {
    testing::WriteFile(dir / "fan.png.geometry.json",
                       R"({"format": "sonar-picture-geometry/1")" + members + "}");
    return RefusalOf(dir / "fan.png");
  };
  EXPECT_EQ(refusal(R"(, "range_m": [1, 4])"), "");
  EXPECT_THAT(refusal(""), HasSubstr("range_m"));
  EXPECT_THAT(refusal(R"(, "range_m": [4, 1])"), HasSubstr("'range_m' must be two ranges"));
  EXPECT_EQ(refusal(R"(, "range_m": [4])"), "");
  EXPECT_THAT(refusal(R"(, "range_m": [0])"), HasSubstr("'range_m' must be two ranges"));
  EXPECT_THAT(refusal(R"(, "range_m": [])"), HasSubstr("'range_m' must be two ranges"));
  EXPECT_THAT(refusal(R"(, "range_m": [1, 4], "beam": 3)"), HasSubstr("unknown key 'beam'"));
  EXPECT_THAT(refusal(R"(, "range_m": [1, 4], "fan": {"beams": 1})"), HasSubstr("beams"));
  EXPECT_THAT(refusal(R"(, "range_m": [1, 4], "fan": {"apex_px": [1, 2]})"), HasSubstr("together"));
  EXPECT_THAT(refusal(R"(, "range_m": [1, 4], "fan": {"x_scale": 1.2})"), HasSubstr("x_scale"));
  EXPECT_THAT(
      refusal(
          R"(, "range_m": [1, 4], "fan": {"apex_px": [1, 2], "radius_px": [9, 3], "half_angle_deg": 20})"),
      HasSubstr("radius_max_px is 3"));
}

TEST(Pictures, HostileFilesAreRefused) {
  const TempDir dir;
  Grid<std::uint8_t> small(24, 24, 90);
  std::vector<std::uint8_t> jpeg;
  ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(24, 24, CV_8UC1, small.values().data()), jpeg));
  const char* description =
      R"({"format": "sonar-picture-geometry/1", "range_m": [1, 4], "fan": {"beams": 6, "range_bins": 9,
                               "apex_px": [12, 23], "radius_px": [2, 20], "half_angle_deg": 20}})";
  testing::WriteFile(dir / "fan.jpg.geometry.json", description);
  testing::ExpectOnlyDataErrors(dir / "fan.jpg", dir / "fan.jpg", {jpeg.begin(), jpeg.end()}, jpeg.size());
  testing::ExpectOnlyDataErrors(dir / "fan.jpg", dir / "fan.jpg.geometry.json", description, 1000);
  // 65,500 x 65,500 pixels announced.
  std::string huge(jpeg.begin(), jpeg.end());
  const std::size_t frame = huge.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  huge.replace(frame + 5, 4, "\xff\xdc\xff\xdc");
  testing::WriteFile(dir / "fan.jpg", huge);
  EXPECT_THAT(RefusalOf(dir / "fan.jpg"), HasSubstr("a JPEG of 65500 x 65500 pixels"));
}

// Levels of 12 bits in a picture of 16.
TEST(PictureFramesTest, AGreyPictureOf16BitsKeepsItsLevels) {
  const testing::TempDir dir;
  Grid<std::uint16_t> levels(64, 64);
  for (std::size_t i = 0; i < levels.size(); ++i) levels.values()[i] = static_cast<std::uint16_t>(i);
  WritePng(dir / "frame.png", levels);
  const Grid<float> grey = OpenPictures(dir / "frame.png")->Read(0);
  for (std::size_t i = 0; i < levels.size(); ++i)
    ASSERT_FLOAT_EQ(grey.values()[i], static_cast<float>(i) / 65535.0F * 255.0F);
}

}  // namespace
}  // namespace sonarcal::data_io
