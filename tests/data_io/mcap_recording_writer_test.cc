#include "data_io/bag_writers/mcap_recording_writer.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/bag_trajectory.h"
#include "data_io/mcap/mcap_writer.h"
#include "data_io/open_recording.h"
#include "data_io/ros/bag.h"
#include "data_io/ros/bag_recording.h"
#include "tests/data_io/refusal.h"
#include "tests/data_io/schema_decoder.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using testing::DecodedMessage;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

constexpr int kMcapBins = 40;
constexpr int kMcapBeams = 16;

MemoryRecording McapRecording(const ImageScale& scale, int frames = 3) {
  RecordingInfo info;
  info.source = "made up";
  info.scale = scale;
  info.sonar = {
      .name = "made up",
      .frequency_hz = 1.2e6,
      .axes = {.range_min_m = 1.0, .range_max_m = 3.0, .range_bins = kMcapBins, .beam_azimuth_rad = {}},
      .azimuth_beam_width_deg = 1.0,
      .elevation_beam_width_deg = 20.0,
      .sound_speed_m_per_s = 1480.0};
  for (int beam = 0; beam < kMcapBeams; ++beam)
    info.sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(2.0 * (beam - 7.5)));
  info.synthetic = true;
  std::vector<Frame> all;
  for (int i = 0; i < frames; ++i) {
    Frame frame{{.name = fmt::format("frame {}", i), .time_s = 100.25 + i, .world_from_sonar = {}},
                {info.sonar.axes, scale, Grid<float>(kMcapBins, kMcapBeams)}};
    for (int bin = 0; bin < kMcapBins; ++bin) {
      for (int beam = 0; beam < kMcapBeams; ++beam) {
        const double grey = (0.5 + bin + 3.0 * beam + i) / 120.0;
        frame.image.value(bin, beam) = static_cast<float>(
            scale.quantity == Quantity::kGrey ? std::floor(grey * scale.full_scale) : grey * 1e-3);
      }
    }
    frame.info.world_from_sonar =
        Pose{RotationFromYawPitchRoll(0.3 * i, -0.2, 0.1), Eigen::Vector3d(1.0 + i, -2.0, 0.5)};
    all.push_back(std::move(frame));
  }
  return {std::move(info), std::move(all)};
}

ImageScale McapGreyUpTo(double full_scale) {
  ImageScale scale;
  scale.full_scale = full_scale;
  return scale;
}

// Two triangles of different materials, one of them level.
Scene TwoTriangles() {
  Scene scene;
  scene.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  scene.material_names = {"floor", "unused", "wall"};
  scene.triangles = {{0, 1, 2}, {0, 1, 3}};
  scene.triangle_material = {0, 2};
  return scene;
}

class McapRecordingWriterTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const MemoryRecording& recording, const McapRecordingOptions& options = {}) {
    std::filesystem::remove(dir_ / "out.mcap");
    WriteMcapRecording(recording, options, "a test", dir_ / "out.mcap");
    return dir_ / "out.mcap";
  }
  static std::vector<DecodedMessage> Of(const testing::DecodedMcap& mcap, const std::string& topic) {
    std::vector<DecodedMessage> found;
    for (const DecodedMessage& message : mcap.messages) {
      if (message.topic == topic) found.push_back(message);
    }
    return found;
  }
  testing::TempDir dir_;
};

TEST_F(McapRecordingWriterTest, OurReaderFindsTheSame) {
  ImageScale power;
  power.quantity = Quantity::kPower;
  for (const ImageScale& scale : {McapGreyUpTo(255.0), McapGreyUpTo(65535.0), power}) {
    const MemoryRecording recording = McapRecording(scale);
    const auto path = Write(recording);
    EXPECT_THAT(Bag::Open(path)->notes(), IsEmpty());
    const auto read = OpenRecording(path);
    ASSERT_EQ(read->frame_count(), 3);
    EXPECT_TRUE(read->info().sonar.axes.Matches(recording.info().sonar.axes));
    EXPECT_EQ(read->info().scale.quantity, scale.quantity);
    EXPECT_TRUE(read->info().synthetic);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(read->ReadFrame(i).image.value, recording.ReadFrame(i).image.value);
      EXPECT_NEAR(*read->frame_info(i).time_s, 100.25 + i, 1e-6);
    }
    const auto poses = ReadBagTrajectory(path, {.topic = "/sonar/pose"});
    const auto transforms =
        ReadBagTrajectory(path, {.topic = "/tf", .world_frame = "map", .body_frame = "sonar"});
    ASSERT_EQ(poses.size(), 3U);
    ASSERT_EQ(transforms.size(), 3U);
    for (int i = 0; i < 3; ++i) {
      const Pose expected = *recording.frame_info(i).world_from_sonar;
      EXPECT_LT((poses[i].world_from_body.position_m - expected.position_m).norm(), 1e-12);
      EXPECT_LT(transforms[i].world_from_body.rotation.angularDistance(expected.rotation), 1e-7);
    }
  }
}

// Decodes every message by the definition in the file, to its last byte, as Foxglove does.
TEST_F(McapRecordingWriterTest, AReaderOfDefinitionsFindsImageFanPoseAndScene) {
  const MemoryRecording recording = McapRecording(McapGreyUpTo(255.0));
  const Scene scene = TwoTriangles();
  const auto mcap =
      testing::DecodeMcap(testing::ReadFile(Write(recording, {.scene = &scene, .fan_height_px = 50})));
  EXPECT_EQ(mcap.profile, "ros2");
  const PolarImage image = recording.ReadFrame(1).image;
  const auto projected = Of(mcap, "/sonar/image");
  ASSERT_EQ(projected.size(), 3U);
  EXPECT_EQ(projected[1].type, "marine_acoustic_msgs/msg/ProjectedSonarImage");
  EXPECT_EQ(projected[1].time_ns, 101'250'000'000U);
  EXPECT_EQ(projected[1].message.at("header").at("stamp"), Json({{"sec", 101}, {"nanosec", 250'000'000}}));
  EXPECT_EQ(projected[1].message.at("image").at("data").at(5 * kMcapBins + 7), image.value(7, 5));
  const auto polar = Of(mcap, "/sonar/polar");
  ASSERT_EQ(polar.size(), 3U);
  EXPECT_EQ(polar[1].type, "sensor_msgs/msg/Image");
  EXPECT_EQ(polar[1].message.at("encoding"), "mono8");
  EXPECT_EQ(polar[1].message.at("height"), kMcapBins);
  EXPECT_EQ(polar[1].message.at("step"), kMcapBeams);
  EXPECT_EQ(polar[1].message.at("data").at((kMcapBins - 1 - 7) * kMcapBeams + 5), image.value(7, 5));
  const auto fan = Of(mcap, "/sonar/fan");
  ASSERT_EQ(fan.size(), 3U);
  EXPECT_EQ(fan[0].message.at("height"), 50);
  EXPECT_EQ(fan[0].message.at("data").size(),
            fan[0].message.at("height").get<std::size_t>() * fan[0].message.at("width").get<std::size_t>());
  const auto pose = Of(mcap, "/sonar/pose");
  ASSERT_EQ(pose.size(), 3U);
  EXPECT_EQ(pose[2].message.at("header").at("frame_id"), "map");
  EXPECT_EQ(pose[2].message.at("pose").at("position").at("x"), 3.0);
  const auto transform = Of(mcap, "/tf");
  ASSERT_EQ(transform.size(), 3U);
  EXPECT_EQ(transform[2].message.at("transforms").at(0).at("child_frame_id"), "sonar");
  const auto scenes = Of(mcap, "/scene");
  ASSERT_EQ(scenes.size(), 1U);
  const Json& markers = scenes[0].message.at("markers");
  ASSERT_EQ(markers.size(), 2U);
  EXPECT_EQ(markers.at(1).at("ns"), "wall");
  EXPECT_EQ(markers.at(1).at("type"), 11);
  EXPECT_EQ(markers.at(1).at("points").at(2), Json({{"x", 0.0}, {"y", 0.0}, {"z", 3.0}}));
  EXPECT_EQ(markers.at(1).at("colors").size(), 3U);
  // The fan reaches 3 m, and its outer edges are half a beam beyond 15 degrees.
  const auto outline = Of(mcap, "/sonar/field_of_view");
  ASSERT_EQ(outline.size(), 1U);
  const Json& lines = outline[0].message.at("markers").at(0);
  EXPECT_EQ(lines.at("header").at("frame_id"), "sonar");
  EXPECT_NEAR(lines.at("points").back().at("x").get<double>(), 3.0 * std::sin(RadFromDeg(16.0)), 1e-12);
  const Json about = Json::parse(mcap.metadata.at("recording.json"));
  EXPECT_EQ(about.at("format"), "sonar-recording/1");
  EXPECT_EQ(about.at("synthetic"), true);
}

// The result of a calibration has a standard place, and comes back.
TEST_F(McapRecordingWriterTest, ACalibratedSonarIsWrittenAsSonarInfo) {
  SonarCalibration calibration{
      .parameters = {}, .absorption_db_per_m = 0.25, .reference = "a calibration", .time_ns = 5};
  calibration.parameters.source_level_db = 190.0;
  calibration.parameters.display = {.db_min = 60.0, .db_max = 120.0};
  calibration.parameters.receiver.time_varied_gain = TimeVariedGain::k40LogRAndAbsorption;
  calibration.parameters.pulse.length_m = 0.0148;
  for (int beam = 0; beam < kMcapBeams; ++beam)
    calibration.parameters.beam.sensitivity_db.push_back(-0.5 * std::abs(beam - 7.5));
  const MemoryRecording recording = McapRecording(McapGreyUpTo(255.0), 25);
  const auto path = Write(recording, {.calibration = calibration});
  const auto infos = Of(testing::DecodeMcap(testing::ReadFile(path)), "/sonar/sonar_info");
  ASSERT_EQ(infos.size(), 3U);  // at 0, 10 and 20 s
  EXPECT_EQ(infos[0].type, "marine_interfaces/msg/SonarInfo");
  const Json& message = infos[0].message;
  EXPECT_EQ(message.at("header").at("frame_id"), "sonar");
  EXPECT_EQ(message.at("sonar_model"), "made up");
  EXPECT_EQ(message.at("calibration_ref"), "a calibration");
  EXPECT_EQ(message.at("calibration_time").at("nanosec"), 5);
  EXPECT_NEAR(message.at("pulse_lengths").at(0).get<double>(), 2e-5, 1e-9);
  EXPECT_EQ(message.at("intensity_quantity"), 3);
  EXPECT_EQ(message.at("intensity_scale"), 2);
  EXPECT_EQ(message.at("intensity_reference"), 2);
  EXPECT_NEAR(message.at("scale").get<double>(), 60.0 / 255.0, 1e-6);
  EXPECT_EQ(message.at("offset"), 60.0);
  EXPECT_EQ(message.at("tvg_model"), 3);
  EXPECT_EQ(message.at("tvg_absorption_db_per_km"), 250.0);
  EXPECT_EQ(message.at("source_level_db"), 190.0);
  EXPECT_NEAR(message.at("beam_pattern_angle_deg").at(0).get<double>(), -15.0, 1e-5);
  EXPECT_EQ(message.at("beam_pattern_gain_db").at(0), -3.75);
  const auto read = OpenRecording(path);
  const RecordingInfo& info = read->info();
  EXPECT_EQ(info.sonar.name, "made up");
  EXPECT_NEAR(*info.scale.db_min, 60.0, 1e-5);
  EXPECT_NEAR(*info.scale.db_max, 120.0, 1e-4);
  EXPECT_EQ(info.scale, read->ReadFrame(24).image.scale);
  EXPECT_NEAR(*info.settings.pulse_length_us, 20.0, 1e-3);
  EXPECT_EQ(info.settings.time_varied_gain, true);
  EXPECT_EQ(info.settings.compression, Compression::kLogarithm);
  EXPECT_EQ(*info.source_level_db, 190.0);
  EXPECT_THAT(info.details,
              ::testing::Contains(::testing::Pair("time-varied gain", "40logR, absorption 250 dB/km")));
  EXPECT_THAT(info.notes, ::testing::Each(::testing::Not(HasSubstr("SonarInfo has"))));
}

// The display adds the receiver's gain to the levels in the water, to which SonarInfo refers.
TEST_F(McapRecordingWriterTest, AbsoluteLevelsOfSonarInfoDoNotContainTheGain) {
  SonarCalibration calibration{
      .parameters = {}, .absorption_db_per_m = 0.0, .reference = "a calibration", .time_ns = 5};
  calibration.parameters.source_level_db = 190.0;
  calibration.parameters.display = {.db_min = 60.0, .db_max = 120.0};
  calibration.parameters.receiver.gain_db = 20.0;
  const auto path = Write(McapRecording(McapGreyUpTo(255.0)), {.calibration = calibration});
  const auto infos = Of(testing::DecodeMcap(testing::ReadFile(path)), "/sonar/sonar_info");
  ASSERT_EQ(infos.size(), 1U);
  EXPECT_EQ(infos[0].message.at("intensity_reference"), 2);
  EXPECT_EQ(infos[0].message.at("offset"), 40.0);
  EXPECT_NEAR(infos[0].message.at("scale").get<double>(), 60.0 / 255.0, 1e-6);
  EXPECT_EQ(infos[0].message.at("source_level_db"), 190.0);
}

TEST_F(McapRecordingWriterTest, APathThatIsNotUtf8IsReplaced) {
  const MemoryRecording recording = McapRecording(McapGreyUpTo(255.0), 1);
  RecordingInfo info = recording.info();
  info.scene_path = "/d\xe9p/tank.gltf";
  const auto mcap =
      testing::DecodeMcap(testing::ReadFile(Write(MemoryRecording(info, {recording.ReadFrame(0)}))));
  EXPECT_EQ(Json::parse(mcap.metadata.at("recording.json")).at("scene"), "d\xef\xbf\xbdp/tank.gltf");
}

TEST_F(McapRecordingWriterTest, UnknownValuesAreLeftOutOfSonarInfo) {
  const auto unknown = Of(testing::DecodeMcap(testing::ReadFile(Write(McapRecording(McapGreyUpTo(255.0))))),
                          "/sonar/sonar_info");
  ASSERT_EQ(unknown.size(), 1U);
  const Json& message = unknown[0].message;
  for (const char* name : {"intensity_quantity", "intensity_scale", "intensity_reference", "scale",
                           "tvg_model", "angular_normalization", "angular_response_tl"}) {
    EXPECT_EQ(message.at(name), 0) << name;
  }
  for (const char* name :
       {"tvg_absorption_db_per_km", "source_level_db", "angular_response_absorption_db_per_m"}) {
    EXPECT_TRUE(std::isnan(message.at(name).get<double>())) << name;
  }
  EXPECT_EQ(message.at("pulse_lengths"), Json::array());
  // Levels without a source level are relative.
  ImageScale scale = McapGreyUpTo(255.0);
  scale.db_min = 40.0;
  scale.db_max = 91.0;
  const auto path = Write(McapRecording(scale));
  const auto relative = Of(testing::DecodeMcap(testing::ReadFile(path)), "/sonar/sonar_info");
  EXPECT_EQ(relative.at(0).message.at("intensity_reference"), 1);
  EXPECT_NEAR(*OpenRecording(path)->info().scale.db_span, 51.0, 1e-4);
  EXPECT_FALSE(OpenRecording(path)->info().scale.db_min);
}

TEST_F(McapRecordingWriterTest, SettingsThatChangeAreWrittenAgainAndComeBack) {
  const MemoryRecording recording = McapRecording(McapGreyUpTo(255.0), 4);
  std::vector<Frame> frames;
  for (int i = 0; i < 4; ++i) {
    frames.push_back(recording.ReadFrame(i));
    frames.back().info.settings.pulse_length_us = i < 2 ? 10.0 : 30.0;
  }
  const auto read = OpenRecording(Write(MemoryRecording(recording.info(), frames)));
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(*read->frame_info(i).settings.pulse_length_us, i < 2 ? 10.0 : 30.0, 1e-3);
    EXPECT_EQ(read->ReadFrame(i).info.settings, read->frame_info(i).settings);
  }
  EXPECT_THAT(read->info().notes, ::testing::Contains(HasSubstr("SonarInfo has 2 versions")));
}

TEST_F(McapRecordingWriterTest, PowerHasNoFanAndRecordingsWithoutPosesHaveNone) {
  ImageScale power;
  power.quantity = Quantity::kPower;
  std::vector<Frame> frames = {McapRecording(power).ReadFrame(0)};
  frames[0].info.world_from_sonar.reset();
  frames[0].info.time_s.reset();
  const auto mcap =
      testing::DecodeMcap(testing::ReadFile(Write(MemoryRecording(McapRecording(power).info(), frames))));
  EXPECT_THAT(Of(mcap, "/sonar/fan"), IsEmpty());
  EXPECT_THAT(Of(mcap, "/sonar/pose"), IsEmpty());
  EXPECT_THAT(Of(mcap, "/tf"), IsEmpty());
  ASSERT_EQ(Of(mcap, "/sonar/polar").size(), 1U);
  EXPECT_EQ(Of(mcap, "/sonar/polar")[0].message.at("encoding"), "32FC1");
}

TEST_F(McapRecordingWriterTest, RecordingsThatDoNotFitAreRefused) {
  const auto refusal = [&](const RecordingInfo& info, std::vector<Frame> frames) {
    return testing::MessageOf([&] { Write(MemoryRecording(info, std::move(frames))); });
  };
  const MemoryRecording recording = McapRecording(McapGreyUpTo(255.0));
  const std::vector<Frame> frames = {recording.ReadFrame(0), recording.ReadFrame(1)};
  std::vector<Frame> late = frames;
  late[1].info.time_s = 3e9;
  EXPECT_THAT(refusal(recording.info(), late),
              HasSubstr("time_s is 3e+09, expected 0 .. 2147483647 for ROS"));
  std::vector<Frame> other = frames;
  other[1].image.axes.range_max_m = 5.0;
  EXPECT_THAT(refusal(recording.info(), other), HasSubstr("frame 1 differs from the first: range windows"));
  std::vector<Frame> louder = frames;
  louder[1].image.scale.db_span = 40.0;
  EXPECT_THAT(refusal(recording.info(), louder), HasSubstr("frame 1 differs from the first in the scale"));
  const MemoryRecording fractions = McapRecording(McapGreyUpTo(1.0), 1);
  EXPECT_THAT(refusal(fractions.info(), {fractions.ReadFrame(0)}),
              HasSubstr("full scale of the recording's grey values is 1, expected"));
  std::vector<Frame> twice = frames;
  twice[1].info.time_s = twice[0].info.time_s;
  EXPECT_THAT(refusal(recording.info(), twice), HasSubstr("have the same time, 100.250000000 s"));
  ImageScale decibel;
  decibel.quantity = Quantity::kDecibel;
  std::vector<Frame> levels = frames;
  levels[0].image.scale = decibel;
  RecordingInfo info = recording.info();
  info.scale = decibel;
  EXPECT_THAT(refusal(info, levels), HasSubstr("expected grey or power"));
  EXPECT_THAT(
      testing::MessageOf([&] { WriteMcapRecording(recording, {}, "a test", dir_ / "absent" / "out.mcap"); }),
      HasSubstr("out.mcap: cannot be written"));
}

TEST(McapWriterTest, ChunksOfManyMessagesAreIndexed) {
  const testing::TempDir dir;
  McapWriter writer(dir / "a.mcap", "ros2", "a test");
  const auto text = writer.AddChannel({.topic = "/text",
                                       .message_encoding = "cdr",
                                       .schema_name = "std_msgs/msg/String",
                                       .schema_encoding = "ros2msg",
                                       .schema = "string data\n"});
  std::string message("\0\1\0\0\xe9\x03\0\0", 8);
  message.append(1000, 'x') += '\0';
  for (int i = 0; i < 10'000; ++i) writer.Write(text, i, message);
  writer.Close();
  const auto mcap = testing::DecodeMcap(testing::ReadFile(dir / "a.mcap"));
  ASSERT_EQ(mcap.messages.size(), 10'000U);
  EXPECT_EQ(mcap.messages[9'999].time_ns, 9'999U);
  EXPECT_EQ(Bag::Open(dir / "a.mcap")->topics().at(0).count, 10'000U);
  EXPECT_THAT(Bag::Open(dir / "a.mcap")->notes(), IsEmpty());
}

}  // namespace
}  // namespace sonarcal::data_io
