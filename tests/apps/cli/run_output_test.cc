// Output folders: what a second run leaves of the first, and which folders a command does not touch.
#include "apps/cli/run_output.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/types/error.h"
#include "data_io/pose_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TempDir;
using testing::TinyWorld;
using ::testing::UnorderedElementsAre;
using testing::WriteFile;

std::vector<std::string> FilesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) names.push_back(entry.path().lexically_relative(folder).string());
  }
  return names;
}

// A run of `command` that writes these files, each of them saying by whom.
void MakeRun(const fs::path& folder, const std::string& command, const std::vector<std::string>& names,
             bool force = false) {
  RunOutput output(folder, command, force);
  for (const std::string& name : names) {
    fs::create_directories((output / name).parent_path());
    WriteFile(output / name, command);
  }
  WriteFile(output / "provenance.json",
            fmt::format(R"({{"program": "sonarcal", "command": "{}", "inputs": []}})", command));
  output.Commit();
}

TEST(RunOutput, ASecondRunLeavesNothingOfTheFirst) {
  const TempDir dir;
  MakeRun(dir / "out", "compare", {"a.json", "pictures/1.png", "pictures/2.png", "more/deep/3.png"});
  MakeRun(dir / "out", "compare", {"a.json", "pictures/1.png", "b.json"});
  EXPECT_THAT(FilesIn(dir / "out"),
              UnorderedElementsAre("a.json", "b.json", "pictures/1.png", "provenance.json"));
  EXPECT_FALSE(fs::exists(dir.path() / "out/more"));
}

TEST(RunOutput, FilesOfOthersStay) {
  const TempDir dir;
  MakeRun(dir / "out", "compare", {"a.json", "pictures/1.png"});
  WriteFile(dir.path() / "out/notes.txt", "mine");
  WriteFile(dir.path() / "out/pictures/mine.png", "mine");
  MakeRun(dir / "out", "compare", {"b.json"});
  EXPECT_THAT(FilesIn(dir / "out"),
              UnorderedElementsAre("b.json", "notes.txt", "pictures/mine.png", "provenance.json"));
}

TEST(RunOutput, AFolderOfAnotherOriginIsRefusedWithoutForce) {
  const TempDir dir;
  fs::create_directory(dir / "mine");
  WriteFile(dir.path() / "mine/.hidden", "");
  MakeRun(dir / "mine", "fit", {"a.json"});  // as good as empty
  fs::create_directory(dir / "theirs");
  WriteFile(dir.path() / "theirs/notes.txt", "mine");
  WriteFile(dir.path() / "theirs/a.json", "mine");
  EXPECT_THAT([&] { MakeRun(dir / "theirs", "fit", {"a.json"}); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("no provenance.json that lists them")));
  EXPECT_EQ(testing::ReadFile(dir.path() / "theirs/a.json"), "mine");
  MakeRun(dir / "theirs", "fit", {"a.json"}, /*force=*/true);
  EXPECT_THAT(FilesIn(dir / "theirs"), UnorderedElementsAre("a.json", "notes.txt", "provenance.json"));
  EXPECT_EQ(testing::ReadFile(dir.path() / "theirs/a.json"), "fit");

  EXPECT_THAT([&] { MakeRun(dir / "mine", "compare", {"a.json"}); },
              ::testing::ThrowsMessage<DataError>(HasSubstr("holds the outputs of 'sonarcal fit'")));
  EXPECT_THROW(CheckOutFolder(dir / "mine", "compare", false), DataError);
  CheckOutFolder(dir / "mine", "compare", true);
  CheckOutFolder(dir / "absent", "compare", false);
}

// provenance.json is a file that anybody can change.
TEST(RunOutput, NothingOutsideTheFolderIsRemoved) {
  const TempDir dir;
  WriteFile(dir / "precious.txt", "mine");
  fs::create_directory(dir / "elsewhere");
  WriteFile(dir.path() / "elsewhere/precious.txt", "mine");
  MakeRun(dir / "out", "fit", {"a.json"});
  fs::create_directory_symlink(dir / "elsewhere", dir.path() / "out/link");
  WriteFile(dir.path() / "out/provenance.json",
            fmt::format(R"({{"program": "sonarcal", "command": "fit", "outputs": ["../precious.txt", "{}",
                        "link/precious.txt", "", ".", "..", 7, "a.json"]}})",
                        (dir / "precious.txt").string()));
  MakeRun(dir / "out", "fit", {"b.json"});
  EXPECT_TRUE(fs::exists(dir / "precious.txt"));
  EXPECT_TRUE(fs::exists(dir.path() / "elsewhere/precious.txt"));
  EXPECT_FALSE(fs::exists(dir.path() / "out/a.json"));
}

// Written by nobody who can be trusted, or by an earlier version.
TEST(RunOutput, AProvenanceThatListsNothingIsNone) {
  for (const char* text : {"", "nonsense", "[]", R"({"program": "sonarcal", "command": "fit"})",
                           R"({"program": "other", "command": "fit", "outputs": []})",
                           R"({"program": "sonarcal", "command": 3, "outputs": []})"}) {
    const TempDir dir;
    WriteFile(dir / "provenance.json", text);
    EXPECT_THROW(MakeRun(dir.path(), "fit", {"a.json"}), DataError) << text;
  }
}

TEST(RunOutput, ARunThatFailsLeavesTheFirst) {
  const TempDir dir;
  MakeRun(dir / "out", "fit", {"a.json", "b.json"});
  {
    RunOutput output(dir / "out", "fit", false);
    WriteFile(output / "a.json", "new");
  }
  EXPECT_THAT(FilesIn(dir / "out"), UnorderedElementsAre("a.json", "b.json", "provenance.json"));
  EXPECT_EQ(testing::ReadFile(dir.path() / "out/a.json"), "fit");
}

TEST(RunOutput, SimulationsAndTheirPicturesAreReplacedWhole) {
  const TinyWorld world;
  const std::string out = " -q --out " + Quoted(world / "sim");
  ASSERT_EQ(RunSonarcal(world.SimulateArguments() + " --fan --depth" + out).status, 0);
  std::vector<data_io::TimedPose> poses = data_io::ReadPoses(world.poses());
  poses.resize(2);
  data_io::WritePoses(world.poses(), poses);
  ASSERT_EQ(RunSonarcal(world.SimulateArguments() + out).status, 0);
  EXPECT_THAT(FilesIn(world / "sim"), UnorderedElementsAre("frame_0000.png", "frame_0001.png", "params.json",
                                                           "provenance.json", "recording.json"));

  const Outcome other = RunSonarcal("convert " + Quoted(world / "sim") + out);
  EXPECT_EQ(other.status, 1);
  EXPECT_TRUE(IsOneSentence(other.err)) << other.err;
  EXPECT_THAT(other.err, HasSubstr("holds the outputs of 'sonarcal simulate'"));
  EXPECT_EQ(RunSonarcal("convert " + Quoted(world / "sim") + out + " --force").status, 0);
  EXPECT_TRUE(fs::exists(world / "sim/params.json")) << "what convert does not write stays";
}

}  // namespace
}  // namespace sonarcal::cli
