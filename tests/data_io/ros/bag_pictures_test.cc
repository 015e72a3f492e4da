// Bare pictures of sonars in bags: sensor_msgs/Image and CompressedImage with a geometry that somebody gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/imgcodecs.hpp>

#include "core/types/units.h"
#include "data_io/pictures/picture_geometry.h"
#include "data_io/ros/bag_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_bag.h"
#include "tests/data_io/message_writer.h"
#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MessageWriter;
using testing::Wire;

constexpr const char* kPolar = R"({"format": "sonar-picture-geometry/1", "name": "Pool sonar",
  "frequency_hz": 900000, "range_m": [1, 3],
  "polar": {"azimuth_first_deg": 20, "azimuth_last_deg": -10, "nearest_row": "bottom"}})";

// 16 bits, 2 rows x 3 columns: 1000 row + col.
std::string Picture(Wire wire, bool big_endian) {
  std::string data;
  for (int row = 0; row < 2; ++row) {
    for (int col = 0; col < 3; ++col) {
      const int value = 1000 * row + col;
      const char low = static_cast<char>(value);
      const char high = static_cast<char>(value >> 8);
      data += big_endian ? std::string{high, low} : std::string{low, high};
    }
  }
  MessageWriter message(wire);
  message.Header(50, 0, "sonar").U32(2).U32(3).String("mono16").U8(big_endian ? 1 : 0).U32(6).Blob(data);
  return message.bytes();
}

class BagPicturesTest : public ::testing::Test {
 protected:
  PictureGeometry Geometry(const std::string& json) {
    testing::WriteFile(dir_ / "geometry.json", json);
    return ReadPictureGeometry(dir_ / "geometry.json");
  }
  std::string GeometryRefusal(const std::string& json) {
    return testing::MessageOf([&] { Geometry(json); });
  }
  std::filesystem::path Write(const std::string& type, const std::string& bytes) {
    testing::WriteFile(dir_ / "test.bag", testing::Ros1BagBytes({{"/image", type, 1, bytes}}, {}));
    return dir_ / "test.bag";
  }

  testing::TempDir dir_;
};

TEST_F(BagPicturesTest, APolarPictureIsTurnedAsItsGeometrySays) {
  for (const Wire wire : testing::kWires) {
    for (const bool big_endian : {false, true}) {
      const auto path = dir_ / "test.bag";
      if (wire == Wire::kRos1) {
        Write("sensor_msgs/Image", Picture(wire, big_endian));
      } else {
        testing::WriteRos2Bag(path, {{"/image", "sensor_msgs/Image", 1, Picture(wire, big_endian)}});
      }
      const auto recording = OpenBagRecording(path, {.message = {.geometry = Geometry(kPolar)}});
      EXPECT_EQ(recording->info().sonar.name, "Pool sonar");
      EXPECT_EQ(recording->info().sonar.frequency_hz, 900000.0);
      EXPECT_THAT(recording->info().notes, Contains(HasSubstr("bare picture")));
      const Frame frame = recording->ReadFrame(0);
      EXPECT_EQ(*frame.info.time_s, 50.0);
      EXPECT_EQ(frame.image.scale.full_scale, 65535.0);
      EXPECT_NEAR(DegFromRad(frame.image.axes.beam_azimuth_rad[0]), -10.0, 1e-9);
      EXPECT_NEAR(DegFromRad(frame.image.axes.beam_azimuth_rad[1]), 5.0, 1e-9);
      EXPECT_EQ(frame.image.axes.range_bin_m(), 1.0);
      EXPECT_THAT(frame.image.value.values(), ElementsAre(1002, 1001, 1000, 2, 1, 0));
      const auto mirrored =
          OpenBagRecording(path, {.message = {.mirrored = true, .geometry = Geometry(kPolar)}});
      EXPECT_NEAR(DegFromRad(mirrored->info().sonar.axes.beam_azimuth_rad[0]), -20.0, 1e-9);
      EXPECT_EQ(mirrored->ReadFrame(0).image.value(0, 0), 1000.0F);
    }
  }
}

// A fan whose pixels are 10 x their distance from the apex in metres: every bin has 10 x its range.
TEST_F(BagPicturesTest, AFanPictureIsSampledFromItsApex) {
  constexpr double kPixelM = 0.05;
  cv::Mat fan(220, 260, CV_8UC1);
  for (int row = 0; row < fan.rows; ++row) {
    for (int col = 0; col < fan.cols; ++col) {
      const double range_m = kPixelM * std::hypot(230.0 - row, col - 130.0);
      fan.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(std::lround(10.0 * range_m));
    }
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", fan, png);
  MessageWriter message(Wire::kRos1);
  message.Header(50, 0, "sonar").String("png").Blob(std::string(png.begin(), png.end()));
  const auto path = Write("sensor_msgs/CompressedImage", message.bytes());
  const std::string geometry = R"({"format": "sonar-picture-geometry/1", "range_m": [2, 10],
      "fan": {"apex_px": [130, 230], "radius_px": [40, 200], "half_angle_deg": 30, "beams": 9, "range_bins": 40}})";
  const auto recording = OpenBagRecording(path, {.message = {.geometry = Geometry(geometry)}});
  const Frame frame = recording->ReadFrame(0);
  ASSERT_EQ(frame.image.axes.beam_count(), 9);
  EXPECT_NEAR(DegFromRad(frame.image.axes.BeamEdgesRad()[9]), 30.0, 1e-9);
  for (int bin = 0; bin < 40; ++bin) {
    for (int beam = 0; beam < 9; ++beam)
      EXPECT_NEAR(frame.image.value(bin, beam), 10.0 * frame.image.axes.range_centre_m(bin), 1.0);
  }
  // A message stands alone: where the fan is must be said.
  const char* somewhere =
      R"({"format": "sonar-picture-geometry/1", "range_m": [2, 10], "fan": {"half_angle_deg": 30}})";
  EXPECT_THAT(
      testing::MessageOf([&] { OpenBagRecording(path, {.message = {.geometry = Geometry(somewhere)}}); }),
      HasSubstr("neither 'polar' nor the position of the fan"));
}

TEST_F(BagPicturesTest, AMissingGeometryIsRefusedWithWhatToWrite) {
  const auto path = Write("sensor_msgs/Image", Picture(Wire::kRos1, false));
  EXPECT_THAT(testing::RefusalOf(path), HasSubstr("with --picture-geometry"));
  EXPECT_THAT(testing::MessageOf([&] { OpenBagRecording(path, {.topic = "/image"}); }),
              AllOf(HasSubstr("bare pictures (sensor_msgs/Image)"), HasSubstr("give --picture-geometry")));
}

TEST_F(BagPicturesTest, GeometriesThatAreNoneAreRefused) {
  const std::string start = R"({"format": "sonar-picture-geometry/1", "range_m": [1, 3])";
  EXPECT_FALSE(Geometry(start + "}").fan) << "to be found";
  EXPECT_THAT(GeometryRefusal(start + R"(, "fan": {}, "polar": {"azimuth_first_deg": 5, "azimuth_last_deg": 6,
                              "nearest_row": "top"}})"),
              HasSubstr("both 'polar' and 'fan'"));
  EXPECT_THAT(GeometryRefusal(start + R"(, "polar": {"azimuth_first_deg": 5, "azimuth_last_deg": 5,
                              "nearest_row": "top"}})"),
              HasSubstr("expected another angle"));
  EXPECT_THAT(
      GeometryRefusal(start + R"(, "fan": {"apex_px": [1], "radius_px": [1, 2], "half_angle_deg": 9}})"),
      HasSubstr("expected a column and a row"));
  EXPECT_THAT(GeometryRefusal(R"({"format": "sonar-picture-geometry/1", "range_m": [3, 3]})"),
              HasSubstr("must be two ranges, the nearer first"));
}

TEST_F(BagPicturesTest, DamagedPicturesEndInOneSentence) {
  cv::Mat grey(12, 16, CV_8UC1, cv::Scalar(90));
  const PictureGeometry geometry = Geometry(kPolar);
  for (const std::string format : {".png", ".jpg"}) {
    std::vector<std::uint8_t> encoded;
    cv::imencode(format, grey, encoded);
    const std::string whole(encoded.begin(), encoded.end());
    testing::ExpectSurvivesDamage(whole, 100, 200, [&](const std::string& bytes) {
      MessageWriter message(Wire::kRos1);
      message.Header(50, 0, "sonar").String("").Blob(bytes);
      OpenBagRecording(Write("sensor_msgs/CompressedImage", message.bytes()),
                       {.message = {.geometry = geometry}})
          ->ReadFrame(0);
    });
  }
}

}  // namespace
}  // namespace sonarcal::data_io
