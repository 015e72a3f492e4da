// Recordings as files of other tools: each read back by our own reader, where we have one, and by another's.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include <nlohmann/json.hpp>
#include <opencv2/videoio.hpp>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/bag_trajectory.h"
#include "data_io/bag_writers/mcap_recording_writer.h"
#include "data_io/bag_writers/ros1_bag_writer.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/pictures/fan_pictures.h"
#include "data_io/pictures/picture_geometry.h"
#include "data_io/posed_recording.h"
#include "data_io/recordings/npz_writer.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/ros/bag_recording.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MessageOf;
using testing::TempDir;
using Json = nlohmann::json;

constexpr int kBins = 60;
constexpr int kBeams = 24;

PolarAxes Axes() {
  PolarAxes axes{.range_min_m = 1.0, .range_max_m = 4.0, .range_bins = kBins, .beam_azimuth_rad = {}};
  for (int beam = 0; beam < kBeams; ++beam) axes.beam_azimuth_rad.push_back(RadFromDeg((beam - 11.5) * 1.5));
  return axes;
}

// Smooth, bright on the right and far away, and different in every frame.
PolarImage Image(int frame, const ImageScale& scale) {
  PolarImage image{Axes(), scale, Grid<float>(kBins, kBeams)};
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double grey = 0.15 + 0.5 * bin / kBins + 0.2 * beam / kBeams + 0.1 * std::sin(0.2 * bin + frame);
      image.value(bin, beam) = static_cast<float>(
          scale.quantity == Quantity::kGrey ? std::round(grey * scale.full_scale) : grey * 1e-3);
    }
  }
  return image;
}

// Three frames half a second apart, the last one without a time and a pose.
MemoryRecording Recording(const ImageScale& scale = {}) {
  RecordingInfo info;
  info.source = "made up";
  info.sonar = {.name = "made up",
                .frequency_hz = 1.2e6,
                .axes = Axes(),
                .azimuth_beam_width_deg = 1.0,
                .elevation_beam_width_deg = 20.0,
                .sound_speed_m_per_s = 1480.0};
  info.scale = scale;
  info.water = Water{.temperature_c = 11.0};
  std::vector<Frame> frames;
  for (int i = 0; i < 3; ++i) {
    Frame frame{{.name = fmt::format("frame {}", i), .time_s = {}, .world_from_sonar = {}}, Image(i, scale)};
    if (i < 2) {
      frame.info.time_s = 100.25 + 0.5 * i;
      frame.info.world_from_sonar =
          Pose{RotationFromYawPitchRoll(0.3 * i, -0.2, 0.1), Eigen::Vector3d(1.0 + i, -2.0, 0.5)};
    }
    frames.push_back(std::move(frame));
  }
  return {std::move(info), std::move(frames)};
}

ImageScale GreyUpTo(double full_scale) {
  ImageScale scale;
  scale.full_scale = full_scale;
  return scale;
}

ImageScale Power() {
  ImageScale scale;
  scale.quantity = Quantity::kPower;
  scale.full_scale = 1.0;
  return scale;
}

// Grey values with fractions, between a tenth and 85 % of full scale.
MemoryRecording Fractions(double full_scale) {
  const MemoryRecording whole = Recording(GreyUpTo(full_scale));
  std::vector<Frame> frames;
  for (int i = 0; i < whole.frame_count(); ++i) {
    frames.push_back(whole.ReadFrame(i));
    for (float& value : frames.back().image.value.values())
      value = static_cast<float>(0.75 * static_cast<double>(value) + 0.1 * full_scale);
  }
  return {whole.info(), std::move(frames)};
}

Json RunPython(const std::string& script, const std::filesystem::path& file) {
  const TempDir dir;
  const std::string command = fmt::format("{} {}/{} '{}' >'{}'", SONARCAL_PYTHON, SONARCAL_SCRIPTS, script,
                                          file.string(), (dir / "out").string());
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return Json::parse(testing::ReadFile(dir / "out"));
}

void ExpectSameImage(const Grid<float>& a, const Grid<float>& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.values()[i], b.values()[i]) << i;
}

class BagOfScale : public ::testing::TestWithParam<double> {};  // full scale; 0: power

TEST_P(BagOfScale, OurReaderFindsTheSame) {
  const TempDir dir;
  const MemoryRecording recording = Recording(GetParam() == 0.0 ? Power() : GreyUpTo(GetParam()));
  WriteRos1Bag(recording, dir / "out.bag");
  const auto read = OpenBagRecording(dir / "out.bag", {.topic = "/sonar/image"});
  ASSERT_EQ(read->frame_count(), 3);
  EXPECT_TRUE(read->info().sonar.axes.Matches(recording.info().sonar.axes));
  EXPECT_FLOAT_EQ(static_cast<float>(read->info().sonar.frequency_hz), 1.2e6F);
  EXPECT_NEAR(read->info().sonar.azimuth_beam_width_deg, 1.0, 1e-5);
  EXPECT_NEAR(read->info().sonar.elevation_beam_width_deg, 20.0, 1e-5);
  for (int i = 0; i < 3; ++i)
    ExpectSameImage(read->ReadFrame(i).image.value, recording.ReadFrame(i).image.value);
  EXPECT_EQ(read->info().scale.quantity, recording.info().scale.quantity);
  EXPECT_NEAR(*read->frame_info(1).time_s, 100.75, 1e-6);
  EXPECT_NEAR(*read->frame_info(2).time_s, 101.75, 1e-6);  // without a time: when it was logged
}
INSTANTIATE_TEST_SUITE_P(Scales, BagOfScale, ::testing::Values(255.0, 4095.0, 65535.0, 0.0));

TEST(Ros1BagWriterTest, WrittenPosesReadBackWithinRounding) {
  const TempDir dir;
  const MemoryRecording recording = Recording();
  WriteRos1Bag(recording, dir / "out.bag");
  const std::vector<TrajectoryPose> poses = ReadBagTrajectory(dir / "out.bag", {.topic = "/sonar/pose"});
  ASSERT_EQ(poses.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    const Pose expected = *recording.frame_info(i).world_from_sonar;
    EXPECT_LT((poses[i].world_from_body.position_m - expected.position_m).norm(), 1e-12);
    EXPECT_LT(poses[i].world_from_body.rotation.angularDistance(expected.rotation), 1e-7);
  }
}

// Frames that have the poses that `convert --pose-topic` gives them: those of their own times.
void ExpectPosesComeBack(const MemoryRecording& recording, const std::filesystem::path& bag) {
  WriteRos1Bag(recording, bag);
  const PosedRecording read(OpenBagRecording(bag, {.topic = "/sonar/image"}),
                            {.world_from_body = ReadBagTrajectory(bag, {.topic = "/sonar/pose"}),
                             .body_from_sonar = {},
                             .time_offset_s = 0.0,
                             .most_gap_s = 1.0});
  ASSERT_EQ(read.frame_count(), recording.frame_count());
  for (int i = 0; i < recording.frame_count(); ++i) {
    const FrameInfo was = recording.frame_info(i);
    const FrameInfo is = read.frame_info(i);
    if (was.time_s) {
      EXPECT_NEAR(*is.time_s, *was.time_s, 2e-9) << i;
    }
    ASSERT_TRUE(is.world_from_sonar) << i;
    EXPECT_LT((is.world_from_sonar->position_m - was.world_from_sonar->position_m).norm(), 1e-12) << i;
    EXPECT_LT(is.world_from_sonar->rotation.angularDistance(was.world_from_sonar->rotation), 1e-7) << i;
  }
}

MemoryRecording PosedAt(const std::vector<std::optional<double>>& times_s) {
  const MemoryRecording few = Recording();
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    Frame frame = few.ReadFrame(static_cast<int>(i) % 3);
    frame.info.time_s = times_s[i];
    const auto k = static_cast<double>(i);
    frame.info.world_from_sonar =
        Pose{RotationFromYawPitchRoll(0.3 * k, 0.1 - 0.2 * k, 0.1), Eigen::Vector3d(1.0 + k, -2.0, 0.5 * k)};
    frames.push_back(std::move(frame));
  }
  return {few.info(), std::move(frames)};
}

TEST(Ros1BagWriterTest, EveryFrameFindsItsPoseAgainWhereverTimesBegin) {
  const TempDir dir;
  ExpectPosesComeBack(PosedAt({0.0, 1.0, 2.0, 3.0}), dir / "from_0.bag");
  ExpectPosesComeBack(PosedAt({0.0, 0.1, 0.2, 5.0}), dir / "fast.bag");
  ExpectPosesComeBack(PosedAt({1.0, 2.0, 3.0}), dir / "from_1.bag");
  ExpectPosesComeBack(PosedAt({1.7e9, 1.7e9 + 0.05, 1.7e9 + 0.1}), dir / "since_1970.bag");
  ExpectPosesComeBack(PosedAt({{}, {}, {}}), dir / "without_times.bag");
}

TEST(Ros1BagWriterTest, FramesWithoutATimeStayBetweenTheirNeighbours) {
  const TempDir dir;
  ExpectPosesComeBack(PosedAt({10.0, {}, 10.5}), dir / "one.bag");
  EXPECT_NEAR(*OpenBagRecording(dir / "one.bag", {.topic = "/sonar/image"})->frame_info(1).time_s, 10.25,
              1e-6);
  ExpectPosesComeBack(PosedAt({{}, 0.5, {}, {}, 0.6, {}, 1.0}), dir / "several.bag");
  ExpectPosesComeBack(PosedAt({{}, 1.0}), dir / "first.bag");
  ExpectPosesComeBack(PosedAt({10.0, {}, 20.0}), dir / "far.bag");
  EXPECT_NEAR(*OpenBagRecording(dir / "far.bag", {.topic = "/sonar/image"})->frame_info(1).time_s, 11.0,
              1e-6);
}

TEST(Ros1BagWriterTest, RefusesTwoPosesAtOneTime) {
  const TempDir dir;
  EXPECT_THAT(
      [&] {
        WriteRos1Bag(PosedAt({0.0, 1.0, 1.0}), dir / "a.bag");
      },
      ::testing::ThrowsMessage<DataError>(HasSubstr("frames 1 and 2 have the same time")));
  // No time lies before 0 s, which is written as 1 ns.
  EXPECT_THROW(WriteRos1Bag(PosedAt({{}, 0.0}), dir / "b.bag"), DataError);
}

// By the definitions in the bag, which rosbag parses itself.
TEST(Ros1BagWriterTest, RosbagReadsTheBagByItsOwnDefinitions) {
  constexpr const char* kIsThere = SONARCAL_PYTHON
      " -c 'import importlib.util, sys; sys.exit(importlib.util.find_spec(\"rosbag\") is None)'";
  if (std::system(kIsThere) != 0) GTEST_SKIP() << "python3-rosbag is not installed";
  const TempDir dir;
  const MemoryRecording recording = Recording(GreyUpTo(4095.0));
  WriteRos1Bag(recording, dir / "out.bag");
  const Json read = RunPython("read_bag.py", dir / "out.bag");
  for (const auto& [topic, sums] : read.at("md5").items()) EXPECT_EQ(sums.at(0), sums.at(1)) << topic;
  ASSERT_EQ(read.at("messages").size(), 5U);
  int image_count = 0;
  for (const Json& entry : read.at("messages")) {
    const Json& message = entry.at("message");
    if (entry.at("topic") == "/sonar/pose") {
      EXPECT_EQ(entry.at("type"), "geometry_msgs/PoseStamped");
      EXPECT_EQ(message.at("header").at("frame_id"), "map");
      continue;
    }
    EXPECT_EQ(entry.at("type"), "marine_acoustic_msgs/ProjectedSonarImage");
    const int frame = image_count++;
    EXPECT_EQ(message.at("header").at("seq"), frame);
    if (frame == 1) {
      EXPECT_EQ(message.at("header").at("stamp"), Json({100, 750000000}));
    }
    EXPECT_EQ(message.at("ping_info").at("frequency"), 1.2e6);
    EXPECT_EQ(message.at("image").at("dtype"), 2);
    EXPECT_EQ(message.at("image").at("beam_count"), kBeams);
    const Json& beam = message.at("beam_directions").at(20);
    EXPECT_NEAR(std::atan2(beam.at("y").get<double>(), beam.at("z").get<double>()), RadFromDeg(8.5 * 1.5),
                1e-12);
    EXPECT_NEAR(message.at("ranges").at(0).get<double>(), 1.025, 1e-6);
    const Json& data = message.at("image").at("data");
    const std::size_t sample = 20 * kBins + 7;  // beam 20, bin 7: beam-major, as the definition says
    const int value = data.at(2 * sample).get<int>() + 256 * data.at(2 * sample + 1).get<int>();
    EXPECT_EQ(value, recording.ReadFrame(frame).image.value(7, 20));
  }
  EXPECT_EQ(image_count, 3);
}

TEST(Ros1BagWriterTest, RecordingsThatABagCannotHoldAreRefused) {
  const TempDir dir;
  ImageScale level;
  level.quantity = Quantity::kDecibel;
  EXPECT_THROW(WriteRos1Bag(Recording(level), dir / "level.bag"), DataError);
  MemoryRecording early = Recording();
  Frame frame = early.ReadFrame(0);
  frame.info.time_s = -1.0;
  EXPECT_THROW(WriteRos1Bag(MemoryRecording(early.info(), {frame}), dir / "early.bag"), DataError);
  EXPECT_THROW(WriteRos1Bag(Recording(), dir / "absent" / "out.bag"), DataError);
}

// A bag's floats are power, so that it cannot hold these.
TEST(Ros1BagWriterTest, GreyScalesWithoutWholeLevelsAreRefused) {
  const TempDir dir;
  for (const double full_scale : {1.0, 100.5, 200000.0}) {
    EXPECT_THAT([&] { WriteRos1Bag(Fractions(full_scale), dir / fmt::format("{}.bag", full_scale)); },
                ::testing::ThrowsMessage<DataError>(HasSubstr("expected a whole number from 2 to 65535")))
        << full_scale;
  }
}

TEST(NpzWriterTest, NumPyFindsTheSame) {
  for (const ImageScale& scale : {GreyUpTo(255.0), GreyUpTo(4095.0), Power()}) {
    const TempDir dir;
    const MemoryRecording recording = Recording(scale);
    WriteNpz(recording, dir / "out.npz");
    const Json read = RunPython("read_npz.py", dir / "out.npz");
    const Json& arrays = read.at("arrays");
    const Json& images = arrays.at("images");
    EXPECT_EQ(images.at("shape"), Json({3, kBins, kBeams}));
    EXPECT_EQ(images.at("dtype"), scale.quantity == Quantity::kPower ? "float32"
                                  : scale.full_scale > 255.0         ? "uint16"
                                                                     : "uint8");
    for (int i = 0; i < 3; ++i) {
      const Grid<float> value = recording.ReadFrame(i).image.value;
      for (int bin = 0; bin < kBins; ++bin) {
        for (int beam = 0; beam < kBeams; ++beam)
          ASSERT_EQ(images.at("values").at(i).at(bin).at(beam).get<float>(), value(bin, beam));
      }
    }
    EXPECT_NEAR(arrays.at("range_m").at("values").at(0).get<double>(), 1.025, 1e-12);
    EXPECT_NEAR(arrays.at("beam_azimuth_deg").at("values").at(23).get<double>(), 17.25, 1e-12);
    EXPECT_EQ(arrays.at("time_s").at("values"), Json({100.25, 100.75, nullptr}));
    EXPECT_EQ(arrays.at("valid").at("dtype"), "bool");
    const Json& pose = arrays.at("world_from_sonar").at("values").at(1);
    const Eigen::Vector3d ahead =
        recording.frame_info(1).world_from_sonar->rotation * Eigen::Vector3d::UnitY();
    for (int row = 0; row < 3; ++row) EXPECT_NEAR(pose.at(row).at(1).get<double>(), ahead[row], 1e-12);
    EXPECT_EQ(pose.at(0).at(3), 2.0);
    EXPECT_EQ(pose.at(3), Json({0.0, 0.0, 0.0, 1.0}));
    EXPECT_TRUE(arrays.at("world_from_sonar").at("values").at(2).at(0).at(0).is_null());
    EXPECT_EQ(read.at("recording").at("sonar").at("frequency_hz"), 1.2e6);
    EXPECT_EQ(read.at("recording").at("water").at("temperature_c"), 11.0);
  }
}

TEST(NpzWriterTest, GreyScalesWithoutWholeLevelsAreFloats) {
  for (const double full_scale : {1.0, 100.5, 200000.0}) {
    const TempDir dir;
    const MemoryRecording recording = Fractions(full_scale);
    WriteNpz(recording, dir / "out.npz");
    const Json read = RunPython("read_npz.py", dir / "out.npz");
    const Json& images = read.at("arrays").at("images");
    EXPECT_EQ(images.at("dtype"), "float32");
    EXPECT_EQ(read.at("recording").at("image").at("bits"), 32);
    const Grid<float> value = recording.ReadFrame(1).image.value;
    for (int bin = 0; bin < kBins; ++bin) {
      for (int beam = 0; beam < kBeams; ++beam)
        ASSERT_EQ(images.at("values").at(1).at(bin).at(beam).get<float>(), value(bin, beam)) << full_scale;
    }
  }
}

TEST(NpzWriterTest, FramesOfAnotherScaleAndValuesOutsideItAreRefused) {
  const TempDir dir;
  const MemoryRecording recording = Recording();
  const auto write_second = [&](const Frame& second) {
    WriteNpz(MemoryRecording(recording.info(), {recording.ReadFrame(0), second}), dir / "out.npz");
  };
  Frame other = recording.ReadFrame(1);
  other.image.scale.db_min = 10.0;
  EXPECT_THAT([&] { write_second(other); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("frame 1 differs from the first in the scale")));
  Frame bright = recording.ReadFrame(1);
  bright.image.value(2, 3) = 256.0F;
  EXPECT_THAT([&] { write_second(bright); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("frame 1: the pixel in row 2, column 3 is 256")));
}

TEST(NpzWriterTest, APathThatIsNotUtf8IsReplaced) {
  const TempDir dir;
  RecordingInfo info = Recording().info();
  info.scene_path = "/d\xe9p/tank.gltf";
  WriteNpz(MemoryRecording(info, {Recording().ReadFrame(0)}), dir / "out.npz");
  EXPECT_EQ(RunPython("read_npz.py", dir / "out.npz").at("recording").at("scene"),
            "d\xef\xbf\xbdp/tank.gltf");
}

TEST(NpzWriterTest, TheSameRecordingGivesTheSameBytes) {
  const TempDir dir;
  WriteNpz(Recording(), dir / "a.npz");
  WriteNpz(Recording(), dir / "b.npz");
  EXPECT_EQ(testing::ReadFile(dir / "a.npz"), testing::ReadFile(dir / "b.npz"));
}

TEST(FullDiskTest, EachWriterGivesTheReasonOfTheSystem) {
  const std::filesystem::path full = "/dev/full";
  if (!std::filesystem::exists(full)) GTEST_SKIP() << "needs /dev/full";
  const std::string expected = "/dev/full: cannot be written: " + std::generic_category().message(ENOSPC);
  EXPECT_EQ(MessageOf([&] { WriteRos1Bag(Recording(), full); }), expected);
  EXPECT_EQ(MessageOf([&] { WriteMcapRecording(Recording(), {}, "a test", full); }), expected);
  EXPECT_EQ(MessageOf([&] { WriteNpz(Recording(), full); }), expected);
}

TEST(FanPicturesTest, OurReaderFindsAxesAndGreyValues) {
  const TempDir dir;
  const MemoryRecording recording = Recording(GreyUpTo(4095.0));
  const FanPainter painter(recording.info(), {.height_px = 400});
  std::filesystem::create_directory(dir / "fans");
  WriteFanPngs(recording, painter, dir / "fans");
  const auto read = OpenRecording(dir / "fans");
  ASSERT_EQ(read->frame_count(), 3);
  EXPECT_TRUE(read->info().sonar.axes.Matches(Axes()));
  EXPECT_EQ(read->info().sonar.frequency_hz, 1.2e6);
  for (int i = 0; i < 3; ++i) {
    const Grid<float> was = recording.ReadFrame(i).image.value;
    const Grid<float> is = read->ReadFrame(i).image.value;
    // Away from the edges; the picture rounds to a grey level and interpolates twice, over sixteen times
    // finer pixels than the image changes in.
    for (int bin = 2; bin < kBins - 2; ++bin) {
      for (int beam = 2; beam < kBeams - 2; ++beam)
        ASSERT_NEAR(is(bin, beam), was(bin, beam) * 255.0 / 4095.0, 1.0) << i << " " << bin << " " << beam;
    }
  }
}

// Frame by frame as FFmpeg decodes it: MPEG-4 loses some, so each frame must be that of its number, and near
// it.
TEST(FanPicturesTest, VideosShowEachFrameInItsPlace) {
  const TempDir dir;
  const MemoryRecording recording = Recording();
  const FanPainter painter(recording.info(), {.height_px = 240});
  WriteFanVideo(recording, painter, RecordedFramesPerS(recording), dir / "out.mp4");
  cv::VideoCapture video((dir / "out.mp4").string(), cv::CAP_FFMPEG);
  ASSERT_TRUE(video.isOpened());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 2.0, 1e-6);
  cv::Mat decoded;
  int count = 0;
  for (; video.read(decoded); ++count) {
    ASSERT_EQ(decoded.rows, painter.rows());
    ASSERT_EQ(decoded.cols, painter.cols());
    std::vector<double> mean_difference;
    for (int other = 0; other < 3; ++other) {
      const Grid<std::uint8_t> painted = painter.Paint(recording.ReadFrame(other));
      double sum = 0.0;
      for (int row = 0; row < decoded.rows; ++row) {
        for (int col = 0; col < decoded.cols; ++col)
          sum += std::abs(static_cast<double>(decoded.at<cv::Vec3b>(row, col)[1]) - painted(row, col));
      }
      mean_difference.push_back(sum / (1.0 * decoded.rows * decoded.cols));
    }
    for (int other = 0; other < 3; ++other) {
      if (other == count) {
        EXPECT_LT(mean_difference[other], 2.0) << count;
      } else {
        EXPECT_GT(mean_difference[other], 2.0 * mean_difference[count]) << count << " " << other;
      }
    }
  }
  EXPECT_EQ(count, 3);
}

TEST(FanPicturesTest, RatesAreThoseOfTheTimes) {
  EXPECT_DOUBLE_EQ(RecordedFramesPerS(Recording()), 2.0);
  const MemoryRecording recording = Recording();
  EXPECT_EQ(RecordedFramesPerS(MemoryRecording(recording.info(), {recording.ReadFrame(2)})), 0.0);
}

// The first and the last frame have a time, the one between has none.
TEST(FanPicturesTest, RatesNeedTwoNeighboursWithTimes) {
  const MemoryRecording recording = Recording();
  const Frame timed = recording.ReadFrame(0);
  EXPECT_EQ(RecordedFramesPerS(MemoryRecording(recording.info(), {timed, recording.ReadFrame(2), timed})),
            0.0);
}

// The farthest values that recording.json may hold.
TEST(FanPicturesTest, EverySonarOfARecordingReadsBack) {
  const TempDir dir;
  RecordingInfo info = Recording().info();
  info.sonar.frequency_hz = 1e9;
  info.sonar.azimuth_beam_width_deg = 360.0;
  info.sonar.elevation_beam_width_deg = 360.0;
  info.sonar.axes.range_max_m = 1e5;
  for (const double sound_speed_m_per_s : {1000.0, 2000.0}) {
    info.sonar.sound_speed_m_per_s = sound_speed_m_per_s;
    testing::WriteFile(dir / "geometry.json", FanPainter(info, {.height_px = 100}).GeometryJson());
    const PictureGeometry geometry = ReadPictureGeometry(dir / "geometry.json");
    EXPECT_EQ(geometry.frequency_hz, 1e9);
    EXPECT_EQ(geometry.azimuth_beam_width_deg, 360.0);
    EXPECT_EQ(geometry.elevation_beam_width_deg, 360.0);
    EXPECT_EQ(geometry.range_max_m, 1e5);
    EXPECT_EQ(geometry.synthetic, info.synthetic);
    EXPECT_EQ(geometry.sound_speed_m_per_s, sound_speed_m_per_s);
    info.synthetic = true;
    WriteSonarFile(dir / "sonar.json", info);
    EXPECT_EQ(ReadSonarFile(dir / "sonar.json").sonar.sound_speed_m_per_s, sound_speed_m_per_s);
  }
}

TEST(FanPicturesTest, OnlyGreyValuesHaveABrightness) {
  EXPECT_THROW(FanPainter(Recording(Power()).info(), {}), DataError);
}

TEST(FanPicturesTest, AVideoInAnAbsentFolderIsRefused) {
  const TempDir dir;
  const MemoryRecording recording = Recording();
  const FanPainter painter(recording.info(), {});
  EXPECT_THROW(WriteFanVideo(recording, painter, 10.0, dir / "absent" / "out.mp4"), DataError);
}

}  // namespace
}  // namespace sonarcal::data_io
