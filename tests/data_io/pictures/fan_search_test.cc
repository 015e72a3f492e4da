#include "data_io/pictures/fan_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/pictures/picture_geometry.h"
#include "data_io/pictures/picture_io.h"
#include "tests/data_io/hostile.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

using Color = std::array<std::uint8_t, 3>;
constexpr Color kWhite = {255, 255, 255};
constexpr Color kGrey = {192, 192, 192};

class PicturesInMemory final : public PictureFrames {
 public:
  PicturesInMemory(std::vector<RgbImage> pictures, bool lossy)
      : pictures_(std::move(pictures)), lossy_(lossy) {}

  int count() const override { return static_cast<int>(pictures_.size()); }
  std::string name(int index) const override { return std::to_string(index); }
  bool is_lossy() const override { return lossy_; }
  RgbImage ReadColors(int index) const override { return pictures_.at(index); }
  Grid<float> Read(int index) const override {
    const Grid<std::uint8_t> grey = GreyOf(pictures_.at(index));
    Grid<float> values(grey.rows(), grey.cols());
    std::ranges::copy(grey.values(), values.values().begin());
    return values;
  }

 private:
  std::vector<RgbImage> pictures_;
  bool lossy_;
};

const FanGeometry kFan{.apex_x_px = 220.0,
                       .apex_y_px = 470.0,
                       .radius_min_px = 40.0,
                       .radius_max_px = 430.0,
                       .half_angle_deg = 14.4,
                       .x_scale = 1.0};
constexpr int kRows = 480;
constexpr int kCols = 440;

struct Drawing {
  Color background = {0, 0, 0};
  double dark = 0.2;  // fraction of pixels of the fan that show the background
  std::array<double, 3> tint = {1, 1, 1};
  unsigned seed = 1;
  // Fraction of dark pixels at a range and azimuth, where it is more than `dark`.
  std::function<double(double radius_px, double azimuth_deg)> darker = {};
};

RgbImage Draw(const Drawing& drawing) {
  std::mt19937 random(drawing.seed);
  std::uniform_real_distribution<double> uniform;
  RgbImage picture(kRows, kCols, drawing.background);
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const double right = col - kFan.apex_x_px;
      const double ahead = kFan.apex_y_px - row;
      const double radius = std::hypot(right, ahead);
      const double azimuth_deg = DegFromRad(std::atan2(right, ahead));
      if (radius < kFan.radius_min_px || radius > kFan.radius_max_px ||
          std::abs(azimuth_deg) > kFan.half_angle_deg)
        continue;
      const double dark =
          drawing.darker ? std::max(drawing.dark, drawing.darker(radius, azimuth_deg)) : drawing.dark;
      if (uniform(random) < dark) continue;
      const double grey = 60.0 + 190.0 * uniform(random);
      for (int i = 0; i < 3; ++i) picture(row, col)[i] = static_cast<std::uint8_t>(grey * drawing.tint[i]);
    }
  }
  return picture;
}

// A digit of 6 x 10 pixels: a frame, with a bar that depends on `digit`.
void DrawDigit(RgbImage& picture, int top, int left, int digit, const Color& color) {
  for (int row = 0; row < 10; ++row) {
    for (int col = 0; col < 6; ++col) {
      if (row == 0 || row == 9 || col == 0 || col == 5 || row == 1 + digit % 8)
        picture(top + row, left + col) = color;
    }
  }
}

// Ranges on both sides, parallel to the sides, and a word below, as viewers print them.
void DrawLabels(RgbImage& picture, const Color& color) {
  for (int label = 0; label < 9; ++label) {
    const double radius = kFan.radius_min_px + 10.0 + label * 45.0;
    const auto top =
        static_cast<int>(kFan.apex_y_px - radius * std::cos(RadFromDeg(kFan.half_angle_deg))) - 5;
    const auto side = static_cast<int>(radius * std::sin(RadFromDeg(kFan.half_angle_deg)));
    for (int digit = 0; digit < 2; ++digit) {
      DrawDigit(picture, top, 220 + side + 14 + 8 * digit, label + digit, color);
      DrawDigit(picture, top, 220 - side - 30 + 8 * digit, label + digit, color);
    }
  }
  for (int letter = 0; letter < 6; ++letter) DrawDigit(picture, 450, 196 + 8 * letter, letter, color);
}

void ExpectTheFan(const FanSearch& search, const std::string& what, double px = 1.0) {
  ASSERT_TRUE(search.fan()) << what;
  const FanGeometry& fan = *search.fan();
  EXPECT_NEAR(fan.apex_x_px, kFan.apex_x_px, px) << what;
  EXPECT_NEAR(fan.apex_y_px - fan.radius_min_px, kFan.apex_y_px - kFan.radius_min_px, px) << what;
  EXPECT_NEAR(fan.apex_y_px - fan.radius_max_px, kFan.apex_y_px - kFan.radius_max_px, px) << what;
  EXPECT_NEAR(fan.half_angle_deg, kFan.half_angle_deg, 0.3 * px) << what;
  EXPECT_NEAR(fan.x_scale, 1.0, 0.02 * px) << what;
}

void ExpectTheFanIn(const RgbImage& picture, const std::string& what, double px = 1.0) {
  const PicturesInMemory pictures({picture}, false);
  ExpectTheFan(FanSearch(pictures), what, px);
}

TEST(FanSearch, TheBackgroundNeedNotBeBlack) {
  for (const Color& background : {Color{0, 0, 0}, kWhite, Color{40, 60, 90}, Color{0, 0, 128}})
    ExpectTheFanIn(Draw({.background = background}), "background " + std::to_string(background[2]));
}

TEST(FanSearch, ColouredFansAreFoundByAnyChannel) {
  // Luminance 29 at most.
  ExpectTheFanIn(Draw({.tint = {0.0, 0.0, 1.0}}), "blue");
  const PicturesInMemory lossy({Draw({.tint = {0.0, 0.0, 1.0}})}, true);
  ExpectTheFan(FanSearch(lossy), "blue, with losses");
}

TEST(FanSearch, TextBesideTheFanIsLeftOut) {
  for (const double dark : {0.0, 0.3, 0.6}) {
    RgbImage picture = Draw({.dark = dark});
    DrawLabels(picture, kWhite);
    ExpectTheFanIn(picture, "labels, dark " + std::to_string(dark));
  }
}

// The far half is dark but for a few echoes, as of a fish in open water.
TEST(FanSearch, TextIsLeftOutOfADarkPicture) {
  RgbImage picture = Draw({.darker = [](double radius, double) { return radius > 200.0 ? 0.97 : 0.0; }});
  DrawLabels(picture, kGrey);
  ExpectTheFanIn(picture, "labels, dark far half", 3.0);
}

TEST(FanSearch, PanelsAndFramesAreLeftOut) {
  RgbImage picture = Draw({});
  for (int row = 3; row < kRows - 3; ++row) {
    picture(row, 2) = picture(row, kCols - 3) = kGrey;
    for (int col = 380; col < 420; ++col) picture(row, col) = {static_cast<std::uint8_t>(row / 2), 80, 80};
  }
  for (int col = 2; col < kCols - 2; ++col) picture(2, col) = picture(kRows - 3, col) = kGrey;
  ExpectTheFanIn(picture, "panel and frame");
}

// Ringing of a compressed video that was saved without losses.
TEST(FanSearch, NearlyBlackIsBlackIfTheOutlineIsClearerThen) {
  RgbImage picture = Draw({});
  std::mt19937 random(7);
  for (int row = 20; row < kRows - 20; ++row) {
    for (int col = 20; col < kCols - 20; ++col) {
      if (picture(row, col) == Color{0, 0, 0} && random() % 5 == 0) picture(row, col) = {9, 9, 9};
    }
  }
  ExpectTheFanIn(picture, "nearly black");
}

TEST(FanSearch, OfFramesTheTextThatStaysIsLeftOut) {
  std::vector<RgbImage> frames;
  for (unsigned k = 0; k < 6; ++k) {
    RgbImage picture = Draw({.dark = 0.5, .seed = k + 1, .darker = [](double radius, double) {
                               return radius > 200.0 ? 0.95 : 0.0;
                             }});
    DrawLabels(picture, kWhite);
    // A clock, which does not stay.
    DrawDigit(picture, 5, 5, static_cast<int>(k), kWhite);
    frames.push_back(std::move(picture));
  }
  const PicturesInMemory pictures(frames, true);
  const FanSearch search(pictures);
  ExpectTheFan(search, "six frames", 2.0);
  EXPECT_FALSE(ShowsAnotherFan(search.LitPixels(3), *search.fan()));
  const Mask lit = search.LitPixels(0);
  EXPECT_EQ(lit(450, 196), 0) << "the word below is overlay";
}

// A frozen video: everything stays, and nothing is overlay.
TEST(FanSearch, AFrozenFanIsNoOverlay) {
  const PicturesInMemory pictures(std::vector<RgbImage>(6, Draw({.dark = 0.7})), true);
  ExpectTheFan(FanSearch(pictures), "frozen");
}

TEST(FanSearch, ADarkOutlineIsSaid) {
  const PicturesInMemory clear({Draw({})}, false);
  EXPECT_GT(FanSearch(clear).visibility().min(), 0.95);
  const PicturesInMemory dark(
      {Draw({.darker = [](double radius, double) { return radius > 200.0 ? 0.97 : 0.0; }})}, false);
  const FanSearch search(dark);
  ASSERT_TRUE(search.fan());
  EXPECT_LT(search.visibility().far_arc, 0.5);
}

TEST(FanSearch, PicturesWithoutAFanHaveNone) {
  const PicturesInMemory black({RgbImage(40, 40)}, false);
  EXPECT_FALSE(FanSearch(black).fan());
  const PicturesInMemory full({RgbImage(40, 40, kWhite)}, false);
  EXPECT_FALSE(FanSearch(full).fan());
  const PicturesInMemory line({RgbImage(1, 1)}, false);
  EXPECT_FALSE(FanSearch(line).fan());
  const PicturesInMemory sizes({RgbImage(40, 40), RgbImage(40, 41)}, false);
  EXPECT_THROW(FanSearch{sizes}, DataError);
  std::mt19937 random(3);
  for (int draw = 0; draw < 100; ++draw) {
    RgbImage noise(2 + static_cast<int>(random() % 60), 2 + static_cast<int>(random() % 60));
    for (Color& pixel : noise.values())
      pixel = {static_cast<std::uint8_t>(random() % 3 == 0 ? random() : 0), 0, 0};
    const PicturesInMemory pictures({noise}, draw % 2 == 0);
    const FanSearch search(pictures);
    if (search.fan()) search.fan()->Validate("noise");
  }
}

// Videos of a DIDSON's viewer. The first two are clear: a field of view of 28.8 degrees, and radii of 1 to
// 24.8, as the window of 0.42..10.42 m of that sonar has. Of the third, labels of the ranges 0.5..5.0 m
// stand parallel to the sides: 12.56 columns for 49.67 rows, which is 14.19 degrees, symmetric about column
// 261.5.
struct Video {
  const char* file;
  int frames;
  FanGeometry fan;
  bool dark;
};

const Video kVideos[] = {{"didson_videos/lamprey1.avi", 150, {199.0, 806.0, 33.5, 805.6, 14.25, 1.0}, false},
                         {"didson_videos/lamprey2.avi", 58, {199.0, 806.0, 33.5, 805.6, 14.25, 1.0}, false},
                         {"didson_videos/pike1.avi", 26, {261.5, 565.2, 42.5, 541.9, 14.19, 1.0}, true}};

TEST(FanSearchOfVideos, FindsTheFanOfEachCodec) {
  for (const Video& video : kVideos) {
    SONARCAL_NEEDS_RECORDING(path, video.file);
    const std::unique_ptr<PictureFrames> pictures = OpenPictures(path);
    const FanSearch search(*pictures);
    ASSERT_TRUE(search.fan()) << video.file;
    const FanGeometry& fan = *search.fan();
    EXPECT_NEAR(fan.apex_x_px, video.fan.apex_x_px, 1.0) << video.file;
    EXPECT_NEAR(fan.apex_y_px, video.fan.apex_y_px, 3.0) << video.file;
    EXPECT_NEAR(fan.apex_y_px - fan.radius_min_px, video.fan.apex_y_px - video.fan.radius_min_px, 2.0);
    EXPECT_NEAR(fan.apex_y_px - fan.radius_max_px, video.fan.apex_y_px - video.fan.radius_max_px, 2.0);
    EXPECT_NEAR(fan.half_angle_deg, video.fan.half_angle_deg, 0.2) << video.file;
    EXPECT_NEAR(fan.x_scale, 1.0, 0.01) << video.file;
    EXPECT_EQ(search.visibility().min() < 0.5, video.dark) << video.file;
  }
}

// Here the labels cannot be known by what stays. Only the part up to 3 m is lit.
TEST(FanSearchOfVideos, ASingleFrameOfTheDarkVideoIsEnoughForTheSides) {
  const Video& video = kVideos[2];
  SONARCAL_NEEDS_RECORDING(path, video.file);
  const std::unique_ptr<PictureFrames> frames = OpenPictures(path);
  for (const int index : {0, 13, 25}) {
    const PicturesInMemory still({frames->ReadColors(index)}, false);
    const FanSearch search(still);
    ASSERT_TRUE(search.fan()) << index;
    EXPECT_NEAR(search.fan()->apex_x_px, video.fan.apex_x_px, 1.0) << index;
    EXPECT_NEAR(search.fan()->apex_y_px, video.fan.apex_y_px, 3.0) << index;
    EXPECT_NEAR(search.fan()->radius_min_px, video.fan.radius_min_px, 2.0) << index;
    EXPECT_NEAR(search.fan()->half_angle_deg, video.fan.half_angle_deg, 0.2) << index;
  }
}

TEST(FanSearchOfVideos, AreOpenedWithAGeometryAndDescribedWithoutOne) {
  for (const Video& video : kVideos) {
    SONARCAL_NEEDS_RECORDING(path, video.file);
    const auto recording = OpenPictureRecording(path, {.range_max_m = 10.0});
    EXPECT_EQ(recording->frame_count(), video.frames);
    EXPECT_NEAR(recording->info().sonar.axes.range_min_m,
                10.0 * video.fan.radius_min_px / video.fan.radius_max_px, 0.05);
    EXPECT_NEAR(recording->frame_info(5).time_s.value(), 0.5, 1e-9);
    const Frame frame = recording->ReadFrame(video.frames / 2);
    EXPECT_GT(*std::ranges::max_element(frame.image.value.values()), 90.0F) << video.file;
    if (video.dark) {
      EXPECT_THAT(recording->info().notes, Contains(HasSubstr("outline of the fan is dark in places")));
    } else {
      EXPECT_THAT(recording->info().notes, Not(Contains(HasSubstr("dark in places"))));
    }
    const testing::TempDir dir;
    std::filesystem::copy_file(path, dir / "video.avi");
    const std::string refusal = testing::RefusalOf(dir / "video.avi");
    EXPECT_THAT(refusal,
                HasSubstr("video.avi.geometry.json: {\"format\": \"sonar-picture-geometry/1\", \"range_m\": "
                          "[farthest], \"fan\": {\"apex_px\": ["));
    EXPECT_EQ(refusal.find("dark in places") != std::string::npos, video.dark) << refusal;
  }
}

}  // namespace
}  // namespace sonarcal::data_io
