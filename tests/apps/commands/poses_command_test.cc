#include "apps/commands/poses_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/images/image_io.h"
#include "data_io/pose_io.h"
#include "data_io/trajectory_io.h"
#include "tests/support/marker_field_files.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::commands {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::ReadFile;
using testing::TempDir;
using testing::WriteFile;

// One field, rendered once for all tests: six pictures through a port, then one of nothing and one cut short.
class PosesCommandTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    field_ = new TempDir;
    testing::WriteFieldFiles(field_->path(), {}, true);
    data_io::WritePng(field_->path() / "images/1700000000600000.png", Grid<std::uint8_t>(480, 640, 128));
    const std::string bytes = ReadFile(field_->path() / "images/1700000000000000.png");
    WriteFile(field_->path() / "images/1700000000700000.png", bytes.substr(0, bytes.size() / 2));
  }
  static void TearDownTestSuite() { delete field_; }

  PosesOptions Options() const {
    PosesOptions options;
    options.common.quiet = true;
    options.images = field_->path() / "images";
    options.camera = field_->path() / "camera.yaml";
    options.markers = field_->path() / "markers.json";
    options.mount = field_->path() / "mount.json";
    options.port = field_->path() / "port.json";
    options.out = dir_ / "out";
    return options;
  }
  nlohmann::json Result() const { return nlohmann::json::parse(ReadFile(dir_ / "out/marker_poses.json")); }

  static TempDir* field_;
  TempDir dir_;
};

TempDir* PosesCommandTest::field_ = nullptr;

TEST_F(PosesCommandTest, FindsThePosesAndReportsFramesWithoutOne) {
  PosesOptions options = Options();
  options.pictures = true;
  EXPECT_EQ(RunPoses(options), cli::ExitStatus::kDone);
  const auto truth = data_io::ReadPoses(field_->path() / "true_poses.json");
  const auto found = data_io::ReadPosesOrRecording(dir_ / "out/poses.json");
  const auto csv = dir_ / "out/trajectory.csv";
  const auto trajectory = data_io::ReadTrajectory(csv, data_io::GuessTrajectoryFormat(csv));
  const nlohmann::json result = Result();
  ASSERT_EQ(found.size(), truth.size());
  ASSERT_EQ(trajectory.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(*found[i].time_s, *truth[i].time_s, 1e-6);
    EXPECT_NEAR(trajectory[i].time_s, *truth[i].time_s, 1e-6);
    const Eigen::Vector3d error_m =
        found[i].world_from_sonar.position_m - truth[i].world_from_sonar.position_m;
    const double sigma_m = result["frames"][i]["sigma_position_m"];
    EXPECT_LT(sigma_m, 0.001);
    EXPECT_LT(error_m.norm(), 4.0 * sigma_m);
    EXPECT_LT((trajectory[i].world_from_body.position_m - found[i].world_from_sonar.position_m).norm(),
              1e-12);
    EXPECT_LT(found[i].world_from_sonar.rotation.angularDistance(truth[i].world_from_sonar.rotation), 0.001);
    EXPECT_TRUE(fs::exists(dir_ / ("out/markers_000" + std::to_string(i) + ".png")));
  }
  EXPECT_EQ(result["frames"].size(), 8U);
  EXPECT_EQ(result["frames"][6]["refused"], "no marker of the map is seen");
  EXPECT_THAT(result["frames"][7]["refused"], HasSubstr("damaged PNG"));
  EXPECT_THAT(result["refraction"], HasSubstr("refraction at a flat port modelled (30 mm"));
  EXPECT_EQ(result["times"], "file names, in microseconds");
  EXPECT_EQ(result["frames"][0]["covariance"].size(), 6U);
  EXPECT_FALSE(fs::exists(dir_ / "out/markers.json"));
  EXPECT_TRUE(fs::exists(dir_ / "out/provenance.json"));
}

TEST_F(PosesCommandTest, WithoutAPortItSaysSo) {
  PosesOptions options = Options();
  options.port.clear();
  options.max_rms_px = 20.0;
  options.rate_hz = 4.0;
  EXPECT_EQ(RunPoses(options), cli::ExitStatus::kDone);
  EXPECT_EQ(Result()["refraction"], "no refraction modelled");
  EXPECT_EQ(Result()["frames"][2]["time_s"], 0.5);
  EXPECT_GT(Result()["noise_factor"], 5.0);
}

TEST_F(PosesCommandTest, AMapWithSigmasIsRefined) {
  PosesOptions options = Options();
  auto map = nlohmann::json::parse(ReadFile(options.markers));
  map["sigma"] = {{"position_m", 0.001}, {"angle_deg", 0.2}};
  options.markers = dir_ / "map.json";
  WriteFile(options.markers, map.dump());
  EXPECT_EQ(RunPoses(options), cli::ExitStatus::kDone);
  EXPECT_TRUE(fs::exists(dir_ / "out/markers.json"));
  const double sigma_m = Result()["frames"][0]["sigma_position_m"];
  EXPECT_GT(sigma_m, 0.0003);  // the map's error is in it
}

std::string FailureOf(const PosesOptions& options) {
  try {
    RunPoses(options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

TEST_F(PosesCommandTest, InvalidInputsAreRefusedInOneSentenceAndLeaveNoFile) {
  PosesOptions options = Options();
  options.images = dir_ / "empty";
  fs::create_directories(options.images);
  EXPECT_THAT(FailureOf(options), HasSubstr("expected images"));
  data_io::WritePng(options.images / "a.png", Grid<std::uint8_t>(480, 640, 128));
  EXPECT_THAT(FailureOf(options),
              HasSubstr("none of 1 images gives a pose; first image: no marker of the map"));
  data_io::WritePng(options.images / "a.png", Grid<std::uint8_t>(48, 64, 128));
  EXPECT_THAT(FailureOf(options), HasSubstr("64 x 48 pixels, expected the camera's 640 x 480"));
  options = Options();
  options.rate_hz = 1.0;
  options.time_unit = data_io::NameTimes::kMicroseconds;
  EXPECT_THAT(FailureOf(options), HasSubstr("expected one"));
  EXPECT_FALSE(fs::exists(dir_ / "out"));
}

// By the shell: status, JSON on stdout, help with units.
TEST_F(PosesCommandTest, RunsFromTheShell) {
  const auto run = [](const std::string& arguments) {
    std::string text;
    FILE* pipe = popen((std::string(SONARCAL_BINARY) + " poses " + arguments + " 2>&1").c_str(), "r");
    if (pipe == nullptr) return text;
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
    return text + "status " + std::to_string(pclose(pipe) / 256);
  };
  const std::string f = field_->path().string();
  const std::string text = run("--json --quiet --images " + f + "/images --camera " + f +
                               "/camera.yaml --markers " + f + "/markers.json --mount " + f +
                               "/mount.json --port " + f + "/port.json --out " + (dir_ / "out").string());
  EXPECT_THAT(text, HasSubstr("\"frames_with_pose\": 6"));
  EXPECT_THAT(text, HasSubstr("status 0"));
  EXPECT_THAT(run("--help"), HasSubstr("--max-rms"));
  EXPECT_THAT(run("--images " + f), HasSubstr("status 2"));
}

}  // namespace
}  // namespace sonarcal::commands
