#include "data_io/recordings/recording_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include <nlohmann/json.hpp>

#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/json/json_fields.h"
#include "tests/data_io/refusal.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MessageOf;
using testing::ReadFile;
using testing::TempDir;
using testing::WriteFile;

RecordingInfo SmallInfo() {
  RecordingInfo info;
  info.source = "memory";
  info.sonar = {.name = "Small",
                .frequency_hz = 900e3,
                .axes = {0.5, 2.5, 4, {RadFromDeg(-1.5), RadFromDeg(0.25), RadFromDeg(1.5)}},
                .azimuth_beam_width_deg = 1.0,
                .elevation_beam_width_deg = 20.0,
                .sound_speed_m_per_s = 1480.0};
  return info;
}

// Frames whose pixels count up from `first`.
MemoryRecording SmallRecording(const RecordingInfo& info, int frames, float first = 0.0F) {
  std::vector<Frame> all;
  for (int i = 0; i < frames; ++i) {
    Frame frame{
        {fmt::format("frame {}", i), 0.1 * i, Pose{RotationFromYawPitchRoll(0.1 * i, 0, 0), {1.0 * i, 2, 3}}},
        {info.sonar.axes, info.scale, Grid<float>(info.sonar.axes.range_bins, info.sonar.axes.beam_count())}};
    float value = first + static_cast<float>(i);
    for (float& pixel : frame.image.value.values()) pixel = value++;
    all.push_back(std::move(frame));
  }
  return {info, std::move(all)};
}

TEST(OpenRecordingOf, ReadsImagesOfAnotherFolder) {
  const TempDir dir;
  WriteRecording(SmallRecording(SmallInfo(), 2), dir / "whole");
  fs::create_directories(dir / "described");
  fs::rename(dir / "whole/recording.json", dir / "described/recording.json");
  const auto recording = OpenRecordingOf(dir / "whole", dir / "described");
  EXPECT_EQ(recording->info().source, (dir / "whole").string());
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->ReadFrame(1).image.value(0, 1), 2.0F);
  EXPECT_THROW(OpenRecordingOf(dir / "described", dir / "described")->ReadFrame(0), DataError);
}

// A folder with a recording.json that tests may change, and its one frame.
class RecordingFolderTest : public ::testing::Test {
 protected:
  RecordingFolderTest() { WritePng(dir_ / "a.png", Grid<std::uint8_t>(4, 3, 7)); }

  static std::string Text() {
    return R"({"format": "sonar-recording/1",
"sonar": {"name": "P", "frequency_hz": 900000,
 "beam_azimuth_deg": [-1, 0, 1.5],
 "azimuth_beam_width_deg": 1.0, "elevation_beam_width_deg": 20.0, "sound_speed_m_per_s": 1465.94,
 "range_min_m": 0.62, "range_max_m": 9.0,
 "range_bins": 4},
"image": {"layout": "polar", "bits": 8,
 "db_min": 0, "db_max": 80},
"frames": [{"file": "a.png", "time_s": 0.5,
 "world_from_sonar": {"position_m": [1, 2, 3],
  "quaternion_wxyz": [1, 0, 0, 0]}}]})";
  }

  void Write(std::string_view from = "", std::string_view to = "") {
    std::string text = Text();
    const std::size_t at = text.find(from);
    ASSERT_NE(at, text.npos) << from;
    WriteFile(dir_ / "recording.json", text.replace(at, from.size(), to));
  }

  std::unique_ptr<RecordingSource> Open(std::string_view from = "", std::string_view to = "") {
    Write(from, to);
    return OpenRecordingFolder(dir_.path());
  }

  // What is said of the recording with one piece of its text replaced, from "recording.json" on.
  std::string RefusalOf(std::string_view from, std::string_view to) {
    Write(from, to);
    const std::string message = MessageOf([&] { OpenRecordingFolder(dir_.path())->ReadFrame(0); });
    const std::size_t at = message.find("recording.json:");
    return at == std::string::npos ? message : message.substr(at);
  }

  TempDir dir_;
};

TEST_F(RecordingFolderTest, EveryFieldOfTheFileIsRead) {
  const auto recording = Open();
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.format, "sonar-recording/1");
  EXPECT_EQ(info.sonar.name, "P");
  EXPECT_EQ(info.sonar.axes.range_bins, 4);
  EXPECT_DOUBLE_EQ(info.sonar.axes.beam_azimuth_rad[2], RadFromDeg(1.5));
  EXPECT_EQ(info.scale, (ImageScale{Quantity::kGrey, 255.0, 0.0, 80.0, std::nullopt}));
  EXPECT_FALSE(info.water);
  EXPECT_FALSE(info.synthetic);
  EXPECT_THAT(info.notes, IsEmpty());
  ASSERT_EQ(recording->frame_count(), 1);
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.info.name, "a.png");
  EXPECT_EQ(frame.info.time_s, 0.5);
  EXPECT_EQ(frame.info.world_from_sonar->position_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(frame.image.value, Grid<float>(4, 3, 7.0F));
}

TEST_F(RecordingFolderTest, HowBeamsAreFormedIsReadAndWritten) {
  EXPECT_EQ(Open()->info().sonar.beam_forming, BeamForming::kUnknown);
  for (const auto& [word, forming] : WordsOf(std::type_identity<BeamForming>{})) {
    RecordingInfo info =
        Open("\"range_bins\": 4", fmt::format("\"range_bins\": 4, \"beam_forming\": \"{}\"", word))->info();
    EXPECT_EQ(info.sonar.beam_forming, forming);
    EXPECT_EQ(SonarJson(info.sonar)["beam_forming"], word);
    info.sonar.beam_forming = BeamForming::kUnknown;
    EXPECT_EQ(SonarJson(info.sonar).count("beam_forming"), 0U);
  }
  EXPECT_THAT(RefusalOf("\"range_bins\": 4", "\"range_bins\": 4, \"beam_forming\": \"mirror\""),
              HasSubstr("beam_forming"));
}

TEST_F(RecordingFolderTest, PingsAndMotionAreReadAndWritten) {
  EXPECT_EQ(Open()->info().sonar.pings, PingPattern());
  EXPECT_EQ(Open()->frame_info(0).motion, std::nullopt);
  constexpr const char* kPings = R"("range_bins": 4, "pings": {"of_beam": [1, 0, 1], "period_s": 0.004})";
  const auto with_pings = Open("\"range_bins\": 4", kPings);
  EXPECT_THAT(with_pings->info().notes, IsEmpty());
  EXPECT_EQ(with_pings->info().sonar.pings, (PingPattern{.of_beam = {1, 0, 1}, .period_s = 0.004}));

  RecordingInfo info = SmallInfo();
  info.sonar.pings = {.of_beam = {0, 1, 2}, .period_s = 0.00712, .first_s = -0.01};
  MemoryRecording recording = SmallRecording(info, 2);
  std::vector<Frame> frames = {recording.ReadFrame(0), recording.ReadFrame(1)};
  frames[1].info.motion = Motion{.velocity_m_per_s = {0.1, 0.2, -0.3},
                                 .turn_rate_rad_per_s = {0.0, RadFromDeg(-4.0), RadFromDeg(30.0)}};
  WriteRecording(MemoryRecording(info, frames), dir_ / "moving");
  const auto read = OpenRecordingFolder(dir_ / "moving");
  EXPECT_THAT(read->info().notes, IsEmpty());
  EXPECT_EQ(read->info().sonar.pings, info.sonar.pings);
  EXPECT_EQ(read->frame_info(0).motion, std::nullopt);
  EXPECT_EQ(read->ReadFrame(1).info.motion, frames[1].info.motion);
}

TEST_F(RecordingFolderTest, DamagedPingsAndMotionAreRefused) {
  const auto pings = [&](const std::string& text) {
    return RefusalOf("\"range_bins\": 4", "\"range_bins\": 4, \"pings\": " + text);
  };
  EXPECT_THAT(pings("{}"), HasSubstr("of_beam"));
  EXPECT_THAT(pings(R"({"of_beam": [0, 1]})"), HasSubstr("has 2 numbers, expected one per beam, 3"));
  EXPECT_THAT(pings(R"({"of_beam": [0, 1, 3]})"), HasSubstr("sonar.pings.of_beam[2]"));
  EXPECT_THAT(pings(R"({"of_beam": [0, 1, -1]})"), HasSubstr("sonar.pings.of_beam[2]"));
  EXPECT_THAT(pings(R"({"of_beam": [0, 0.5, 1]})"), HasSubstr("sonar.pings.of_beam[1]"));
  EXPECT_THAT(pings(R"({"of_beam": [0, 1, 2], "period_s": 0})"), HasSubstr("sonar.pings.period_s"));
  EXPECT_THAT(pings(R"({"of_beam": [0, 1, 2], "first_s": 1e9})"), HasSubstr("sonar.pings.first_s"));
  const auto motion = [&](const std::string& text) {
    return RefusalOf("\"time_s\": 0.5", "\"time_s\": 0.5, \"motion\": " + text);
  };
  EXPECT_THAT(motion(R"({"velocity_m_per_s": [0, 1]})"), HasSubstr("has 2 numbers, expected 3"));
  EXPECT_THAT(motion(R"({"velocity_m_per_s": [0, 1, 2000]})"), HasSubstr("velocity_m_per_s[2]"));
  EXPECT_THAT(motion(R"({"turn_rate_deg_per_s": [0, "fast", 0]})"), HasSubstr("turn_rate_deg_per_s[1]"));
}

TEST_F(RecordingFolderTest, TheFileItselfMayBeNamed) {
  Write();
  EXPECT_TRUE(IsRecordingFolder(dir_.path()));
  EXPECT_TRUE(IsRecordingFolder(dir_ / "recording.json"));
  EXPECT_FALSE(IsRecordingFolder(dir_ / "a.png"));
  EXPECT_EQ(OpenRecordingFolder(dir_ / "recording.json")->ReadFrame(0).image.value(0, 0), 7.0F);
}

TEST_F(RecordingFolderTest, UnknownFieldsAreNoted) {
  const auto recording = Open(R"("frequency_hz": 900000,)", "");
  EXPECT_EQ(recording->info().sonar.frequency_hz, 0.0);
  EXPECT_THAT(recording->info().notes, Contains("recording.json has no 'sonar.frequency_hz': unknown"));
}

TEST_F(RecordingFolderTest, KeysOfOtherProgramsAreNotedOnceEach) {
  const auto recording =
      Open(R"({"file": "a.png", )", R"({"file": "a.png", "gain": 1}, {"file": "a.png", "gain": 2, )");
  EXPECT_EQ(recording->frame_count(), 2);
  EXPECT_THAT(
      recording->info().notes,
      Contains("recording.json:9: key 'frames[].gain' (2 times) is not known here and has no effect"));
}

TEST_F(RecordingFolderTest, ASyntheticRecordingIsRecognised) {
  EXPECT_TRUE(Open("\"frames\"", "\"synthetic\": true, \"frames\"")->info().synthetic);
  EXPECT_TRUE(Open("\"frames\"", "\"generator\": \"a simulation\", \"frames\"")->info().synthetic);
  WriteFile(dir_ / "truth.json", "{}");
  EXPECT_TRUE(Open()->info().synthetic);
}

TEST_F(RecordingFolderTest, ASceneIsFoundBesideTheRecording) {
  WriteFile(dir_ / "scene.gltf", "{}");
  EXPECT_EQ(Open("\"frames\"", "\"scene\": \"scene.gltf\", \"frames\"")->info().scene_path,
            dir_ / "scene.gltf");
  EXPECT_THAT(Open("\"frames\"", "\"scene\": \"no.gltf\", \"frames\"")->info().notes,
              Contains(HasSubstr("no.gltf, which does not exist")));
}

TEST_F(RecordingFolderTest, MistakesAreNamedWithTheirLine) {
  EXPECT_EQ(RefusalOf("recording/1", "recording/2"),
            "recording.json:1: 'format' is \"sonar-recording/2\", expected one of sonar-recording/1");
  EXPECT_EQ(RefusalOf("[-1, 0, 1.5]", "[-1, 0, 0]"),
            "recording.json:3: 'sonar.beam_azimuth_deg[2]' is 0, expected more than the beam to its left, 0");
  EXPECT_EQ(RefusalOf("[-1, 0, 1.5]", "[-1, null, 1]"),
            "recording.json:3: 'sonar.beam_azimuth_deg[1]' is null, expected a number >= -180 and <= 180");
  EXPECT_EQ(RefusalOf("[-1, 0, 1.5]", "[0]"),
            "recording.json:3: 'sonar.beam_azimuth_deg' has 1 beams, expected at least 2");
  EXPECT_EQ(RefusalOf("\"range_max_m\": 9.0", "\"range_max_m\": 0.5"),
            "recording.json:5: 'sonar.range_max_m' is 0.5, expected more than range_min_m, 0.62");
  EXPECT_EQ(RefusalOf("\"range_bins\": 4", "\"range_bins\": 1000000000"),
            "recording.json:6: 'sonar.range_bins' is 1000000000, expected an integer from 1 to 22369621");
  EXPECT_EQ(RefusalOf("\"bits\": 8", "\"bits\": 12"),
            "recording.json:7: 'image.bits' is 12, expected 8, 16 or 32 (float)");
  EXPECT_EQ(RefusalOf("\"db_max\": 80", "\"db_max\": 0"),
            "recording.json:8: 'image.db_max' is 0, expected more than db_min, 0");
  EXPECT_EQ(RefusalOf("\"db_max\": 80", "\"db_max\": 80, \"db_span\": 60"),
            "recording.json:8: 'image.db_span' is 60, expected db_max - db_min, 80");
  EXPECT_EQ(RefusalOf("\"range_bins\": 4", "\"range_bins\": 4, \"beam_taper\": [1, 1]"),
            "recording.json:6: 'sonar.beam_taper' has 2 numbers, expected one per beam, 3");
  EXPECT_EQ(RefusalOf("\"range_bins\": 4", "\"range_bins\": 4.5"),
            "recording.json:6: 'sonar.range_bins' is 4.5, expected an integer from 1 to 22369621");
}

TEST_F(RecordingFolderTest, FanImagesAreRefusedInWords) {
  EXPECT_EQ(RefusalOf("\"polar\"", "\"fan\""),
            "recording.json:7: 'image.layout' is \"fan\", which cannot be read; expected \"polar\": convert "
            "the images "
            "to range by beam");
}

TEST_F(RecordingFolderTest, NoFrameLeavesTheFolder) {
  for (const char* name :
       {"../a.png", "/etc/passwd", "sub/a.png", "..", ".", "", "a\\\\b.png", "a\\u0000.png"}) {
    EXPECT_THAT(RefusalOf("\"a.png\"", fmt::format("\"{}\"", name)),
                HasSubstr("recording.json:9: 'frames[0].file' is \""))
        << name;
  }
}

TEST_F(RecordingFolderTest, QuaternionsMustBeNearUnitLength) {
  const auto recording = Open("[1, 0, 0, 0]", "[1.0005, 0, 0, 0]");
  EXPECT_DOUBLE_EQ(recording->frame_info(0).world_from_sonar->rotation.norm(), 1.0);
  EXPECT_EQ(
      RefusalOf("[1, 0, 0, 0]", "[1, 1, 0, 0]"),
      "recording.json:11: 'frames[0].world_from_sonar.quaternion_wxyz' has length 1.41421, expected a unit "
      "quaternion");
}

TEST_F(RecordingFolderTest, ImagesMustFitTheHeader) {
  WritePng(dir_ / "a.png", Grid<std::uint8_t>(3, 4));
  EXPECT_THAT(RefusalOf("", ""),
              HasSubstr("a.png: 8-bit grey, 3 x 4 pixels (rows x columns), expected 8-bit grey, "
                        "4 x 3 pixels (rows x columns) as in recording.json"));
  WritePng(dir_ / "a.png", Grid<std::uint16_t>(4, 3));
  EXPECT_THAT(RefusalOf("", ""), HasSubstr("a.png: 16-bit grey"));
  WritePng(dir_ / "a.png", RgbImage(4, 3));
  EXPECT_THAT(RefusalOf("", ""), HasSubstr("a.png: 8-bit colour"));
  fs::remove(dir_ / "a.png");
  EXPECT_THAT(RefusalOf("", ""), HasSubstr("a.png: no such file"));
}

TEST_F(RecordingFolderTest, WhichSamplesAreValidStandsInAPicture) {
  EXPECT_EQ(Open()->info().valid, std::nullopt);
  const auto name = [](const char* file) { return fmt::format(R"("bits": 8, "valid": "{}",)", file); };
  Grid<std::uint8_t> picture(4, 3, 255);
  picture(3, 0) = 0;
  WritePng(dir_ / "which.png", picture);
  const std::optional<Mask> valid = Open("\"bits\": 8,", name("which.png"))->info().valid;
  ASSERT_TRUE(valid);
  EXPECT_EQ(CountSet(*valid), 11);
  EXPECT_EQ((*valid)(3, 0), 0);

  WritePng(dir_ / "narrow.png", Grid<std::uint8_t>(4, 2, 255));
  EXPECT_THAT(RefusalOf("\"bits\": 8,", name("narrow.png")), HasSubstr("expected"));
  WritePng(dir_ / "none.png", Grid<std::uint8_t>(4, 3, 0));
  EXPECT_THAT(RefusalOf("\"bits\": 8,", name("none.png")), HasSubstr("no sample is valid"));
  EXPECT_THAT(RefusalOf("\"bits\": 8,", name("../which.png")), HasSubstr("the plain name of a file"));
}

TEST_F(RecordingFolderTest, ValuesMustFitTheScale) {
  WritePng(dir_ / "a.png", Grid<std::uint16_t>(4, 3, 4096));
  EXPECT_THAT(RefusalOf("\"bits\": 8", "\"bits\": 16, \"full_scale\": 4095"),
              HasSubstr("a.png: the pixel in row 0, column 0 is 4096, expected 0 .. full_scale, 4095"));
  Grid<float> value(4, 3, 0.5F);
  WriteTiff(dir_ / "a.png", value);  // the content counts, not the name
  EXPECT_EQ(Open("\"bits\": 8", "\"bits\": 32")->ReadFrame(0).image.value, value);
  value(2, 1) = std::numeric_limits<float>::quiet_NaN();
  WriteTiff(dir_ / "a.png", value);
  EXPECT_THAT(RefusalOf("\"bits\": 8", "\"bits\": 32, \"quantity\": \"decibel\""),
              HasSubstr("the pixel in row 2, column 1 is nan, expected a finite number"));
}

TEST_F(RecordingFolderTest, DamagedHeadersAreReadOrRefused) {
  testing::ExpectSurvivesDamage(Text(), 100, 400, [&](const std::string& text) {
    WriteFile(dir_ / "recording.json", text);
    const auto recording = OpenRecordingFolder(dir_.path());
    for (int i = 0; i < recording->frame_count(); ++i) recording->ReadFrame(i);
  });
}

// Where a gain was changed while recording, the frame says so; the others have the recording's.
TEST(WriteRecordingTest, FramesKeepTheirOwnSettings) {
  const TempDir dir;
  RecordingInfo info = SmallInfo();
  info.settings.gain_db = 18.0;
  std::vector<Frame> frames;
  for (int i = 0; i < 2; ++i) {
    frames.push_back(SmallRecording(info, 2).ReadFrame(i));
    frames.back().info.settings = info.settings;
  }
  frames[1].info.settings.gain_db = 20.0;
  WriteRecording(MemoryRecording(info, frames), dir / "out");
  const auto read = OpenRecordingFolder(dir / "out");
  EXPECT_EQ(read->frame_info(0).settings.gain_db, 18.0);
  EXPECT_EQ(read->frame_info(1).settings.gain_db, 20.0);
  EXPECT_EQ(read->frame_info(1).settings.compression, std::nullopt);
}

TEST(WriteRecordingTest, AWrittenRecordingReadsBackWithEveryField) {
  const TempDir dir;
  RecordingInfo info = SmallInfo();
  info.scale = {Quantity::kGrey, 255.0, -3.5, 76.5, 80.0};
  info.water = Water{4.5, 35.0, 8.0, 12.0};
  info.source_level_db = 201.5;
  info.scene_path = (dir / "scenes/tank.gltf").string();
  info.synthetic = true;
  info.azimuth_psf = {0.1, 1.0, 0.1};
  info.beam_taper = {0.9, 1.0, 0.9};
  info.display_gamma = 0.5;
  info.valid = Mask(info.sonar.axes.range_bins, info.sonar.axes.beam_count(), 1);
  (*info.valid)(0, 2) = 0;
  info.settings = {.gain_db = 18.0,
                   .pulse_length_us = 15.0,
                   .time_varied_gain = false,
                   .compression = Compression::kPower};
  info.details = {{"gain", "12 dB"}, {"gain", "13 dB"}};
  info.notes = {"a note"};
  const MemoryRecording written = SmallRecording(info, 3);
  int frames_done = 0;
  WriteRecording(written, dir / "out", {.progress = [&](int done, int) { frames_done = done; }});
  EXPECT_EQ(frames_done, 3);

  const auto read = OpenRecordingFolder(dir / "out");
  const RecordingInfo& back = read->info();
  EXPECT_EQ(back.sonar.frequency_hz, 900e3);
  EXPECT_EQ(back.sonar.axes.beam_azimuth_rad, info.sonar.axes.beam_azimuth_rad);
  EXPECT_EQ(back.scale, info.scale);
  EXPECT_EQ(back.water, info.water);
  EXPECT_EQ(back.source_level_db, info.source_level_db);
  EXPECT_EQ(back.scene_path, info.scene_path);
  EXPECT_TRUE(back.synthetic);
  EXPECT_EQ(back.azimuth_psf, info.azimuth_psf);
  EXPECT_EQ(back.beam_taper, info.beam_taper);
  EXPECT_EQ(back.display_gamma, info.display_gamma);
  EXPECT_EQ(back.valid, info.valid);
  EXPECT_EQ(back.settings, info.settings);
  EXPECT_EQ(back.details, info.details);
  EXPECT_THAT(back.notes, Contains("a note"));
  ASSERT_EQ(read->frame_count(), 3);
  for (int i = 0; i < 3; ++i) {
    const Frame frame = read->ReadFrame(i);
    EXPECT_EQ(frame.image.value, written.ReadFrame(i).image.value);
    EXPECT_EQ(frame.info.time_s, written.frame_info(i).time_s);
    EXPECT_EQ(frame.info.world_from_sonar->position_m, written.frame_info(i).world_from_sonar->position_m);
  }
}

TEST(WriteRecordingTest, StoppedItNamesTheFramesThereAreAndLaterOnlyTheRestAreRead) {
  const TempDir dir;
  const MemoryRecording written = SmallRecording(SmallInfo(), 4);
  WriteRecording(written, dir / "whole");
  std::vector<int> read_frames;
  const auto write = [&](int frames_before_stop) {
    read_frames.clear();
    OutputDirectory output(dir / "out");
    const int frames = WriteRecording(
        written, output,
        {.progress = [&](int done, int) { read_frames.push_back(done - 1); },
         .is_written = [&](int,
                           const std::string& file) { return std::filesystem::exists(dir / "out" / file); },
         .stop = [&] { return static_cast<int>(read_frames.size()) == frames_before_stop; }});
    if (frames > 0) output.Commit();
    return frames;
  };
  EXPECT_EQ(write(0), 0);
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  EXPECT_EQ(write(2), 2);
  const auto half = OpenRecordingFolder(dir / "out");
  EXPECT_EQ(half->frame_count(), 2);
  EXPECT_THAT(half->info().notes, Contains("unfinished: 2 of 4 frames"));
  EXPECT_EQ(half->ReadFrame(1).image.value, written.ReadFrame(1).image.value);
  EXPECT_EQ(write(-1), 4);
  EXPECT_EQ(read_frames, (std::vector<int>{2, 3}));
  for (const char* file : {"recording.json", "frame_0001.png", "frame_0003.png"}) {
    EXPECT_EQ(testing::ReadFile(dir / "out" / file), testing::ReadFile(dir / "whole" / file)) << file;
  }
}

TEST(WriteRecordingTest, BitsFollowTheScale) {
  const TempDir dir;
  RecordingInfo info = SmallInfo();
  info.scale.full_scale = 4095.0;
  WriteRecording(SmallRecording(info, 1, 4000.0F), dir / "12");
  EXPECT_EQ(ImageFile(dir / "12/frame_0000.png").header().bits, 16);
  EXPECT_EQ(OpenRecordingFolder(dir / "12")->ReadFrame(0).image.value(3, 2), 4011.0F);
  EXPECT_THAT(MessageOf([&] { WriteRecording(SmallRecording(info, 1), dir / "x", {.bits = 8}); }),
              HasSubstr("do not fit 8 bits, expected 16"));

  info.scale.quantity = Quantity::kPower;
  WriteRecording(SmallRecording(info, 1, -0.5F), dir / "power");
  const auto power = OpenRecordingFolder(dir / "power");
  EXPECT_EQ(power->info().scale.quantity, Quantity::kPower);
  EXPECT_EQ(power->ReadFrame(0).image.value(0, 0), -0.5F);
}

// The second of three frames has fractions, so that the image of the first one must be replaced.
TEST(WriteRecordingTest, GreyValuesThatAreNotWholeAreWrittenAsFloats) {
  const TempDir dir;
  for (const double full_scale : {1.0, 255.0, 4095.0}) {
    RecordingInfo info = SmallInfo();
    info.scale.full_scale = full_scale;
    std::vector<Frame> frames;
    for (int i = 0; i < 3; ++i) {
      frames.push_back(SmallRecording(info, 3).ReadFrame(i));
      for (float& pixel : frames[i].image.value.values())
        pixel = i == 1 ? pixel / 16.0F : std::min(pixel, 1.0F);
    }
    const std::string name = fmt::format("{}", full_scale);
    WriteRecording(MemoryRecording(info, frames), dir / name);
    const auto read = OpenRecordingFolder(dir / name);
    EXPECT_EQ(read->info().scale, info.scale);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(read->frame_info(i).name, fmt::format("frame_000{}.tiff", i));
      EXPECT_EQ(read->ReadFrame(i).image.value, frames[i].image.value) << full_scale << " " << i;
      EXPECT_FALSE(fs::exists(dir / name / fmt::format("frame_000{}.png", i)));
    }
  }
}

TEST(WriteRecordingTest, GreyValuesAreRoundedToBitsThatAreAskedFor) {
  const TempDir dir;
  WriteRecording(SmallRecording(SmallInfo(), 1, 0.75F), dir / "out", {.bits = 8});
  EXPECT_EQ(OpenRecordingFolder(dir / "out")->ReadFrame(0).image.value(0, 2), 3.0F);
}

TEST(WriteSonarFileTest, ANameThatIsNotUtf8IsReplaced) {
  const TempDir dir;
  RecordingInfo info = SmallInfo();
  info.sonar.name = "d\xe9p";
  WriteSonarFile(dir / "sonar.json", info);
  EXPECT_EQ(ReadSonarFile(dir / "sonar.json").sonar.name, "d\xef\xbf\xbdp");
}

TEST(WriteRecordingTest, RecordingsThatCannotBeReadBackAreNotWritten) {
  const TempDir dir;
  const RecordingInfo info = SmallInfo();
  EXPECT_THAT(MessageOf([&] { WriteRecording(SmallRecording(info, 0), dir / "x"); }),
              HasSubstr("memory: no frames"));
  EXPECT_THAT(MessageOf([&] { WriteRecording(SmallRecording(info, 2, 244.0F), dir / "x"); }),
              HasSubstr("memory: frame 1: the pixel in row 3, column 2 is 256"));
  std::vector<Frame> frames = {SmallRecording(info, 1).ReadFrame(0), SmallRecording(info, 1).ReadFrame(0)};
  frames[1].image.axes.range_max_m = 3.0;
  EXPECT_THAT(MessageOf([&] { WriteRecording(MemoryRecording(info, frames), dir / "x"); }),
              HasSubstr("memory: frame 1 differs from the first: range windows"));
  frames[1] = frames[0];
  frames[1].image.scale.db_span = 40.0;
  EXPECT_THAT(MessageOf([&] { WriteRecording(MemoryRecording(info, frames), dir / "x"); }),
              HasSubstr("memory: frame 1 differs from the first in the scale of its values"));
  frames[1] = frames[0];
  frames[1].info.world_from_sonar->position_m.x() = 2e9;
  EXPECT_THAT(MessageOf([&] { WriteRecording(MemoryRecording(info, frames), dir / "x"); }),
              HasSubstr("memory: cannot be written, because no command could read it: "));
  EXPECT_TRUE(fs::is_empty(dir.path()));
}

// `..` after a link is the folder above its target.
TEST(WriteRecordingTest, ASceneIsFoundThroughLinksToTheRecording) {
  const TempDir dir;
  fs::create_directories(dir / "disk/set");
  fs::create_directories(dir / "home");
  WriteFile(dir / "disk/scene.gltf", "{}");
  WriteFile(dir / "home/scene.gltf", "{}");
  RecordingInfo info = SmallInfo();
  info.scene_path = (dir / "disk/scene.gltf").string();
  fs::create_directory_symlink(dir / "disk/set", dir / "home/set");
  WriteRecording(SmallRecording(info, 1), dir / "disk/set/one");
  WriteRecording(SmallRecording(info, 1), dir / "home/set/two");
  for (const fs::path& folder : {dir / "disk/set", dir / "home/set"}) {
    for (const char* name : {"one", "two"}) {
      const auto recording = OpenRecordingFolder(folder / name);
      EXPECT_TRUE(fs::equivalent(*recording->info().scene_path, dir / "disk/scene.gltf")) << folder << name;
      EXPECT_THAT(recording->info().notes, IsEmpty());
    }
  }
}

TEST(WriteRecordingTest, UnknownValuesStayUnknown) {
  const TempDir dir;
  RecordingInfo info = SmallInfo();
  info.sonar.elevation_beam_width_deg = 0.0;
  info.format = "ARIS v5";
  WriteRecording(SmallRecording(info, 1), dir / "a");
  const auto once = OpenRecordingFolder(dir / "a");
  EXPECT_EQ(once->info().sonar.elevation_beam_width_deg, 0.0);
  EXPECT_THAT(once->info().details,
              Contains(std::pair<std::string, std::string>("original format", "ARIS v5")));
  WriteRecording(*once, dir / "b");
  EXPECT_EQ(OpenRecordingFolder(dir / "b")->info().notes, once->info().notes);
  EXPECT_EQ(ReadFile(dir / "b/frame_0000.png"), ReadFile(dir / "a/frame_0000.png"));
}

TEST(SyntheticTankTest, OpensAndSaysThatItIsSynthetic) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
  const auto recording = OpenRecordingFolder(folder);
  const RecordingInfo& info = recording->info();
  EXPECT_TRUE(info.synthetic);
  EXPECT_THAT(info.notes, IsEmpty());
  EXPECT_EQ(info.sonar.axes.beam_count(), 256);
  EXPECT_NEAR(DegFromRad(info.sonar.axes.beam_azimuth_rad.back()), 22.5, 1e-9);
  EXPECT_EQ(info.scale.db_min, 82.0);
  EXPECT_EQ(info.source_level_db, 200.0);
  EXPECT_EQ(info.scene_path, folder / "scene.gltf");
  ASSERT_EQ(recording->frame_count(), 8);
  for (int i = 0; i < recording->frame_count(); ++i) {
    const Frame frame = recording->ReadFrame(i);
    EXPECT_EQ(frame.image.value.rows(), 660);
    EXPECT_TRUE(frame.info.world_from_sonar.has_value());
  }
}

}  // namespace
}  // namespace sonarcal::data_io
