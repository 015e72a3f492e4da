#include "data_io/ros/bag_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include <opencv2/imgcodecs.hpp>

#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"
#include "tests/data_io/hostile.h"
#include "tests/data_io/made_up_bag.h"
#include "tests/data_io/made_up_mcap.h"
#include "tests/data_io/refusal.h"
#include "tests/data_io/sonar_messages.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kProjectedType;
using testing::MadeUpMessage;
using testing::MadeUpOculusPing;
using testing::MadeUpProjected;
using ::testing::Not;
using ::testing::Pair;
using testing::Wire;

constexpr const char* kOculusType = "sonar_oculus/OculusPing";

class BagRecordingTest : public ::testing::Test {
 protected:
  // Writes a bag of the kind that goes with the messages' serialization, and returns its path.
  std::filesystem::path Write(Wire wire, const std::vector<MadeUpMessage>& messages,
                              const testing::MadeUpRos1Bag& how = {}) {
    std::filesystem::path path = dir_ / (wire == Wire::kRos1 ? "test.bag" : "test.db3");
    if (wire == Wire::kRos1) {
      testing::WriteFile(path, testing::Ros1BagBytes(messages, how));
    } else {
      testing::WriteRos2Bag(path, messages);
    }
    return path;
  }

  std::filesystem::path WriteProjected(Wire wire, const MadeUpProjected& message) {
    return Write(wire, {{"/sonar", kProjectedType, 5, message.Write(wire)}});
  }
  std::filesystem::path WritePing(Wire wire, const MadeUpOculusPing& message) {
    return Write(wire, {{"/ping", kOculusType, 5, message.Write(wire)}});
  }

  testing::TempDir dir_;
};

void ExpectAngles(const std::vector<double>& azimuth_rad, const std::vector<double>& expected_deg) {
  ASSERT_EQ(azimuth_rad.size(), expected_deg.size());
  for (std::size_t i = 0; i < expected_deg.size(); ++i)
    EXPECT_NEAR(DegFromRad(azimuth_rad[i]), expected_deg[i], 1e-9);
}

TEST_F(BagRecordingTest, AProjectedSonarImageIsReadFromEitherBag) {
  for (const Wire wire : testing::kWires) {
    const auto recording = OpenRecording(WriteProjected(wire, {}));
    const RecordingInfo& info = recording->info();
    EXPECT_THAT(info.format, HasSubstr(wire == Wire::kRos1 ? "ROS 1 bag, marine" : "ROS 2 bag, marine"));
    EXPECT_FLOAT_EQ(static_cast<float>(info.sonar.frequency_hz), 1.2e6F);
    EXPECT_FLOAT_EQ(static_cast<float>(info.sonar.sound_speed_m_per_s), 1480.0F);
    EXPECT_NEAR(info.sonar.azimuth_beam_width_deg, DegFromRad(0.01), 1e-6);
    EXPECT_NEAR(info.sonar.elevation_beam_width_deg, DegFromRad(0.3), 1e-6);
    EXPECT_THAT(info.notes, Contains(HasSubstr("Neither gain, TVG, dB scale nor water is recorded")));
    ASSERT_EQ(recording->frame_count(), 1);
    EXPECT_DOUBLE_EQ(*recording->frame_info(0).time_s, 1'700'000'000.25);
    const Frame frame = recording->ReadFrame(0);
    EXPECT_NEAR(frame.image.axes.range_min_m, 2.0, 1e-6);
    EXPECT_NEAR(frame.image.axes.range_max_m, 4.0, 1e-6);
    ExpectAngles(frame.image.axes.beam_azimuth_rad, {-30.0, 0.0, 30.0});
    EXPECT_EQ(frame.image.scale.full_scale, 255.0);
    // Sample (bin, beam) is 10 bin + beam + 1.
    EXPECT_THAT(frame.image.value.values(), ElementsAre(1, 2, 3, 11, 12, 13, 21, 22, 23, 31, 32, 33));
  }
}

TEST_F(BagRecordingTest, SamplesOfEveryTypeAndByteOrder) {
  // recording.json holds full scales up to 1e12.
  const double largest[] = {255.0, 127.0, 65535.0, 32767.0, 4294967295.0, 2147483647.0, 1e12, 1e12};
  for (std::uint32_t type = 0; type <= 9; ++type) {
    for (const bool big_endian : {false, true}) {
      const auto recording = OpenRecording(
          WriteProjected(Wire::kRos1, {.data_big_endian = big_endian, .type = type, .add = 40}));
      const Frame frame = recording->ReadFrame(0);
      EXPECT_EQ(frame.image.value(3, 2), 72.0F) << type;
      EXPECT_EQ(frame.image.scale.quantity, type >= 8 ? Quantity::kPower : Quantity::kGrey);
      if (type < 8) {
        EXPECT_EQ(frame.image.scale.full_scale, largest[type]);
      }
    }
  }
}

TEST_F(BagRecordingTest, WhatRecordingJsonCannotHoldIsLeftOutOrRefused) {
  const auto converted = [&](const MadeUpProjected& message) {
    const testing::TempDir dir;
    WriteRecording(*OpenRecording(WriteProjected(Wire::kRos1, message)), dir / "out");
    return OpenRecording(dir / "out")->info();
  };
  EXPECT_EQ(converted({.type = 6}).scale.full_scale, 1e12);
  EXPECT_EQ(converted({.frequency_hz = 1e9F}).sonar.frequency_hz, 1e9);
  for (const float frequency_hz : {1.1e9F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    const RecordingInfo info = converted({.frequency_hz = frequency_hz});
    EXPECT_EQ(info.sonar.frequency_hz, 0.0);
    EXPECT_THAT(info.notes, Contains(HasSubstr("Hz is invalid and was omitted")));
  }
  EXPECT_THAT(converted({.frequency_hz = 0.0F}).notes, Each(Not(HasSubstr("Hz is invalid"))));
  // The last byte is the highest of the last sample.
  std::string bytes = MadeUpProjected{.type = 6}.Write(Wire::kRos1);
  bytes.back() = '\x7f';
  EXPECT_THAT(testing::RefusalOf(Write(Wire::kRos1, {{"/sonar", kProjectedType, 5, bytes}})),
              HasSubstr("expected 0 or more, at most 1e+12"));
}

TEST_F(BagRecordingTest, SampleOrderIsThatOfTheOptionOrOfTheFirstFrame) {
  MadeUpProjected message;
  message.blob = true;
  message.azimuth_deg.clear();
  for (int beam = 0; beam < 13; ++beam) message.azimuth_deg.push_back(beam - 6.0);
  message.range_m.clear();
  for (int bin = 0; bin < 21; ++bin) message.range_m.push_back(1.25F + 0.5F * static_cast<float>(bin));
  message.beam_count = 13;
  message.by_range = true;
  const auto path = WriteProjected(Wire::kCdrLittle, message);
  const auto by_beam = OpenRecording(path);
  EXPECT_THAT(by_beam->info().notes, Contains(HasSubstr("speaks for the other order, range by range")));
  EXPECT_NE(by_beam->ReadFrame(0).image.value(10, 4), message.Sample(10, 4));
  const auto by_range = OpenBagRecording(path, {.message = {.sample_order = SampleOrder::kByRange}});
  EXPECT_THAT(by_range->info().notes, Each(Not(HasSubstr("speaks for the other"))));
  EXPECT_EQ(by_range->ReadFrame(0).image.value(10, 4), message.Sample(10, 4));
  // Written beam by beam, the definition's order, it says nothing.
  message.by_range = false;
  EXPECT_THAT(OpenRecording(WriteProjected(Wire::kCdrLittle, message))->info().notes,
              Each(Not(HasSubstr("speaks for the other"))));
}

TEST_F(BagRecordingTest, BeamsFromTheRightAreTurned) {
  const auto recording = OpenRecording(WriteProjected(Wire::kCdrBig, {.azimuth_deg = {20.0, 5.0, -10.0}}));
  const Frame frame = recording->ReadFrame(0);
  ExpectAngles(frame.image.axes.beam_azimuth_rad, {-10.0, 5.0, 20.0});
  EXPECT_THAT(frame.image.value.row(0), ElementsAre(3, 2, 1));
}

TEST_F(BagRecordingTest, LeftAndRightCanBeExchanged) {
  const auto path = WriteProjected(Wire::kRos1, {.azimuth_deg = {-10.0, 5.0, 20.0}});
  const auto recording = OpenBagRecording(path, {.message = {.mirrored = true}});
  ExpectAngles(recording->info().sonar.axes.beam_azimuth_rad, {-20.0, -5.0, 10.0});
  EXPECT_THAT(recording->ReadFrame(0).image.value.row(0), ElementsAre(3, 2, 1));
}

TEST_F(BagRecordingTest, BeamsAboutXAreTakenForTheFrameOfRos) {
  const auto recording =
      OpenRecording(WriteProjected(Wire::kRos1, {.azimuth_deg = {-10.0, 5.0, 20.0}, .along_x = true}));
  ExpectAngles(recording->info().sonar.axes.beam_azimuth_rad, {-10.0, 5.0, 20.0});
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("X is read as forward, Y as left")));
}

TEST_F(BagRecordingTest, RangesThatBeginAtZeroAreEdges) {
  const auto recording = OpenRecording(WriteProjected(Wire::kRos1, {.range_m = {0.0F, 0.5F, 1.0F, 1.5F}}));
  EXPECT_EQ(recording->info().sonar.axes.range_min_m, 0.0);
  EXPECT_NEAR(recording->info().sonar.axes.range_max_m, 2.0, 1e-6);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("near edges")));
}

TEST_F(BagRecordingTest, AProjectedSonarImageThatCannotBeIsRefused) {
  const auto refusal = [&](const MadeUpProjected& message) {
    return testing::RefusalOf(WriteProjected(Wire::kRos1, message));
  };
  EXPECT_THAT(refusal({.range_m = {1.0F, 2.0F, 4.0F, 5.0F}}), HasSubstr("only evenly spaced ranges"));
  EXPECT_THAT(refusal({.type = 10}), HasSubstr("image.dtype is 10, expected 0..9"));
  EXPECT_THAT(refusal({.beam_count = 4}), HasSubstr("image.beam_count is 4, beam_directions are 3"));
  EXPECT_THAT(refusal({.azimuth_deg = {0.0, 5.0, 3.0}}), HasSubstr("expected left to right"));
  EXPECT_THAT(refusal({.type = 1, .add = 200}), HasSubstr("expected 0 or more"));
  const std::string whole = MadeUpProjected{}.Write(Wire::kRos1);
  const auto longer = Write(Wire::kRos1, {{"/sonar", kProjectedType, 5, whole + "x"}});
  EXPECT_THAT(testing::RefusalOf(longer), HasSubstr("1 bytes are left, expected none"));
}

TEST_F(BagRecordingTest, AnOculusPingIsReadFromEitherBag) {
  for (const Wire wire : testing::kWires) {
    const auto recording = OpenRecording(WritePing(wire, {}));
    const RecordingInfo& info = recording->info();
    EXPECT_EQ(info.sonar.name, "Oculus M1200d");
    EXPECT_EQ(info.sonar.frequency_hz, 2.1e6);
    EXPECT_EQ(info.sonar.sound_speed_m_per_s, 1466.0);
    ASSERT_TRUE(info.water);
    EXPECT_EQ(info.water->temperature_c, 12.5);
    EXPECT_EQ(info.water->salinity_ppt, 0.5);
    EXPECT_NEAR(*info.display_gamma, 127.0 / 255.0, 1e-12);
    EXPECT_THAT(info.details, AllOf(Contains(Pair("gain", "35 %")), Contains(Pair("range setting", "10 m"))));
    EXPECT_DOUBLE_EQ(*recording->frame_info(0).time_s, 1'600'000'000.5);
    const Frame frame = recording->ReadFrame(0);
    EXPECT_EQ(frame.image.axes.range_min_m, 0.0);
    EXPECT_EQ(frame.image.axes.range_max_m, 1.0);
    ExpectAngles(frame.image.axes.beam_azimuth_rad, {-10.0, 0.0, 15.0});
    EXPECT_THAT(frame.image.value.values(), ElementsAre(0, 1, 2, 20, 21, 22, 40, 41, 42, 60, 61, 62));
  }
}

TEST_F(BagRecordingTest, LaterOculusPingsHaveThePictureLast) {
  for (const Wire wire : testing::kWires) {
    const auto raw = OpenRecording(WritePing(wire, {.layout = MadeUpOculusPing::Layout::kImageLast}));
    EXPECT_EQ(raw->ReadFrame(0).image.value(3, 1), 61.0F);
    EXPECT_EQ(raw->info().sonar.frequency_hz, 0.0);
    EXPECT_EQ(raw->info().sonar.sound_speed_m_per_s, 1490.0);
    EXPECT_THAT(raw->info().notes, Contains(HasSubstr("the one that was asked for")));
  }
}

TEST_F(BagRecordingTest, CompressedOculusPingsAreDecoded) {
  cv::Mat grey(4, 3, CV_8UC1);
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 3; ++col) grey.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(50 * row);
  }
  for (const std::string format : {".png", ".jpg"}) {
    std::vector<std::uint8_t> encoded;
    cv::imencode(format, grey, encoded);
    const auto recording =
        OpenRecording(WritePing(Wire::kRos1, {.layout = MadeUpOculusPing::Layout::kCompressedLast,
                                              .compressed = std::string(encoded.begin(), encoded.end())}));
    // JPEG loses a little.
    EXPECT_NEAR(recording->ReadFrame(0).image.value(2, 1), 100.0F, format == ".png" ? 0.0 : 6.0);
  }
  EXPECT_THAT(testing::RefusalOf(WritePing(Wire::kRos1, {.layout = MadeUpOculusPing::Layout::kCompressedLast,
                                                         .compressed = "GIF89a"})),
              HasSubstr("'mono8; png compressed ', expected PNG or JPEG"));
}

TEST_F(BagRecordingTest, AnOculusPingThatCannotBeIsRefused) {
  const auto refusal = [&](const MadeUpOculusPing& message) {
    return testing::RefusalOf(WritePing(Wire::kCdrLittle, message));
  };
  EXPECT_THAT(refusal({.encoding = "rgb8"}), HasSubstr("encoding 'rgb8', expected mono8"));
  EXPECT_THAT(refusal({.width = 4}), HasSubstr("4 x 4 pixels, expected 4 ranges x 3 beams"));
  EXPECT_THAT(refusal({.bearings = {0, 1}}), HasSubstr("3 beams and 2 bearings"));
}

TEST_F(BagRecordingTest, TopicsAreListedAndOneIsChosen) {
  for (const Wire wire : testing::kWires) {
    const std::vector<MadeUpMessage> messages = {
        {"/left", kProjectedType, 3, MadeUpProjected{.add = 7}.Write(wire)},
        {"/odom", "nav_msgs/Odometry", 4, "?"},
        {"/right", kProjectedType, 5, MadeUpProjected{}.Write(wire)},
        {"/left", kProjectedType, 9, MadeUpProjected{.seconds = 0, .nanoseconds = 0}.Write(wire)}};
    const auto path = Write(wire, messages);
    EXPECT_THAT(testing::RefusalOf(path),
                AllOf(HasSubstr("2 topics of sonars"), HasSubstr("--topic"),
                      HasSubstr("/left (marine_acoustic_msgs/ProjectedSonarImage, 2 "
                                "messages), /right")));
    const auto left = OpenBagRecording(path, {.topic = "/left"});
    ASSERT_EQ(left->frame_count(), 2);
    EXPECT_EQ(left->ReadFrame(0).image.value(0, 0), 7.0F);
    // Without a stamp, the time at which it was recorded.
    EXPECT_DOUBLE_EQ(*left->frame_info(1).time_s, 9e-9);
    EXPECT_THAT(left->info().details,
                AllOf(Contains(Pair("topic", "/left")),
                      Contains(Pair("other topic /odom", "nav_msgs/Odometry, 1 message"))));
    EXPECT_THROW(OpenBagRecording(path, {.topic = "/odom"}), DataError);
    EXPECT_THROW(OpenBagRecording(path, {.topic = "/up"}), DataError);
  }
  EXPECT_THAT(testing::RefusalOf(Write(Wire::kRos1, {{"/odom", "nav_msgs/Odometry", 4, "?"}})),
              HasSubstr("no topic of a sonar; expected one of"));
}

TEST_F(BagRecordingTest, SonarsOfPointsAndTopicsWithoutMessagesAreNamed) {
  for (const std::string type : {"sensor_msgs/PointCloud", "sensor_msgs/PointCloud2"}) {
    const auto path = Write(Wire::kRos1, {{"/scan", type, 4, "?"}, {"/odom", "nav_msgs/Odometry", 4, "?"}});
    EXPECT_THAT(testing::RefusalOf(path),
                HasSubstr("no topic of a sonar; /scan (" + type +
                          ", 1 message) has points, as drivers of mechanically scanning sonars write them, "
                          "which have neither beams nor range bins; expected one of marine_acoustic_msgs"));
    EXPECT_THAT(testing::MessageOf([&] { OpenBagRecording(path, {.topic = "/scan"}); }),
                HasSubstr("topic '/scan' has points (" + type + "), as drivers of mechanically"));
  }
  testing::WriteRos2Bag(dir_ / "empty.db3", {{"/sonar", kProjectedType, 1, "?"}}, "DELETE FROM messages");
  EXPECT_THAT(
      testing::RefusalOf(dir_ / "empty.db3"),
      HasSubstr("/sonar (marine_acoustic_msgs/ProjectedSonarImage, 0 messages) is a sonar's topic without"));
}

// A real bag of a mechanically scanning sonar, and the folder that holds it.
TEST_F(BagRecordingTest, ARealScanningSonarIsNamed) {
  SONARCAL_NEEDS_RECORDING(folder, "ros1_micron_bag");
  for (const auto& path : {folder, folder / "static_sonar.bag"}) {
    EXPECT_THAT(testing::RefusalOf(path),
                AllOf(HasSubstr("static_sonar.bag: no topic of a sonar; /tritech_micron/scan "
                                "(sensor_msgs/PointCloud, 553 messages) has points"),
                      HasSubstr("/tritech_micron/heading (geometry_msgs/PoseStamped, 554 messages)"),
                      Not(HasSubstr("\n"))));
  }
}

TEST_F(BagRecordingTest, RealBagsWithoutImagesSayWhatTheyHold) {
  SONARCAL_NEEDS_RECORDING(folder, "ros2_oculus_db3");
  EXPECT_THAT(testing::RefusalOf(folder / "my_bag_0.db3"),
              AllOf(HasSubstr("no topic of a sonar"),
                    HasSubstr("the bag has chatter (std_msgs/String, 0 messages)")));
  // The driver published 17 pings without the sonar's own data.
  EXPECT_THAT(testing::RefusalOf(folder / "rosbag2_2022_11_18-23_20_16_0.db3"),
              HasSubstr("/topic: message 0: data has 0 bytes, expected the sonar's own message; none of the "
                        "first 17 messages can be read"));
}

TEST_F(BagRecordingTest, CompressedChunksAreInflated) {
  std::vector<MadeUpMessage> messages;
  for (int i = 0; i < 5; ++i)
    messages.push_back({"/sonar", kProjectedType, i, MadeUpProjected{.add = i}.Write(Wire::kRos1)});
  for (const std::string compression : {"bz2", "lz4"}) {
    const auto recording = OpenRecording(Write(Wire::kRos1, messages, {.compression = compression}));
    ASSERT_EQ(recording->frame_count(), 5);
    for (const int i : {4, 0, 3, 1, 2}) EXPECT_EQ(recording->ReadFrame(i).image.value(0, 0), i);
  }
}

TEST_F(BagRecordingTest, ABagThatWasCutOffIsReadAsFarAsItGoes) {
  std::vector<MadeUpMessage> messages;
  for (int i = 0; i < 6; ++i)
    messages.push_back({"/sonar", kProjectedType, i, MadeUpProjected{}.Write(Wire::kRos1)});
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const std::string bytes =
        testing::Ros1BagBytes(messages, {.compression = compression, .with_end = false});
    testing::WriteFile(dir_ / "cut.bag", bytes.substr(0, bytes.size() - 30));
    const auto recording = OpenRecording(dir_ / "cut.bag");
    EXPECT_EQ(recording->frame_count(), 4) << compression;
    EXPECT_THAT(recording->info().notes, AllOf(Contains(HasSubstr("are no whole record")),
                                               Contains(HasSubstr("1 chunk has no index behind it"))));
  }
}

TEST_F(BagRecordingTest, FilesOfAFolderAreOneBag) {
  std::filesystem::create_directory(dir_ / "dive");
  for (const int i : {10, 9}) {
    testing::WriteRos2Bag(dir_ / "dive" / ("dive_" + std::to_string(i) + ".db3"),
                          {{"/sonar", kProjectedType, i, MadeUpProjected{.add = i}.Write(Wire::kCdrLittle)}});
  }
  testing::WriteFile(dir_ / "dive" / "metadata.yaml", "rosbag2_bagfile_information:\n");
  const auto recording = OpenRecording(dir_ / "dive");
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->ReadFrame(0).image.value(0, 0), 9.0F);
  EXPECT_EQ(recording->ReadFrame(1).image.value(0, 0), 10.0F);
}

class BagFolderTest : public BagRecordingTest {
 protected:
  // Writes a bag of one message with this first sample into the folder.
  void WriteSplit(const std::string& name, int sample) {
    const std::vector<MadeUpMessage> messages = {
        {"/sonar", kProjectedType, sample, MadeUpProjected{.add = sample}.Write(Wire::kCdrLittle)}};
    if (name.ends_with(".mcap")) {
      testing::WriteFile(dir_ / name, testing::McapBytes(messages, {}));
    } else {
      testing::WriteRos2Bag(dir_ / name, messages);
    }
  }
};

TEST_F(BagFolderTest, IndependentBagsAreListed) {
  WriteSplit("morning_0.db3", 1);
  WriteSplit("other_sonar_0.db3", 2);
  EXPECT_THAT(testing::RefusalOf(dir_.path()),
              HasSubstr("the folder holds 2 recordings, expected the path of one of them: morning_0.db3, "
                        "other_sonar_0.db3"));
  EXPECT_EQ(OpenRecording(dir_ / "other_sonar_0.db3")->ReadFrame(0).image.value(0, 0), 2.0F);
}

TEST_F(BagFolderTest, FilesOfBothStoragesAreListed) {
  WriteSplit("dive_0.db3", 1);
  WriteSplit("dive_0.mcap", 2);
  EXPECT_THAT(testing::RefusalOf(dir_.path()), HasSubstr("holds 2 recordings"));
}

TEST_F(BagFolderTest, FilesThatTheMetadataListAreOneBag) {
  WriteSplit("morning_0.db3", 1);
  WriteSplit("renamed_1.db3", 2);
  const std::string metadata = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - morning_0.db3\n";
  testing::WriteFile(dir_ / "metadata.yaml", metadata);
  EXPECT_THAT(testing::RefusalOf(dir_.path()), HasSubstr("holds 2 recordings"));
  testing::WriteFile(dir_ / "metadata.yaml", metadata + "    - renamed_1.db3\n");
  const auto recording = OpenRecording(dir_.path());
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->ReadFrame(1).image.value(0, 0), 2.0F);
  testing::WriteFile(dir_ / "metadata.yaml", "[");
  EXPECT_THAT(testing::RefusalOf(dir_.path()), HasSubstr("holds 2 recordings"));
}

// A real folder of two bags, which were recorded on different days.
TEST_F(BagFolderTest, TwoRealBagsAreListed) {
  SONARCAL_NEEDS_RECORDING(folder, "ros2_oculus_db3");
  EXPECT_THAT(testing::RefusalOf(folder), AllOf(HasSubstr("my_bag_0.db3"), HasSubstr("rosbag2_2022_11_18")));
}

TEST_F(BagRecordingTest, BagsThatCannotBeReadAreRefusedByName) {
  testing::WriteFile(dir_ / "old.bag", "#ROSBAG V1.2\n");
  EXPECT_THAT(testing::RefusalOf(dir_ / "old.bag"), HasSubstr("expected \"#ROSBAG V2.0\""));
  EXPECT_THAT(testing::RefusalOf(Write(Wire::kRos1, {}, {.encrypted = true})), HasSubstr("encrypted"));
  // A file name that would be an option of the address by which SQLite opens it.
  const auto odd = dir_ / "a?mode=rwc#%20.db3";
  testing::WriteRos2Bag(odd, {{"/sonar", kProjectedType, 1, MadeUpProjected{}.Write(Wire::kCdrLittle)}});
  EXPECT_EQ(OpenRecording(odd)->frame_count(), 1);
}

}  // namespace
}  // namespace sonarcal::data_io
