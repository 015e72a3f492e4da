#include "data_io/sonars/neusis_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/pickle_builder.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::json;
using Eigen::Vector3d;
using testing::ArrayValue;
using ::testing::Contains;
using testing::DictOf;
using testing::DtypeValue;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::RefusalOf;
using testing::Str;
using testing::TempDir;

template <typename T>
std::string BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string Shape(int rows, int cols) {
  return {'K', static_cast<char>(rows), 'K', static_cast<char>(cols), '\x86'};
}

// 3 ranges x 2 beams.
const std::vector<std::uint8_t> kGrey = {0, 10, 20, 30, 40, 255};
// The sonar at (1, 2, 3) looks along world Y, its left side to -X.
const std::vector<float> kPose = {0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1};

std::string ImageItem(const std::string& array) {
  return Str("ImagingSonar") + array;
}
std::string GreyItem() {
  return ImageItem(ArrayValue(Shape(3, 2), DtypeValue("u1", "|"), BytesOf(kGrey)));
}
std::string PoseItem(const std::vector<float>& pose = kPose) {
  return Str("PoseSensor") + ArrayValue(Shape(4, 4), DtypeValue("f4"), BytesOf(pose));
}

Json Sonar() {
  return {{"RangeMin", 0.5}, {"RangeMax", 3.5}, {"Azimuth", 60.0}, {"Elevation", 12.0}};
}

// As HoloOcean has it, without the keys that are not read.
Json Config() {
  const Json pose = {{"sensor_type", "PoseSensor"}, {"socket", "SonarSocket"}, {"rotation", {0, 45, 0}}};
  const Json sonar = {{"sensor_type", "ImagingSonar"},
                      {"socket", "SonarSocket"},
                      {"rotation", {0, 45, 0}},
                      {"configuration", Sonar()}};
  return {{"world", "SimpleUnderwater"},
          {"agents", {{{"sensors", {{{"sensor_type", "DepthSensor"}}, pose, sonar}}}}}};
}

class NeusisTest : public ::testing::Test {
 protected:
  NeusisTest() {
    WriteConfig(Config());
    WritePickle("000.pkl", PoseItem() + GreyItem());
  }

  void WriteConfig(const Json& config) { testing::WriteFile(dir_ / "Config.json", config.dump()); }
  void WritePickle(const std::string& name, const std::string& items) {
    testing::WriteFile(dir_ / name, DictOf(items));
  }
  std::string RefusalOfItems(const std::string& items) {
    WritePickle("000.pkl", items);
    return RefusalOf(dir_.path());
  }
  std::vector<std::string> Notes() { return OpenRecording(dir_.path())->info().notes; }

  TempDir dir_;
};

TEST_F(NeusisTest, AFrameHasItsAxesImageAndPose) {
  const auto recording = OpenRecording(dir_.path());
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.format, "NeuSIS pickles");
  EXPECT_EQ(info.sonar.axes.range_min_m, 0.5);
  EXPECT_EQ(info.sonar.axes.range_max_m, 3.5);
  EXPECT_EQ(info.sonar.axes.range_bins, 3);
  ASSERT_EQ(info.sonar.axes.beam_count(), 2);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad[0]), -15.0, 1e-12);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad[1]), 15.0, 1e-12);
  EXPECT_EQ(info.sonar.elevation_beam_width_deg, 12.0);
  EXPECT_EQ(info.scale.full_scale, 255.0);
  ASSERT_EQ(recording->frame_count(), 1);
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.info.name, "000.pkl");
  EXPECT_FALSE(frame.info.time_s);
  // Column 0 of the pickle is the rightmost beam.
  EXPECT_THAT(frame.image.value.values(), ::testing::ElementsAre(10, 0, 30, 20, 255, 40));
  ASSERT_TRUE(frame.info.world_from_sonar);
  const Pose& pose = *frame.info.world_from_sonar;
  EXPECT_TRUE((pose * Vector3d(0, 0, 0)).isApprox(Vector3d(1, 2, 3), 1e-9));
  EXPECT_TRUE((pose * Vector3d(0, 1, 0)).isApprox(Vector3d(1, 3, 3), 1e-9));  // ahead
  EXPECT_TRUE((pose * Vector3d(1, 0, 0)).isApprox(Vector3d(2, 2, 3), 1e-9));  // right
  EXPECT_TRUE((pose * Vector3d(0, 0, 1)).isApprox(Vector3d(1, 2, 4), 1e-9));  // up
}

TEST_F(NeusisTest, PicklesInTheFolderDataAndASinglePickleOpen) {
  std::filesystem::create_directory(dir_ / "Data");
  std::filesystem::rename(dir_ / "000.pkl", dir_ / "Data/10.pkl");
  WritePickle("Data/9.pkl", GreyItem());
  testing::WriteFile(dir_ / "Data/notes.txt", "none");
  for (const auto& path : {dir_.path(), dir_ / "Data", dir_ / "Data/"}) {
    const auto recording = OpenRecording(path);
    ASSERT_EQ(recording->frame_count(), 2) << path;
    EXPECT_EQ(recording->frame_info(0).name, "9.pkl");  // in natural order
    EXPECT_FALSE(recording->frame_info(0).world_from_sonar);
    EXPECT_TRUE(recording->frame_info(1).world_from_sonar);
  }
  EXPECT_EQ(OpenRecording(dir_ / "Data/10.pkl")->frame_count(), 1);
  std::filesystem::remove(dir_ / "Config.json");
  EXPECT_THAT(RefusalOf(dir_.path()), HasSubstr("not a recording of a known format"));
  EXPECT_THAT(RefusalOf(dir_ / "Data/10.pkl"), HasSubstr("Config.json, .pkl"));
}

TEST_F(NeusisTest, APickleOpensByItsNameAlone) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directory(dir_ / "Data");
  WritePickle("Data/1.pkl", GreyItem());
  for (const std::string folder : {"", "Data"}) {
    std::filesystem::current_path(dir_ / folder);
    EXPECT_EQ(RefusalOf(folder.empty() ? "000.pkl" : "1.pkl"), "") << folder;
    EXPECT_EQ(RefusalOf("."), "") << folder;
  }
  std::filesystem::current_path(before);
}

TEST_F(NeusisTest, OnlyAWorldOfTheSimulatorMakesARecordingSynthetic) {
  const auto recording = OpenRecording(dir_.path());
  EXPECT_TRUE(recording->info().synthetic);
  EXPECT_THAT(recording->info().details, Contains(std::pair<std::string, std::string>(
                                             "simulation", "HoloOcean, world SimpleUnderwater")));
  Json config = Config();
  config.erase("world");
  WriteConfig(config);
  EXPECT_FALSE(OpenRecording(dir_.path())->info().synthetic);
  EXPECT_THAT(Notes(), Contains(HasSubstr("whether a sonar or a simulation")));
  WriteConfig(Sonar());  // without agents and sensors
  EXPECT_FALSE(OpenRecording(dir_.path())->info().synthetic);
  EXPECT_EQ(OpenRecording(dir_.path())->info().sonar.axes.range_max_m, 3.5);
}

TEST_F(NeusisTest, ImagesOfEveryTypeBecomeGreyLevels) {
  WritePickle("000.pkl",
              ImageItem(ArrayValue(Shape(2, 2), DtypeValue("f4"), BytesOf<float>({0.0F, 0.5F, 1.0F, 1.5F}))));
  auto recording = OpenRecording(dir_.path());
  EXPECT_EQ(recording->info().scale.full_scale, 65535.0);
  EXPECT_THAT(recording->ReadFrame(0).image.value.values(), ::testing::ElementsAre(32768, 0, 65535, 65535));
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("1 of 4 samples of the first image are above 1")));
  WritePickle("000.pkl", ImageItem(ArrayValue(Shape(2, 2), DtypeValue("f8"),
                                              BytesOf<double>({0.25, 0.0, 0.0, 0.0}), true)));
  EXPECT_EQ(OpenRecording(dir_.path())->ReadFrame(0).image.value(0, 1), 16384.0F);
  WritePickle("000.pkl", ImageItem(ArrayValue(Shape(2, 2), DtypeValue("u2", ">"),
                                              std::string("\0\1\1\0\xff\xff\0\0", 8))));
  recording = OpenRecording(dir_.path());
  EXPECT_EQ(recording->info().scale.full_scale, 65535.0);
  EXPECT_THAT(recording->ReadFrame(0).image.value.values(), ::testing::ElementsAre(256, 1, 0, 65535));
}

TEST_F(NeusisTest, WhatTheConfigurationLeavesOpenIsNoted) {
  EXPECT_THAT(Notes(), Not(Contains(HasSubstr("mounts"))));
  EXPECT_THAT(Notes(), Not(Contains(HasSubstr("bins"))));
  Json config = Config();
  Json& sonar = config["agents"][0]["sensors"][2];
  sonar["rotation"] = {0, 30, 0};
  sonar["configuration"]["RangeBins"] = 512;
  sonar["configuration"]["AzimuthBins"] = 2;
  WriteConfig(config);
  EXPECT_THAT(Notes(), Contains(HasSubstr("mounts PoseSensor and ImagingSonar differently")));
  EXPECT_THAT(Notes(), Contains(HasSubstr("states 512 x 2 bins, but the first image has 3 x 2")));
  WritePickle("000.pkl", GreyItem());
  EXPECT_THAT(Notes(), Contains(HasSubstr("has no PoseSensor")));
}

TEST_F(NeusisTest, RefusesWhatIsNoFrame) {
  EXPECT_THAT(RefusalOfItems(PoseItem()),
              HasSubstr("no array 'ImagingSonar', expected one; the dict has PoseSensor"));
  EXPECT_THAT(RefusalOfItems(""), HasSubstr("the dict has no key"));
  const auto image = [&](const std::string& array) { return RefusalOfItems(PoseItem() + ImageItem(array)); };
  EXPECT_THAT(image(ArrayValue(Shape(2, 1), DtypeValue("u1"), "12")),
              HasSubstr("is 2 x 1, expected ranges x beams"));
  EXPECT_THAT(image(ArrayValue("K\x04\x85", DtypeValue("u1"), "1234")), HasSubstr("is 4, expected"));
  EXPECT_THAT(image(ArrayValue(Shape(2, 2), DtypeValue("i1"), "1234")), HasSubstr("type int8"));
  for (const float value : {-0.5F, std::nanf(""), INFINITY}) {
    EXPECT_THAT(image(ArrayValue(Shape(2, 2), DtypeValue("f4"), BytesOf<float>({0, value, 0, 0}))),
                HasSubstr("expected 0 or more"));
  }
  const auto pose = [&](std::size_t place, float value) {
    std::vector<float> changed = kPose;
    changed[place] = value;
    return RefusalOfItems(PoseItem(changed) + GreyItem());
  };
  EXPECT_THAT(pose(10, -1.0F), HasSubstr("not a rotation"));  // mirrored
  EXPECT_THAT(pose(0, 0.1F), HasSubstr("not a rotation"));
  EXPECT_THAT(pose(15, 0.0F), HasSubstr("not a rotation"));
  EXPECT_THAT(pose(3, std::nanf("")), HasSubstr("not a rotation"));
  EXPECT_EQ(pose(3, 100.0F), "");
  EXPECT_THAT(
      RefusalOfItems(Str("PoseSensor") + ArrayValue(Shape(2, 2), DtypeValue("u1"), "1234") + GreyItem()),
      HasSubstr("PoseSensor is 2 x 2 uint8"));
}

TEST_F(NeusisTest, RefusesSettingsOutsideTheirDomain) {
  const auto refusal = [&](const std::string& key, const Json& value) {
    Json sonar = Sonar();
    if (value.is_null()) {
      sonar.erase(key);
    } else {
      sonar[key] = value;
    }
    WriteConfig(sonar);
    return RefusalOf(dir_.path());
  };
  EXPECT_THAT(refusal("RangeMin", nullptr), HasSubstr("RangeMin"));
  EXPECT_THAT(refusal("RangeMin", 4.0), HasSubstr("range window"));
  EXPECT_THAT(refusal("RangeMax", -1.0), HasSubstr("RangeMax"));
  EXPECT_THAT(refusal("Azimuth", 0.0), HasSubstr("Azimuth"));
  EXPECT_THAT(refusal("Elevation", "high"), HasSubstr("Elevation"));
  EXPECT_THAT(refusal("RangeBins", 1e9), HasSubstr("RangeBins"));
  EXPECT_EQ(refusal("Elevation", nullptr), "");
  WriteConfig({{"agents", Json::array()}});
  EXPECT_THAT(RefusalOf(dir_.path()), HasSubstr("no sensor of type ImagingSonar"));
}

TEST_F(NeusisTest, HostileFilesEndInDataError) {
  testing::ExpectOnlyDataErrors(dir_.path(), dir_ / "000.pkl", testing::ReadFile(dir_ / "000.pkl"), 300);
  testing::ExpectOnlyDataErrors(dir_.path(), dir_ / "Config.json", Config().dump(), 300);
}

TEST(NeusisSample, HoldsSixSyntheticFrames) {
  SONARCAL_NEEDS_RECORDING(folder, "neusis_pickles");
  const auto recording = OpenRecording(folder);
  const RecordingInfo& info = recording->info();
  EXPECT_TRUE(info.synthetic);
  ASSERT_EQ(recording->frame_count(), 6);
  EXPECT_EQ(info.sonar.axes.range_bins, 256);
  EXPECT_EQ(info.sonar.axes.range_min_m, 0.01);
  EXPECT_EQ(info.sonar.axes.range_max_m, 3.3);
  EXPECT_EQ(info.sonar.axes.beam_count(), 96);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad[0]), -29.6875, 1e-9);
  EXPECT_NEAR(info.sonar.elevation_beam_width_deg, 12.0, 1e-9);
  EXPECT_THAT(info.notes, Not(Contains(HasSubstr("mounts"))));

  // From Python's pickle and NumPy 1.24.
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.info.name, "000.pkl");
  const auto values = frame.image.value.values();
  EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0), 65922.0);
  EXPECT_EQ(*std::ranges::max_element(values), 159.0F);
  ASSERT_TRUE(frame.info.world_from_sonar);
  EXPECT_TRUE(frame.info.world_from_sonar->position_m.isApprox(Vector3d(-2.2461, 0.18093, 0.0222), 1e-4));
}

// Azimuth shift in radians that maps image `a` best on image `b`: least squares over steps of a twentieth of
// a beam.
double AzimuthShiftRad(const PolarImage& a, const PolarImage& b) {
  const int beams = a.axes.beam_count();
  double best = 0.0;
  double least = INFINITY;
  for (int step = -60; step <= 60; ++step) {
    const double shift = step / 20.0;
    double sum = 0.0;
    for (int row = 0; row < a.axes.range_bins; ++row) {
      for (int col = 3; col < beams - 4; ++col) {
        const double from = col - shift;
        const int left = static_cast<int>(std::floor(from));
        const double part = from - left;
        const double value = (1.0 - part) * a.value(row, left) + part * a.value(row, left + 1);
        sum += (value - b.value(row, col)) * (value - b.value(row, col));
      }
    }
    if (sum < least) {
      least = sum;
      best = shift;
    }
  }
  return best * a.axes.beam_spacing_rad();
}

// Point at the mean range of the echoes, straight ahead.
Vector3d MeanEchoM(const PolarImage& image) {
  double weight = 0.0;
  double sum_m = 0.0;
  for (int row = 0; row < image.axes.range_bins; ++row) {
    for (const float value : image.value.row(row)) {
      weight += value;
      sum_m += value * image.axes.range_centre_m(row);
    }
  }
  return {0.0, sum_m / weight, 0.0};
}

// The six frames show one object at rest. From frame to frame the sonar moves by up to 16 mm along its
// columns, so the object moves in the images. If left and right were exchanged, it would move the other way.
TEST(NeusisSample, TheObjectMovesInTheImagesAsThePosesSay) {
  SONARCAL_NEEDS_RECORDING(folder, "neusis_pickles");
  const auto recording = OpenRecording(folder);
  std::vector<double> predicted_rad;
  std::vector<double> measured_rad;
  std::vector<double> of_inverse_rad;  // predicted if the file held sonar from world
  for (int i = 0; i < recording->frame_count(); ++i) {
    for (int j = i + 1; j < recording->frame_count(); ++j) {
      const Frame a = recording->ReadFrame(i);
      const Frame b = recording->ReadFrame(j);
      const Vector3d echo_m = MeanEchoM(a.image);
      const Vector3d seen_m = b.info.world_from_sonar->Inverse() * (*a.info.world_from_sonar * echo_m);
      predicted_rad.push_back(std::atan2(seen_m.x(), seen_m.y()));
      measured_rad.push_back(AzimuthShiftRad(a.image, b.image));
      // Axes of the file: X ahead, Y left, Z up.
      const Eigen::Quaterniond file_from_sonar(Eigen::AngleAxisd(kPi / 2.0, Vector3d::UnitZ()));
      const auto in_file = [&](const Frame& frame) {
        return *frame.info.world_from_sonar * Pose{file_from_sonar.conjugate(), Vector3d::Zero()};
      };
      const Vector3d otherwise_m = in_file(b) * (in_file(a).Inverse() * (file_from_sonar * echo_m));
      of_inverse_rad.push_back(-std::atan2(otherwise_m.y(), otherwise_m.x()));
    }
  }
  const auto product = [](const std::vector<double>& x, const std::vector<double>& y) {
    return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
  };
  const double correlation =
      product(predicted_rad, measured_rad) /
      std::sqrt(product(predicted_rad, predicted_rad) * product(measured_rad, measured_rad));
  const auto largest_deg = [](const std::vector<double>& values_rad) {
    const auto [low, high] = std::ranges::minmax(values_rad);
    return DegFromRad(std::max(-low, high));
  };
  EXPECT_GT(correlation, 0.9);  // 0.92; the mirror image has the opposite sign
  EXPECT_LT(largest_deg(predicted_rad), 0.5);
  EXPECT_LT(largest_deg(measured_rad), 1.0);
  EXPECT_GT(largest_deg(of_inverse_rad), 8.0);
}

// The nearest row is row 0: water up to a sharp edge, the object behind it. The edge is nearest while the
// sonar passes the object's middle, because all frames look along world X.
TEST(NeusisSample, TheNearestRowIsTheFirst) {
  SONARCAL_NEEDS_RECORDING(folder, "neusis_pickles");
  const auto recording = OpenRecording(folder);
  std::vector<int> first_rows;
  for (int i = 0; i < recording->frame_count(); ++i) {
    const PolarImage image = recording->ReadFrame(i).image;
    int row = 0;
    while (std::ranges::none_of(image.value.row(row), [](float value) { return value >= 60.0F; })) ++row;
    first_rows.push_back(row);
  }
  EXPECT_THAT(first_rows, ::testing::ElementsAre(121, 120, 120, 120, 120, 120));
}

}  // namespace
}  // namespace sonarcal::data_io
