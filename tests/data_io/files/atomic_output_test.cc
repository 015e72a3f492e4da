#include "data_io/files/atomic_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/types/error.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::MessageOf;
using testing::ReadFile;
using testing::TempDir;
using testing::WriteFile;

std::size_t EntryCount(const fs::path& directory) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

TEST(WriteFileWholeTest, ReplacesAFileAndLeavesNothingAside) {
  const TempDir dir;
  WriteFileWhole(dir / "a", "one");
  WriteFileWhole(dir / "a", std::string_view("two\0", 4));
  EXPECT_EQ(ReadFile(dir / "a"), std::string("two\0", 4));
  EXPECT_EQ(EntryCount(dir.path()), 1u);
}

TEST(WriteFileWholeTest, AMissingDirectoryIsNamed) {
  const TempDir dir;
  EXPECT_THAT(MessageOf([&] { WriteFileWhole(dir / "no" / "a", "x"); }),
              HasSubstr("no/a: cannot be written: No such file or directory"));
}

TEST(WriteFileWholeTest, DirectoriesAndDevicesAreNotReplaced) {
  const TempDir dir;
  EXPECT_THAT(MessageOf([&] { WriteFileWhole(dir.path(), "x"); }),
              HasSubstr("there is a directory of this name"));
  EXPECT_THAT(MessageOf([&] { WriteFileWhole("/dev/null", "x"); }),
              HasSubstr("there is a device of this name"));
}

TEST(OutputDirectoryTest, ANewDirectoryAppearsOnCommit) {
  const TempDir dir;
  const fs::path out = dir / "deep" / "out";
  OutputDirectory output(out);
  WriteFile(output / "a", "1");
  EXPECT_FALSE(fs::exists(out));
  output.Commit();
  EXPECT_EQ(ReadFile(out / "a"), "1");
  EXPECT_EQ(EntryCount(out.parent_path()), 1u);
}

TEST(OutputDirectoryTest, WithoutCommitNothingStays) {
  const TempDir dir;
  {
    OutputDirectory output(dir / "deep" / "deeper" / "out/");
    WriteFile(output / "a", "1");
  }
  EXPECT_EQ(EntryCount(dir.path()), 0u);
  {
    fs::create_directory(dir / "out");
    OutputDirectory output(dir / "out");
    WriteFile(output / "a", "1");
  }
  EXPECT_EQ(EntryCount(dir / "out"), 0u);
}

TEST(OutputDirectoryTest, FilesOfTheSameNameAreReplacedAndOthersLeft) {
  const TempDir dir;
  WriteFile(dir / "a", "old a");
  WriteFile(dir / "b", "old b");
  OutputDirectory output(dir.path());
  WriteFile(output / "a", "new a");
  fs::create_directory(output / "sub");
  WriteFile(output / "sub/c.json", "new c");
  EXPECT_EQ(ReadFile(dir / "a"), "old a");
  output.Commit();
  EXPECT_EQ(ReadFile(dir / "a"), "new a");
  EXPECT_EQ(ReadFile(dir / "b"), "old b");
  EXPECT_EQ(ReadFile(dir / "sub" / "c.json"), "new c");
}

TEST(OutputDirectoryTest, ADirectoryInTheWayIsRefusedBeforeAnythingMoves) {
  const TempDir dir;
  fs::create_directory(dir / "b");
  OutputDirectory output(dir.path());
  WriteFile(output / "a", "1");
  WriteFile(output / "b", "1");
  EXPECT_THAT(MessageOf([&] { output.Commit(); }), HasSubstr("/b: cannot be written: there is a directory"));
  EXPECT_FALSE(fs::exists(dir / "a"));
}

TEST(OutputDirectoryTest, AFileIsNoOutputDirectory) {
  const TempDir dir;
  WriteFile(dir / "a", "1");
  EXPECT_THAT(MessageOf([&] { OutputDirectory(dir / "a"); }), HasSubstr("it is a file"));
  EXPECT_THAT(MessageOf([&] { OutputDirectory(dir / "a" / "b"); }), HasSubstr("cannot be written"));
}

TEST(OutputDirectoryTest, ALaterRunFindsTheFilesKeptAside) {
  const TempDir dir;
  const fs::path out = dir / "deep" / "out";
  {
    OutputDirectory output(out, Aside::kAnew);
    EXPECT_FALSE(output.found());
    WriteFile(output / "a", "1");
    output.Keep();
  }
  EXPECT_FALSE(fs::exists(out));
  for (int look = 0; look < 2; ++look) {  // without Commit() they stay
    OutputDirectory output(out, Aside::kFound);
    EXPECT_TRUE(output.found());
    EXPECT_EQ(ReadFile(output / "a"), "1");
    WriteFile(output / ".b.partial-1-0", "not whole");
  }
  OutputDirectory output(out, Aside::kFound);
  WriteFile(output / "c", "2");
  output.Commit();
  EXPECT_EQ(EntryCount(out), 2u);
  EXPECT_EQ(ReadFile(out / "a"), "1");
  EXPECT_EQ(EntryCount(out.parent_path()), 1u);
}

TEST(OutputDirectoryTest, FilesNotKeptAreRemovedAndANewStartForgetsKeptOnes) {
  const TempDir dir;
  const fs::path out = dir / "out";
  { WriteFile(OutputDirectory(out, Aside::kAnew) / "a", "1"); }
  { WriteFile(OutputDirectory(out, Aside::kFound) / "a", "1"); }
  EXPECT_EQ(EntryCount(dir.path()), 0u);
  for (int run = 0; run < 2; ++run) {
    OutputDirectory output(out, Aside::kAnew);
    EXPECT_TRUE(fs::is_empty(output.staging()));
    WriteFile(output / "a", "1");
    output.Keep();
  }
}

TEST(OutputDirectoryTest, ASecondRunAtTheSameTimeIsRefused) {
  const TempDir dir;
  OutputDirectory output(dir / "out", Aside::kAnew);
  WriteFile(output / "a", "1");
  for (const Aside aside : {Aside::kAnew, Aside::kFound}) {
    EXPECT_THAT(MessageOf([&] { OutputDirectory(dir / "out", aside); }),
                HasSubstr("another run is writing it"));
  }
  output.Commit();
  EXPECT_EQ(ReadFile(dir / "out" / "a"), "1");
}

TEST(OutputDirectoryTest, TheFinalPathIsAbsoluteAndPlain) {
  const TempDir dir;
  EXPECT_EQ(OutputDirectory(dir / "x/../out/").final_path(), dir / "out");
}

}  // namespace
}  // namespace sonarcal::data_io
