#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/report/pictures/depth_picture.h"
#include "apps/report/pictures/gallery_pictures.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/picture.h"
#include "data_io/pose_io.h"
#include "tests/apps/html_check.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

TEST(GalleryCommand, ShowsEachSceneInThreeColumnsAndCallsItSimulated) {
  const testing::TempDir dir;
  const Outcome outcome = RunSonarcal(
      "gallery --edge 0.5 --rays 256x128 --only seabed,jacket --views 2 --out " + Quoted(dir / "g"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("14 pictures of 2 scenes"));
  for (const char* scene : {"seabed", "jacket"}) {
    for (const char* view : {"1", "2"}) {
      const std::string stem = fmt::format("g/{}_{}", scene, view);
      const data_io::ImageHeader depth = data_io::ImageFile(dir / (stem + "_depth.png")).header();
      const data_io::ImageHeader fan = data_io::ImageFile(dir / (stem + "_fan.png")).header();
      const data_io::ImageHeader polar = data_io::ImageFile(dir / (stem + "_polar.png")).header();
      EXPECT_GT(depth.cols, 2 * depth.rows);  // 46 x 20 degrees
      EXPECT_GT(fan.rows, fan.cols);          // 9 m ahead, 7 m wide
      EXPECT_GE(polar.rows, 320);
    }
    EXPECT_TRUE(std::filesystem::exists(dir / fmt::format("g/{}.png", scene)));
  }
  const std::string page = testing::ReadFile(dir / "g/gallery.html");
  EXPECT_EQ(testing::HtmlFault(page), "");
  EXPECT_THAT(page, HasSubstr("Everything on this page is simulated"));
  EXPECT_THAT(page, HasSubstr("Jacket, viewpoint 2"));
  EXPECT_EQ(testing::ReadJsonFile(dir / "g/provenance.json")["configuration"]["bed"], true);
}

TEST(GalleryCommand, ShowsASceneOfTheUsers) {
  const TinyWorld world;
  const std::string scene = fmt::format("gallery -q --rays 96x64 --scene {} --sonar {} --params {}",
                                        Quoted(world.scene()), Quoted(world.sonar()), Quoted(world.params()));
  ASSERT_EQ(RunSonarcal(scene + " --poses " + Quoted(world.poses()) + " --out " + Quoted(world / "g")).status,
            0);
  EXPECT_TRUE(std::filesystem::exists(world / "g/scene_4_polar.png"));
  const Outcome poseless = RunSonarcal(scene + " --out " + Quoted(world / "h"));
  EXPECT_EQ(poseless.status, 2);
  EXPECT_TRUE(testing::IsOneSentence(poseless.err)) << poseless.err;
  EXPECT_FALSE(std::filesystem::exists(world / "h"));
}

// The direction of such a view may be longer than 1 by a rounding error.
TEST(GalleryCommand, AViewStraightDownSaysSo) {
  const TinyWorld world;
  std::vector<data_io::TimedPose> poses;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Quaterniond down = RotationFromYawPitchRoll(RadFromDeg(5.0 * i), RadFromDeg(-90.0), 0.0);
    poses.push_back({.time_s = {}, .world_from_sonar = {down, {0.0, 0.0, 2.5}}});
  }
  data_io::WritePoses(world.poses(), poses);
  ASSERT_EQ(
      RunSonarcal(fmt::format("gallery -q --rays 48x32 --scene {} --sonar {} --params {} --poses {} --out {}",
                              Quoted(world.scene()), Quoted(world.sonar()), Quoted(world.params()),
                              Quoted(world.poses()), Quoted(world / "g")))
          .status,
      0);
  const std::string page = testing::ReadFile(world / "g/gallery.html");
  EXPECT_THAT(page, ::testing::Not(HasSubstr("looking nan")));
  EXPECT_THAT(page, HasSubstr("viewpoint 6: sonar at (0.0, 0.0, 2.5) m, looking 90 degrees down"));
}

TEST(DepthPicture, MillimetresAreRoundedAndKeptWithinSixteenBits) {
  Grid<float> range_m(1, 6);
  const float values[] = {0.0F, 0.0001F, 1.2344F, 1.2346F, 65.535F, 70.0F};
  std::copy(std::begin(values), std::end(values), range_m.values().begin());
  const Grid<std::uint16_t> depth_mm = report::DepthInMillimetres(range_m);
  EXPECT_THAT(std::vector<std::uint16_t>(depth_mm.values().begin(), depth_mm.values().end()),
              ::testing::ElementsAre(0, 1, 1234, 1235, 65535, 65535));
}

TEST(DepthPicture, NearIsBrighterThanFarAndNothingIsWhite) {
  Grid<float> range_m(1, 3);
  range_m(0, 0) = 1.0F;
  range_m(0, 1) = 8.0F;
  const RgbImage picture = report::DepthPicture(range_m, 9.0);
  const auto brightness = [&](int col) {
    return picture(0, col)[0] + picture(0, col)[1] + picture(0, col)[2];
  };
  EXPECT_GT(brightness(0), brightness(1));
  EXPECT_EQ(picture(0, 2), data_io::kOutsideColor);
}

TEST(GalleryPictures, ASheetHoldsEveryPictureInItsColumn) {
  const auto plain = [](int rows, int cols, std::uint8_t red) { return RgbImage(rows, cols, {red, 0, 0}); };
  const RgbImage sheet = report::Sheet({{plain(4, 8, 10), plain(6, 3, 20), plain(6, 5, 30)},
                                        {plain(4, 8, 40), plain(6, 3, 50), plain(6, 5, 60)}});
  EXPECT_EQ(sheet.rows(), 2 * 6 + 12);
  EXPECT_EQ(sheet.cols(), 8 + 3 + 5 + 2 * 12);
  std::map<int, int> pixels;
  for (const auto& pixel : sheet.values()) ++pixels[pixel[0]];
  EXPECT_EQ(pixels[10], 32);
  EXPECT_EQ(pixels[20], 18);
  EXPECT_EQ(pixels[60], 30);
  EXPECT_EQ(sheet(1, 0)[0], 10);  // in the middle of its row
  EXPECT_EQ(sheet(0, 0), data_io::kOutsideColor);
  EXPECT_EQ(sheet(18, 8 + 12)[0], 50);
}

}  // namespace
}  // namespace sonarcal::commands
