#include "data_io/parameters/marker_map_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>

#include "calib/markers/marker_detector.h"
#include "core/types/units.h"
#include "tests/data_io/refusal.h"
#include "tests/support/marker_print.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;
using testing::TempDir;

constexpr const char* kPose = "{\"position_m\": [0.5, -1, 0], \"quaternion_wxyz\": [1, 0, 0, 0]}";

class MarkerMapTest : public ::testing::Test {
 protected:
  MarkerMap Read(const std::string& dictionary, const std::string& markers, const std::string& rest = "") {
    testing::WriteFile(file_, "{\"format\": \"sonar-markers/1\", \"dictionary\": \"" + dictionary +
                                  "\",\n\"markers\": [" + markers + "]" + rest + "}");
    return ReadMarkerMap(file_);
  }
  std::string Refusal(const std::string& dictionary, const std::string& markers,
                      const std::string& rest = "") {
    return MessageOf([&] { Read(dictionary, markers, rest); });
  }
  static std::string Marker(const std::string& id, const std::string& size_m) {
    return "{\"id\": " + id + ", \"size_m\": " + size_m + ", \"world_from_marker\": " + kPose + "}";
  }

  TempDir dir_;
  std::filesystem::path file_ = dir_ / "map.json";
};

TEST_F(MarkerMapTest, AWrittenMapReadsBackExactly) {
  const MarkerMap map = Read("DICT_APRILTAG_36h11", Marker("586", "0.15") + "," + Marker("3", "0.3"),
                             ", \"sigma\": {\"position_m\": 0.002, \"angle_deg\": 0.5}");
  ASSERT_EQ(map.markers.size(), 2U);
  EXPECT_EQ(map.markers[0].id, 586);
  EXPECT_EQ(map.Find(3)->size_m, 0.3);
  EXPECT_EQ(map.Find(4), nullptr);
  EXPECT_EQ(map.sigma->position_m, 0.002);
  EXPECT_DOUBLE_EQ(map.sigma->angle_rad, RadFromDeg(0.5));
  WriteMarkerMap(dir_ / "again.json", map);
  const MarkerMap again = ReadMarkerMap(dir_ / "again.json");
  EXPECT_EQ(again.dictionary, map.dictionary);
  EXPECT_EQ(again.markers[1].world_from_marker.position_m, map.markers[1].world_from_marker.position_m);
  EXPECT_DOUBLE_EQ(again.sigma->angle_rad, map.sigma->angle_rad);
}

TEST_F(MarkerMapTest, InvalidMapsAreRefusedInOneSentence) {
  EXPECT_THAT(Refusal("DICT_9X9_50", Marker("0", "0.1")),
              HasSubstr("'dictionary' is 'DICT_9X9_50', expected one of"));
  EXPECT_THAT(Refusal("DICT_4X4_50", ""), HasSubstr("has 0 markers"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("50", "0.1")),
              HasSubstr("'markers[0].id' is 50, expected 0 to 49"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("-1", "0.1")), HasSubstr("markers[0].id"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("1.5", "0.1")), HasSubstr("markers[0].id"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("1", "0.1") + ",\n" + Marker("1", "0.2")),
              HasSubstr(":3: 'markers[1].id' is 1, as in line 2"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("1", "0")), HasSubstr("markers[0].size_m"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("1", "NaN")), HasSubstr("map.json:2"));
  EXPECT_THAT(
      Refusal("DICT_4X4_50", Marker("1", "0.1"), ", \"sigma\": {\"position_m\": 0, \"angle_deg\": 1}"),
      HasSubstr("sigma.position_m"));
  EXPECT_THAT(Refusal("DICT_4X4_50", Marker("1", "0.1"), ", \"sigmas\": 1"),
              HasSubstr("unknown key 'sigmas'"));
  std::string many;
  for (int i = 0; i <= 10'000; ++i) many += (i > 0 ? "," : "") + Marker("1", "0.1");
  EXPECT_THAT(Refusal("DICT_4X4_50", many), HasSubstr("has 10001 markers"));
}

// The names, numbers of ids and cells are OpenCV's.
TEST(MarkerDictionaries, NamesIdsAndCellsEqualThoseOfOpenCv) {
  EXPECT_EQ(MarkerDictionaries().size(), static_cast<std::size_t>(cv::aruco::DICT_APRILTAG_36h11) + 1);
  for (const MarkerDictionary& dictionary : MarkerDictionaries()) {
    const testing::MarkerDictionarySize opencv = testing::SizeOfMarkerDictionary(dictionary.opencv_code);
    EXPECT_EQ(opencv.ids, dictionary.ids) << dictionary.name;
    EXPECT_EQ(opencv.cells, dictionary.cells) << dictionary.name;
  }
  EXPECT_EQ(FindMarkerDictionary("DICT_APRILTAG_36h11")->opencv_code, cv::aruco::DICT_APRILTAG_36h11);
  EXPECT_EQ(FindMarkerDictionary("DICT_4X4_50")->opencv_code, cv::aruco::DICT_4X4_50);
  EXPECT_EQ(FindMarkerDictionary("DICT_ARUCO_ORIGINAL")->opencv_code, cv::aruco::DICT_ARUCO_ORIGINAL);
}

// Prints of two dictionaries, upright: corners from the top left, clockwise; a second print of an id spoils
// it.
TEST(MarkerDetector, FindsPrintsOfEveryKind) {
  for (const char* name :
       {"DICT_4X4_50", "DICT_6X6_250", "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_36h11"}) {
    const MarkerDictionary& dictionary = *FindMarkerDictionary(name);
    const Grid<std::uint8_t> print = testing::MarkerPrint(dictionary.opencv_code, 7, 12 * dictionary.cells);
    Grid<std::uint8_t> grey(200, 400, 220);
    const auto paste = [&](int top, int left) {
      for (int r = 0; r < print.rows(); ++r) {
        for (int c = 0; c < print.cols(); ++c) grey(top + r, left + c) = print(r, c);
      }
    };
    paste(30, 40);
    const calib::MarkersSeen once = calib::MarkerDetector(name).Detect(grey);
    ASSERT_EQ(once.markers.size(), 1U) << name;
    EXPECT_EQ(once.markers[0].id, 7);
    EXPECT_LT((once.markers[0].corners_px[0] - Eigen::Vector2d(40, 30)).norm(), 2.0);
    EXPECT_LT((once.markers[0].corners_px[1] - Eigen::Vector2d(40 + print.cols(), 30)).norm(), 2.0);
    paste(60, 220);
    const calib::MarkersSeen twice = calib::MarkerDetector(name).Detect(grey);
    EXPECT_TRUE(twice.markers.empty());
    EXPECT_THAT(twice.seen_twice, ::testing::ElementsAre(7));
  }
  EXPECT_TRUE(calib::MarkerDetector("DICT_4X4_50").Detect(Grid<std::uint8_t>(3, 3)).markers.empty());
}

}  // namespace
}  // namespace sonarcal::data_io
