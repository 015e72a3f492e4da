#include "data_io/open_recording.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <utility>

#include "core/types/error.h"
#include "data_io/images/image_io.h"
#include "data_io/recordings/recording_io.h"
#include "tests/data_io/hostile.h"
#include "tests/support/recordings.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(OpenRecording, NamesAPathThatDoesNotExist) {
  EXPECT_THAT([] { OpenRecording("no/such/recording"); },
              ThrowsMessage<DataError>("no/such/recording: no such file or folder"));
}

TEST(OpenRecording, AnUnknownFileIsRefusedWithTheListOfFormats) {
  const testing::TempDir dir;
  testing::WriteFile(dir / "notes.txt", "not a recording");
  testing::WriteFile(dir / "empty", "");
  for (const auto& path : {dir.path(), dir / "notes.txt", dir / "empty"}) {
    EXPECT_THAT([&] { OpenRecording(path); },
                ThrowsMessage<DataError>(AllOf(HasSubstr("not a recording of a known format"),
                                               HasSubstr("recording.json"), HasSubstr(".aris"),
                                               HasSubstr("Oculus"), HasSubstr("DIDSON"))))
        << path;
  }
}

TEST(OpenRecording, NoFileIsTakenForARecordingByItsFirstLettersAlone) {
  const testing::TempDir dir;
  // Both begin as a format's magic number does.
  testing::WriteFile(dir / "text", "SO far, this is a text and no Oculus message.");
  testing::WriteFile(dir / "short", "DDF\x05");
  EXPECT_THAT([&] { OpenRecording(dir / "text"); }, ThrowsMessage<DataError>(HasSubstr("known format")));
  EXPECT_THAT([&] { OpenRecording(dir / "short"); },
              ThrowsMessage<DataError>(HasSubstr("data end at byte 4")));
}

TEST(OpenRecording, AFolderIntoWhichARunHasMovedAPartIsRefused) {
  const testing::TempDir dir;
  std::filesystem::create_directories(dir / "out/.out.partial-moving");
  testing::WriteFile(dir / "out/recording.json", "{}");
  for (const char* name : {"out", "out/", "out/recording.json", "out/../out"}) {
    EXPECT_THAT([&] { OpenRecording(dir / name); },
                ThrowsMessage<DataError>(HasSubstr("only a part of its files")))
        << name;
  }
}

// Fits take 1 for a grey level, so floats of 0..1 would be black or white.
TEST(OpenRecording, GreyValuesWithoutLevelsAreReadAs16Bits) {
  const testing::TempDir dir;
  RecordingInfo info;
  info.source = "memory";
  info.sonar = {.name = "Small",
                .frequency_hz = 900e3,
                .axes = {0.5, 2.5, 2, {-0.1, 0.1}},
                .azimuth_beam_width_deg = 1.0,
                .elevation_beam_width_deg = 20.0,
                .sound_speed_m_per_s = 1480.0};
  info.scale.full_scale = 1.0;
  Grid<float> value(2, 2);
  value(0, 1) = 1.0F;
  value(1, 0) = 0.3F;
  WriteRecording(MemoryRecording(info, {{{"a", 0.0, {}}, {info.sonar.axes, info.scale, value}}}),
                 dir / "out");
  const auto recording = OpenRecording(dir / "out");
  EXPECT_EQ(recording->info().scale.full_scale, 65535.0);
  EXPECT_THAT(recording->info().notes,
              ::testing::Contains(HasSubstr("without levels are read as 0 .. 65535")));
  const Frame frame = recording->ReadFrame(0);
  EXPECT_EQ(frame.image.scale, recording->info().scale);
  EXPECT_EQ(frame.image.value(0, 0), 0.0F);
  EXPECT_EQ(frame.image.value(0, 1), 65535.0F);
  EXPECT_FLOAT_EQ(frame.image.value(1, 0), 0.3F * 65535.0F);
}

TEST(OpenRecording, AFrameOfARecordingIsRefusedWithTheNameOfItsFolder) {
  const testing::TempDir dir;
  RecordingInfo info;
  info.sonar.axes = {
      .range_min_m = 1.0, .range_max_m = 2.0, .range_bins = 8, .beam_azimuth_rad = {-0.1, 0.1}};
  const Frame frame = {{}, {info.sonar.axes, info.scale, Grid<float>(8, 2, 3.0F)}};
  WriteRecording(MemoryRecording(info, {frame}), dir / "rec");
  std::filesystem::path picture;
  for (const auto& entry : std::filesystem::directory_iterator(dir / "rec"))
    if (entry.path().extension() == ".png") picture = entry.path();
  ASSERT_FALSE(picture.empty());
  EXPECT_THAT([&] { OpenRecording(picture); },
              ThrowsMessage<DataError>(HasSubstr("a picture in the folder of a recording")));
}

TEST(OpenRecording, OpensEveryRealRecording) {
  for (const char* name :
       {"aris1200_telephoto/sample.aris", "aris3000_broken/output.aris", "oculus_m1200d/one_ping_8bit.raw",
        "didson_hull/background", "didson_hull/test", "synthetic_tank", "synthetic_tank/recording.json",
        "synthetic_tank_ghosts", "synthetic_tank_static", "synthetic_tank_poses", "neusis_pickles",
        "aris1200_telephoto"}) {
    SONARCAL_NEEDS_RECORDING(path, name);
    EXPECT_TRUE(testing::OpensWholly(path)) << name;
  }
}

// A file with the magic number of ARIS and nothing else.
void WriteBrokenAris(const std::filesystem::path& file) {
  testing::WriteFile(file, "DDF\x05xx");
}

TEST(LocateRecording, AFolderThatHoldsOneRecordingStandsForIt) {
  const testing::TempDir dir;
  testing::WriteFile(dir / "LICENSE", "free");
  testing::WriteFile(dir / "table.csv", "a,b");
  testing::WriteFile(dir / ".hidden.aris", "DDF\x05xx");
  EXPECT_EQ(LocateRecording(dir.path()), dir.path());  // none
  WriteBrokenAris(dir / "dive.aris");
  EXPECT_EQ(LocateRecording(dir.path()), dir / "dive.aris");
  EXPECT_EQ(LocateRecording(dir / "dive.aris"), dir / "dive.aris");
  EXPECT_EQ(LocateRecording(dir / "absent"), dir / "absent");
  // Its own reader refuses it, by its own name.
  EXPECT_THAT([&] { OpenRecording(dir.path()); }, ThrowsMessage<DataError>(HasSubstr("dive.aris")));
  // Photographs beside it are no recordings.
  WritePng(dir / "photo.png", Grid<std::uint8_t>(4, 4, 9));
  EXPECT_EQ(LocateRecording(dir.path()), dir / "dive.aris");
  // A folder with its own format is that recording, whatever else it holds.
  testing::WriteFile(dir / "recording.json", "{}");
  EXPECT_EQ(LocateRecording(dir.path()), dir.path());
}

// A user without the rights of root.
TEST(LocateRecording, AFileThatCannotBeReadHidesNoRecording) {
  const testing::TempDir dir;
  std::filesystem::permissions(dir.path(), std::filesystem::perms(0755));
  WriteBrokenAris(dir / "dive.aris");
  testing::WriteFile(dir / "notes.txt", "not for everybody");
  std::filesystem::permissions(dir / "notes.txt", std::filesystem::perms::none);
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (geteuid() == 0 && setuid(kNobody) != 0) _exit(2);
    try {
      _exit(LocateRecording(dir.path()) == dir / "dive.aris" ? 0 : 1);
    } catch (...) {
      _exit(3);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(LocateRecording, ASubfolderCountsAndSeveralAreListed) {
  const testing::TempDir dir;
  std::filesystem::create_directory(dir / "b");
  testing::WriteFile(dir / "b/recording.json", "{}");
  std::filesystem::create_directory(dir / "pictures");
  WritePng(dir / "pictures/photo.png", Grid<std::uint8_t>(4, 4, 9));
  EXPECT_EQ(LocateRecording(dir.path()), dir / "b");
  WriteBrokenAris(dir / "a.aris");
  EXPECT_THAT([&] { OpenRecording(dir.path()); },
              ThrowsMessage<DataError>(
                  HasSubstr("the folder holds 2 recordings, expected the path of one of them: a.aris, b")));
  for (int i = 0; i < 30; ++i) WriteBrokenAris(dir / fmt::format("c{:02}.aris", i));
  EXPECT_THAT([&] { OpenRecording(dir.path()); },
              ThrowsMessage<DataError>(AllOf(HasSubstr("holds 32 recordings"), HasSubstr("c17.aris, ..."))));
}

TEST(LocateRecording, RealFoldersOpenWithANote) {
  for (const auto& [folder, file] :
       {std::pair("aris1200_telephoto", "sample.aris"), std::pair("oculus_m1200d", "one_ping_8bit.raw"),
        std::pair("aris3000_broken", "output.aris")}) {
    SONARCAL_NEEDS_RECORDING(path, folder);
    const auto recording = OpenRecording(path);
    EXPECT_EQ(recording->info().notes.at(0),
              fmt::format("The folder holds one recording, {}, which was opened.", file));
    EXPECT_EQ(recording->info().source, (path / file).string());
    EXPECT_EQ(recording->frame_count(), OpenRecording(path / file)->frame_count());
  }
}

TEST(LocateRecording, ARealFolderOfSeveralIsRefusedWithTheirNames) {
  SONARCAL_NEEDS_RECORDING(folder, "didson_hull");
  EXPECT_THAT(testing::RefusalOf(folder),
              HasSubstr("holds 2 recordings, expected the path of one of them: background, test"));
}

}  // namespace
}  // namespace sonarcal::data_io
