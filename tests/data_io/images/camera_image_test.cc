#include "data_io/images/camera_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "data_io/images/image_io.h"
#include "data_io/images/jpeg_codec.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;
using testing::TempDir;

std::string Jpeg() {
  cv::Mat image(48, 64, CV_8UC1);
  for (int r = 0; r < image.rows; ++r) {
    for (int c = 0; c < image.cols; ++c) image.at<std::uint8_t>(r, c) = static_cast<std::uint8_t>(2 * r + c);
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, 95});
  return {bytes.begin(), bytes.end()};
}

class CameraImageTest : public ::testing::Test {
 protected:
  Grid<std::uint8_t> Read(const std::string& bytes) {
    testing::WriteFile(dir_ / "image", bytes);
    return ReadCameraImage(dir_ / "image");
  }
  TempDir dir_;
};

TEST_F(CameraImageTest, ReadsGreyAndColour) {
  const Grid<std::uint8_t> grey = Read(Jpeg());
  EXPECT_EQ(grey.rows(), 48);
  EXPECT_EQ(grey.cols(), 64);
  EXPECT_NEAR(grey(20, 30), 70, 3);
  RgbImage rgb(2, 3);
  rgb(1, 2) = {100, 200, 50};
  const auto png = EncodePng(rgb);
  EXPECT_EQ(Read({png.begin(), png.end()})(1, 2), std::lround(0.299 * 100 + 0.587 * 200 + 0.114 * 50));
  Grid<std::uint16_t> deep(2, 3, 0x8123);
  const auto png16 = EncodePng(deep);
  EXPECT_EQ(Read({png16.begin(), png16.end()})(1, 2), 0x81);
}

TEST_F(CameraImageTest, DamageIsOneSentence) {
  const std::string jpeg = Jpeg();
  EXPECT_THAT(MessageOf([&] { Read(jpeg.substr(0, jpeg.size() / 2)); }), HasSubstr("truncated JPEG"));
  EXPECT_THAT(MessageOf([&] { Read(jpeg.substr(0, 20)); }), HasSubstr("JPEG segment"));
  const auto png = EncodePng(Grid<std::uint8_t>(40, 40, 7));
  EXPECT_THAT(MessageOf([&] { Read(std::string(png.begin(), png.end() - 20)); }), HasSubstr("damaged PNG"));
  EXPECT_NE(MessageOf([&] { Read("not an image"); }), "");
  testing::ExpectSurvivesDamage(jpeg, 60, 200, [&](const std::string& bytes) { Read(bytes); });
  // A claim of 65535 x 65535 pixels is refused before anything is decoded.
  std::string huge = jpeg;
  const std::size_t frame = huge.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  for (std::size_t i = 5; i < 9; ++i) huge[frame + i] = '\xFF';
  EXPECT_THAT(MessageOf([&] { Read(huge); }), HasSubstr("65535 x 65535"));
}

// OpenCV also decodes bitmaps (BMP), for example. The frame segment of a JPEG within one must not lead there.
TEST(JpegCodec, BytesOfAnotherFormatAreRefused) {
  const std::string jpeg = Jpeg();
  EXPECT_GT(ReadJpegHeader(jpeg, "picture").pixels(), 0);
  const std::string bitmap = "BM" + jpeg.substr(2);
  EXPECT_EQ(MessageOf([&] { ReadJpegHeader(bitmap, "picture"); }), "picture: not a JPEG, expected one");
  EXPECT_EQ(MessageOf([&] { DecodeJpegRgb(bitmap, "picture"); }), "picture: not a JPEG, expected one");
}

// The thumbnail is a whole JPEG with an end marker of its own.
TEST_F(CameraImageTest, ATruncatedJpegWithAThumbnailIsRefused) {
  const std::string jpeg = Jpeg();
  const std::string content = std::string("Exif\0\0", 6) + jpeg;
  const std::size_t length = content.size() + 2;
  const std::string segment = {'\xFF', '\xE1', static_cast<char>(length >> 8), static_cast<char>(length)};
  const std::string whole = jpeg.substr(0, 2) + segment + content + jpeg.substr(2);
  EXPECT_EQ(Read(whole), Read(jpeg));
  EXPECT_THAT(MessageOf([&] { Read(whole.substr(0, whole.size() - jpeg.size() / 2)); }),
              HasSubstr("truncated JPEG"));
}

class CameraImageFolderTest : public ::testing::Test {
 protected:
  void Touch(const std::string& name) { testing::WriteFile(dir_ / name, "x"); }
  std::vector<std::string> Names(std::optional<NameTimes> unit = {}) {
    std::vector<std::string> names;
    for (const auto& image : ListCameraImages(dir_.path(), unit).images)
      names.push_back(image.file.filename().string());
    return names;
  }
  TempDir dir_;
};

TEST_F(CameraImageFolderTest, NumbersInNamesCountAsNumbers) {
  for (const char* name : {"frame_10.png", "frame_2.png", "frame_1.PNG", "notes.txt"}) Touch(name);
  EXPECT_THAT(Names(), ::testing::ElementsAre("frame_1.PNG", "frame_2.png", "frame_10.png"));
  EXPECT_EQ(ListCameraImages(dir_.path()).times, NameTimes::kNone);
  EXPECT_THAT(MessageOf([&] { Names(NameTimes::kSeconds); }), HasSubstr("not a plain number"));
}

TEST_F(CameraImageFolderTest, TheNumberOfDigitsInANameDecidesTheUnitOfTime) {
  Touch("1700000000200000.png");
  Touch("1700000000100000.jpg");
  const auto folder = ListCameraImages(dir_.path());
  EXPECT_EQ(folder.times, NameTimes::kMicroseconds);
  EXPECT_DOUBLE_EQ(*folder.images[0].time_s, 1700000000.1);
  EXPECT_DOUBLE_EQ(*ListCameraImages(dir_.path(), NameTimes::kNanoseconds).images[0].time_s, 1700000.0001);
  EXPECT_FALSE(ListCameraImages(dir_.path(), NameTimes::kNone).images[0].time_s);
  Touch("1700000000.png");  // of another kind: nobody knows
  EXPECT_EQ(ListCameraImages(dir_.path()).times, NameTimes::kNone);
}

TEST_F(CameraImageFolderTest, EmptyFoldersAndEqualTimesAreRefusedInOneSentence) {
  EXPECT_THAT(MessageOf([&] { Names(); }), HasSubstr("expected images"));
  Touch("12.50.png");
  Touch("12.5.png");
  EXPECT_THAT(MessageOf([&] { Names(); }), HasSubstr("the same time as"));
  EXPECT_THAT(MessageOf([&] { ListCameraImages(dir_ / "nowhere"); }), HasSubstr("no such folder"));
}

}  // namespace
}  // namespace sonarcal::data_io
