#include "data_io/parameters/camera_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "core/types/units.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MessageOf;
using testing::TempDir;

constexpr const char* kOpenCv =
    "%YAML:1.0\n---\ncalibration_time: \"Sun 22 Nov 2026 10:11:12\"\nnframes: 12\nimage_width: 1280\n"
    "image_height: 960\n# flags: +fix_k3\nflags: 6144\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: "
    "3\n"
    "   dt: d\n   data: [ 1.0525e+03, 0., 6.395e+02, 0., 1.0505e+03, 4.795e+02, 0.,\n       0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
    "   data: [ -2.5e-01, 1.e-01, 1.e-03,\n       -2.e-03, 0. ]\navg_reprojection_error: 2.9e-01\n";

constexpr const char* kRos =
    "image_width: 640\r\nimage_height: 480\r\ncamera_name: left\r\ncamera_matrix:\r\n  rows: 3\r\n  cols: "
    "3\r\n"
    "  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\r\ndistortion_model: "
    "plumb_bob\r\ndistortion_coefficients:\r\n"
    "  rows: 1\r\n  cols: 5\r\n  data: [0.1, 0.2, 0.3, 0.4, 0.5]\r\nrectification_matrix:\r\n  data: [1, "
    "0]\r\n";

std::string Changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string Refusal(const std::string& text) {
  return MessageOf([&] { CameraFromText(text, "cam.yaml"); });
}

TEST(CameraIo, FilesOfOpenCvAndRosAreRead) {
  const Camera camera = CameraFromText(kOpenCv, "cam.yaml");
  EXPECT_EQ(camera.cols, 1280);
  EXPECT_EQ(camera.rows, 960);
  EXPECT_EQ(camera.fx_px, 1052.5);
  EXPECT_EQ(camera.fy_px, 1050.5);
  EXPECT_EQ(camera.cx_px, 639.5);
  EXPECT_EQ(camera.cy_px, 479.5);
  EXPECT_THAT(camera.distortion, ElementsAre(-0.25, 0.1, 0.001, -0.002, 0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(CameraFromText(kRos, "cam.yaml").distortion,
              ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0, 0, 0, 0, 0));
}

std::string XmlOfOpenCv() {
  cv::FileStorage storage("camera.xml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "calibration_time"
          << "Tue 03 Nov 2026"
          << "image_width" << 1280 << "image_height" << 960;
  storage << "camera_matrix" << (cv::Mat_<double>(3, 3) << 1052.5, 0, 639.5, 0, 1050.5, 479.5, 0, 0, 1);
  storage << "distortion_coefficients" << (cv::Mat_<double>(5, 1) << -0.25, 0.1, 1e-3, -2e-3, 0);
  storage << "per_view_errors" << std::vector<double>{0.2, 0.3};
  return storage.releaseAndGetString();
}

TEST(CameraIo, ReadsTheXmlThatOpenCvWrites) {
  const Camera camera = CameraFromText(XmlOfOpenCv(), "cam.xml");
  const Camera same = CameraFromText(kOpenCv, "cam.yaml");
  EXPECT_EQ(camera.cols, same.cols);
  EXPECT_EQ(camera.rows, same.rows);
  EXPECT_EQ(camera.fx_px, same.fx_px);
  EXPECT_EQ(camera.fy_px, same.fy_px);
  EXPECT_EQ(camera.cx_px, same.cx_px);
  EXPECT_EQ(camera.cy_px, same.cy_px);
  EXPECT_EQ(camera.distortion, same.distortion);
  EXPECT_THAT(Refusal(Changed(XmlOfOpenCv(), "<image_width>1280", "<image_width>12x")),
              HasSubstr("image_width is '12x', expected a finite number"));
  EXPECT_THAT(Refusal(Changed(XmlOfOpenCv(), "<image_height>", "<image_width>3</image_width><image_height>")),
              HasSubstr("key 'image_width' for the second time"));
  std::string deep = "<opencv_storage>";
  for (int i = 0; i < 50'000; ++i) deep += "<a>";
  for (int i = 0; i < 50'000; ++i) deep += "</a>";
  EXPECT_THAT(Refusal(deep + "</opencv_storage>"), HasSubstr("more than 32 deep"));
  testing::ExpectSurvivesDamage(XmlOfOpenCv(), 200, 500,
                                [](const std::string& text) { CameraFromText(text, "cam.xml"); });
}

TEST(CameraIo, InvalidCamerasAreRefusedInOneSentence) {
  EXPECT_THAT(Refusal(""), HasSubstr("no 'image_width'"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1280", "1280.5")),
              HasSubstr("cam.yaml:5: image_width is 1280.5, expected"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1280", "99999999999")), HasSubstr("expected a whole number"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1280\nimage_height: 960", "65535\nimage_height: 65535")),
              HasSubstr("images of 65535 x 65535"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1.0525e+03", ".Nan")), HasSubstr("camera_matrix.data is '.Nan'"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1.0525e+03", "nan")), HasSubstr("expected a finite number"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1.0525e+03", "-5")), HasSubstr("focal lengths -5"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "1.0525e+03, 0.", "1.0525e+03, 0.5")), HasSubstr("skewed"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "6.395e+02", "9e+05")), HasSubstr("far outside"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "0.,\n       0., 1. ]", "0.,\n")), HasSubstr("cam.yaml:16: not YAML"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "-2.e-03, 0. ]", "-2.e-03, 0., 1 ]")), HasSubstr("has 6 numbers"));
  EXPECT_THAT(Refusal(Changed(kOpenCv, "nframes", "image_width")),
              HasSubstr("cam.yaml:5: key 'image_width' for the second"));
  EXPECT_THAT(Refusal(Changed(kRos, "plumb_bob", "equidistant")),
              HasSubstr("distortion_model is 'equidistant'"));
  EXPECT_THAT(Refusal("<?xml version=\"1.0\"?>\n<opencv_storage>"), HasSubstr("cam.yaml: not XML at byte"));
  EXPECT_THAT(Refusal("<camera/>"), HasSubstr("XML without 'opencv_storage'"));
}

TEST(CameraIo, DamagedFilesAreReadOrRefused) {
  testing::ExpectSurvivesDamage(kOpenCv, 200, 500,
                                [](const std::string& text) { CameraFromText(text, "cam.yaml"); });
  testing::ExpectSurvivesDamage(std::string(100'000, '['), 5, 0,
                                [](const std::string& text) { CameraFromText("data: " + text, "cam.yaml"); });
}

TEST(CameraIo, APortFileGivesDistanceThicknessAndNormal) {
  const TempDir dir;
  const auto file = dir / "port.json";
  const auto read = [&](const std::string& rest) {
    testing::WriteFile(file, "{\"format\": \"sonar-port/1\", \"distance_m\": 0.02, " + rest + "}");
    return ReadFlatPort(file);
  };
  const FlatPort port = read("\"thickness_m\": 0.008, \"normal\": [0, 0.3, 0.4]");
  EXPECT_EQ(port.distance_m, 0.02);
  EXPECT_EQ(port.thickness_m, 0.008);
  EXPECT_EQ(port.water_index, 1.333);
  EXPECT_LT((port.normal - Eigen::Vector3d(0.0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_THAT(MessageOf([&] { read("\"thickness_m\": -0.008"); }), HasSubstr("thickness_m"));
  EXPECT_THAT(MessageOf([&] { read("\"thickness_m\": 0.01, \"water_index\": 0.9"); }),
              HasSubstr("water_index"));
  EXPECT_THAT(MessageOf([&] { read("\"thickness_m\": 0.01, \"normal\": [0, 0, -1]"); }),
              HasSubstr("sideways or backwards"));
  EXPECT_THAT(MessageOf([&] { read("\"thickness_m\": 0.01, \"normal\": [0, 0, 0]"); }),
              HasSubstr("sideways or backwards"));
  EXPECT_THAT(MessageOf([&] { read("\"thickness_m\": 0.01, \"index\": 1.3"); }),
              HasSubstr("unknown key 'index'"));
}

TEST(CameraIo, AMountFileGivesThePoseAndItsUncertainty) {
  const TempDir dir;
  const auto file = dir / "mount.json";
  const auto read = [&](const std::string& pose) {
    testing::WriteFile(file, "{\"format\": \"sonar-mount/1\", " + pose + "}");
    return ReadCameraMount(file);
  };
  const std::string pose = "{\"position_m\": [1, 2, 3], \"quaternion_wxyz\": [0, 1, 0, 0]}";
  const CameraMount mount =
      read("\"camera_from_sonar\": " + pose + ", \"sigma\": {\"position_m\": 0.002, \"angle_deg\": 0.5}");
  EXPECT_EQ(mount.camera_from_sonar.position_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(mount.sigma_position_m, 0.002);
  EXPECT_DOUBLE_EQ(mount.sigma_angle_rad, RadFromDeg(0.5));
  // The mount of a trajectory is another thing.
  EXPECT_THAT(MessageOf([&] { read("\"body_from_sonar\": " + pose); }), HasSubstr("camera_from_sonar"));
}

}  // namespace
}  // namespace sonarcal::data_io
