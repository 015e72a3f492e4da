// `sonarcal export` as a user runs it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::commands {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;

constexpr const char* kParameters = R"({"format": "sonar-parameters/1", "model": "acoustic",
  "display": {"db_min": 60, "db_max": 120}, "water": {"temperature_c": 12, "salinity_ppt": 33, "ph": 8, "depth_m": 5},
  "materials": {"floor": {"gsab": {"A": 0.1, "B_deg": 4, "C": 0.01, "D": 1, "E": 0.02, "F_deg": 8}}},
  "receiver": {"noise_db": 70, "time_varied_gain": "20logR"}})";

class ExportCommandTest : public ::testing::Test {
 protected:
  ExportCommandTest() {
    testing::WriteFile(dir_ / "p.json", kParameters);
    RecordingInfo info;
    info.source = "made up";
    info.sonar = {.name = "made up",
                  .frequency_hz = 9e5,
                  .axes = {.range_min_m = 1.0, .range_max_m = 3.0, .range_bins = 40, .beam_azimuth_rad = {}},
                  .azimuth_beam_width_deg = 1.0,
                  .elevation_beam_width_deg = 20.0,
                  .sound_speed_m_per_s = 1480.0};
    for (int beam = 0; beam < 20; ++beam) info.sonar.axes.beam_azimuth_rad.push_back(0.03 * (beam - 9.5));
    info.synthetic = true;
    std::vector<Frame> frames;
    for (int i = 0; i < 3; ++i) {
      frames.push_back(
          {{.name = "", .time_s = 5.0 + i, .world_from_sonar = {}},
           {info.sonar.axes, info.scale, Grid<float>(40, 20, 10.0F * static_cast<float>(i + 1))}});
    }
    data_io::WriteRecording(MemoryRecording(info, std::move(frames)), dir_ / "rec");
  }

  static Outcome Export(const std::string& arguments) { return RunSonarcal("export " + arguments); }
  std::string Out(const std::string& name) const { return " --out " + Quoted(dir_ / name); }

  testing::TempDir dir_;
};

TEST_F(ExportCommandTest, EverySimulatorGetsItsFileAndItsAccount) {
  for (const char* to : {"dave", "dave-ros2", "holoocean", "stonefish", "oceansim", "gazebo"}) {
    const std::string name = fmt::format("{}.cfg", to);
    const Outcome outcome =
        Export(fmt::format("--to {} --params {} --sonar p900-45{}", to, Quoted(dir_ / "p.json"), Out(name)));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(name + ".account.json says which"));
    EXPECT_THAT(outcome.err, HasSubstr("not expressed: receiver.time_varied_gain"));
    EXPECT_FALSE(testing::ReadFile(dir_ / name).empty());
    const auto account = nlohmann::json::parse(testing::ReadFile(dir_ / (name + ".account.json")));
    EXPECT_EQ(account.at("to"), to);
    EXPECT_EQ(account.at("parameters").size(),
              account.at("exported").get<std::size_t>() + account.at("approximated").get<std::size_t>() +
                  account.at("not_expressed").get<std::size_t>() + account.at("unused").get<std::size_t>());
    EXPECT_EQ(account.at("provenance").at("command"), "export");
  }
  EXPECT_TRUE(std::filesystem::exists(dir_ / "dave_reflectivity.csv"));
}

TEST_F(ExportCommandTest, AWorldHoldsTheGivenSceneAsOneMeshPerMaterial) {
  testing::WriteFile(dir_ / "s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl floor\nf 1 2 3\n");
  const std::string arguments = fmt::format(" --params {} --sonar p900-45 --scene {} --scene-unit m",
                                            Quoted(dir_ / "p.json"), Quoted(dir_ / "s.obj"));
  const struct {
    const char* to;
    const char* world;
  } targets[] = {
      {"stonefish", "stonefish.xml"}, {"gazebo", "gazebo_world.sdf"}, {"dave-ros2", "dave-ros2_world.sdf"}};
  for (const auto& [to, world] : targets) {
    const Outcome outcome = Export(fmt::format("--to {}{}{}", to, arguments, Out(fmt::format("{}.xml", to))));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string mesh = fmt::format("{}_floor.obj", to);
    EXPECT_THAT(testing::ReadFile(dir_ / world), HasSubstr(mesh));
    EXPECT_THAT(testing::ReadFile(dir_ / mesh), HasSubstr("f 1//1 2//1 3//1"));
  }
}

TEST_F(ExportCommandTest, ARecordingGivesTheSonar) {
  const Outcome outcome = Export(fmt::format("--to oceansim --quiet --params {} --recording {}{}",
                                             Quoted(dir_ / "p.json"), Quoted(dir_ / "rec"), Out("o.json")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto config = nlohmann::json::parse(testing::ReadFile(dir_ / "o.json"));
  EXPECT_NEAR(config.at("ImagingSonarSensor").at("range_res").get<double>(), 0.05, 1e-12);
}

TEST_F(ExportCommandTest, ExportedRecordingsReadBackInEveryFormat) {
  for (const char* name : {"a.bag", "a.npz", "a.mp4", "a.mcap", "fans"}) {
    const std::string to = std::string(name) == "a.bag"  ? "rosbag1"
                           : std::string(name) == "fans" ? "png"
                                                         : std::string(name).substr(2);
    const Outcome outcome =
        Export(fmt::format("--to {} --recording {} --frames 1:3{}", to, Quoted(dir_ / "rec"), Out(name)));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("2 frames (synthetic)"));
    if (to == "npz") continue;  // read by NumPy in data_io_exports_test
    const auto read = data_io::OpenRecording(dir_ / name);
    EXPECT_EQ(read->frame_count(), 2) << name;
    const bool states_origin = to != "rosbag1";
    EXPECT_EQ(read->info().synthetic, states_origin) << name;
    EXPECT_NEAR(read->ReadFrame(0).image.value(20, 10), 20.0, 3.0) << name;  // MPEG-4 loses some
  }
  EXPECT_TRUE(std::filesystem::exists(dir_ / "a.bag.provenance.json"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "fans" / "provenance.json"));
}

TEST_F(ExportCommandTest, OnlyAFolderOfPicturesMayEndInASlash) {
  const std::string recording = " --recording " + Quoted(dir_ / "rec");
  const Outcome pictures = Export("--to png" + recording + Out("pictures/"));
  EXPECT_EQ(pictures.status, 0) << pictures.err;
  EXPECT_THAT(pictures.err, HasSubstr("not in pictures: the times of the frames"));
  EXPECT_EQ(data_io::OpenRecording(dir_ / "pictures")->frame_count(), 3);
  const Outcome file = Export("--to npz" + recording + Out("file/"));
  EXPECT_EQ(file.status, 2);
  EXPECT_THAT(file.err, HasSubstr("expected the name of a file"));
}

TEST_F(ExportCommandTest, AnMcapFileHoldsTheGivenScene) {
  testing::WriteFile(dir_ / "s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl floor\nf 1 2 3\n");
  const std::string arguments = "--to mcap --recording " + Quoted(dir_ / "rec") + Out("a.mcap");
  const Outcome outcome = Export(arguments + " --scene " + Quoted(dir_ / "s.obj") + " --scene-unit m");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Outcome inspected = RunSonarcal("inspect " + Quoted(dir_ / "a.mcap"));
  EXPECT_THAT(inspected.out, HasSubstr("visualization_msgs/MarkerArray, 1 message"));
  EXPECT_THAT(inspected.out, HasSubstr("SYNTHETIC"));
}

TEST_F(ExportCommandTest, AnMcapFileHoldsTheCalibrationOfTheSonar) {
  const Outcome outcome = Export("--to mcap --recording " + Quoted(dir_ / "rec") + " --params " +
                                 Quoted(dir_ / "p.json") + Out("a.mcap"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto read = data_io::OpenRecording(dir_ / "a.mcap");
  EXPECT_EQ(read->info().sonar.name, "made up");
  EXPECT_NEAR(*read->info().scale.db_min, 60.0, 1e-4);
  EXPECT_NEAR(*read->info().scale.db_max, 120.0, 1e-4);
  EXPECT_EQ(read->info().settings.time_varied_gain, true);
  EXPECT_THAT(read->info().details,
              ::testing::Contains(::testing::Pair("calibration", ::testing::StartsWith("p.json sha256:"))));
}

TEST_F(ExportCommandTest, ContradictoryOptionsAreRefusedInOneSentence) {
  const std::string params = " --params " + Quoted(dir_ / "p.json");
  const std::string recording = " --recording " + Quoted(dir_ / "rec");
  const struct {
    std::string arguments;
    int status;
    std::string sentence;
  } mistakes[] = {
      {"--to dave" + Out("x"), 2, "--to dave needs --params"},
      {"--to dave" + params + Out("x"), 2, "needs either --sonar or --recording"},
      {"--to dave --sonar p900-45" + params + recording + Out("x"), 2, "needs either --sonar or --recording"},
      {"--to npz" + Out("x"), 2, "--to npz needs --recording"},
      {"--to npz" + params + recording + Out("x"), 2, "--params is given with --to npz"},
      {"--to npz --sonar p900-45" + recording + Out("x"), 2, "--sonar is given with --to npz"},
      {"--to mcap --sonar p900-45" + recording + Out("x"), 1, "range bins"},
      {"--to npz --scene x.gltf" + recording + Out("x"), 2, "--scene is given with --to npz"},
      {"--to dave --sonar p900-45 --scene x.gltf" + params + Out("x"), 2, "--scene is given with --to dave"},
      {"--to npz --fps 3" + recording + Out("x"), 2, "--fps is given with --to npz"},
      {"--to mp4" + recording + Out("x.avi"), 2, "ends in .mp4"},
      {"--to word" + recording + Out("x"), 2, "expected dave|dave-ros2|holoocean"},
      {"--to dave --sonar nobody" + params + Out("x"), 2, "nobody"},
      {"--to npz --recording " + Quoted(dir_ / "absent") + Out("x"), 1, "absent"},
      {"--to npz --frames 2:9" + recording + Out("x"), 1, "frames 2:9"},
  };
  for (const auto& mistake : mistakes) {
    const Outcome outcome = Export(mistake.arguments);
    EXPECT_EQ(outcome.status, mistake.status) << mistake.arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(mistake.sentence));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "x")) << mistake.arguments;
  }
}

// A file of the user, an input, and the frame of a recording.
TEST_F(ExportCommandTest, WhatNoExportWroteIsNotReplaced) {
  testing::WriteFile(dir_ / "thesis.txt", "mine");
  const std::string npz = "--to npz --recording " + Quoted(dir_ / "rec");
  const Outcome refused = Export(npz + Out("thesis.txt"));
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("thesis.txt: exists, and no earlier run of this command wrote it"));
  EXPECT_EQ(testing::ReadFile(dir_ / "thesis.txt"), "mine");
  const std::string frame = testing::ReadFile(dir_ / "rec/frame_0000.png");
  const Outcome of_input = Export(npz + Out("rec/frame_0000.png") + " --force");
  EXPECT_EQ(of_input.status, 2);
  EXPECT_THAT(of_input.err, HasSubstr("which this command reads"));
  EXPECT_EQ(testing::ReadFile(dir_ / "rec/frame_0000.png"), frame);
  const std::string dave = "--to dave --sonar p900-45 --params " + Quoted(dir_ / "p.json");
  const Outcome input = Export(dave + Out("p.json") + " --force");
  EXPECT_EQ(input.status, 2);
  EXPECT_THAT(input.err, HasSubstr("which this command reads"));
  EXPECT_EQ(testing::ReadFile(dir_ / "p.json"), kParameters);
  EXPECT_EQ(Export(npz + Out("thesis.txt") + " --force").status, 0);
  EXPECT_EQ(Export(npz + Out("thesis.txt")).status, 0) << "its own file";
  const std::filesystem::path folder = dir_ / "rec";
  for (const std::filesystem::path& read : {folder, folder / "recording.json", dir_ / "only"}) {
    if (read.filename() == "only") {
      std::filesystem::create_directory(read);
      std::filesystem::create_directory_symlink(folder, read / "link");
    }
    const Outcome converted = RunSonarcal("convert " + Quoted(read) + " --out " + Quoted(folder));
    EXPECT_EQ(converted.status, 2) << read;
    EXPECT_THAT(converted.err, HasSubstr("which this command reads")) << read;
  }
}

}  // namespace
}  // namespace sonarcal::commands
