// Output folders: what a second run leaves of the first, and which folders a command does not touch.
#include "apps/cli/run_output.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <thread>

#include "core/types/error.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
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

  fs::copy(world / "sim", world / "copy");
  const Outcome other = RunSonarcal("convert " + Quoted(world / "copy") + out);
  EXPECT_EQ(other.status, 1);
  EXPECT_TRUE(IsOneSentence(other.err)) << other.err;
  EXPECT_THAT(other.err, HasSubstr("holds the outputs of 'sonarcal simulate'"));
  EXPECT_EQ(RunSonarcal("convert " + Quoted(world / "copy") + out + " --force").status, 0);
  EXPECT_TRUE(fs::exists(world / "sim/params.json")) << "what convert does not write stays";
}

// `frames` frames that all have the same grey value.
void WriteEvenRecording(const fs::path& folder, int frames, float grey) {
  RecordingInfo info;
  info.sonar.name = "test sonar";
  info.sonar.frequency_hz = 900e3;
  info.sonar.axes = {1.0, 3.0, 4, {-0.1, 0.0, 0.1}};
  info.sonar.sound_speed_m_per_s = 1500.0;
  const Frame frame = {{"", std::nullopt, std::nullopt}, {info.sonar.axes, info.scale, {4, 3, grey}}};
  data_io::WriteRecording(MemoryRecording(info, std::vector<Frame>(frames, frame)), folder);
}

std::map<std::string, std::string> Frames(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const std::string& name : FilesIn(folder)) {
    if (!name.starts_with('.') && name != "provenance.json")
      contents[name] = testing::ReadFile(folder / name);
  }
  return contents;
}

bool IsComplete(const fs::path& staged_in) {
  std::error_code error;
  for (fs::directory_iterator entry(staged_in, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename().string().starts_with(".out.partial-") &&
        fs::exists(entry->path() / "provenance.json", error))
      return true;
  }
  return false;
}

// Starts the program and sends it the signal this long after its outputs are complete, but not in place.
void EndAtCommit(const std::string& arguments, const fs::path& out, int signal,
                 std::chrono::microseconds pause) {
  const std::string command = fmt::format("exec {} {} >/dev/null 2>&1", SONARCAL_BINARY, arguments);
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  while (!IsComplete(out)) {
    if (waitpid(child, &status, WNOHANG) != 0) return;
  }
  std::this_thread::sleep_for(pause);
  kill(child, signal);
  waitpid(child, &status, 0);
}

bool HoldsHiddenFiles(const fs::path& folder) {
  return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const auto& entry) { return entry.path().filename().string().starts_with('.'); });
}

TEST(RunOutput, AConversionThatIsEndedLeavesTheOldOrTheNewRecording) {
  constexpr int kRuns = 12;
  const TempDir dir;
  const fs::path out = dir / "out";
  WriteEvenRecording(dir / "dark", 300, 10.0F);
  WriteEvenRecording(dir / "bright", 200, 200.0F);
  const auto convert = [&](const std::string& recording, const std::string& to) {
    return fmt::format("convert -q {} --out {}", Quoted(dir / recording), Quoted(dir / to));
  };
  std::map<std::string, std::map<std::string, std::string>> expected;
  for (const std::string recording : {"dark", "bright"}) {
    ASSERT_EQ(RunSonarcal(convert(recording, "of_" + recording)).status, 0);
    expected[recording] = Frames(dir / ("of_" + recording));
    expected[recording]["notes.txt"] = "mine";
  }
  ASSERT_EQ(RunSonarcal(convert("dark", "out")).status, 0);
  WriteFile(out / "notes.txt", "mine");
  for (int i = 0; i < kRuns; ++i) {
    SCOPED_TRACE(i);
    const std::string next = Frames(out) == expected["dark"] ? "bright" : "dark";
    const int signal = i % 3 == 0 ? SIGINT : SIGKILL;
    EndAtCommit(convert(next, "out"), out, signal, std::chrono::microseconds(250 * i));
    const auto frames = Frames(out);
    EXPECT_TRUE(frames == expected["dark"] || frames == expected["bright"]) << frames.size() << " files";
    // Only a killed run leaves anything, and the next one removes it.
    if (signal == SIGKILL) const RunOutput next_run(out, "convert", /*force=*/false);
    EXPECT_FALSE(HoldsHiddenFiles(dir.path()) || HoldsHiddenFiles(out));
    EXPECT_EQ(Frames(out), frames);
  }
  ASSERT_EQ(RunSonarcal(convert("bright", "out")).status, 0);
  EXPECT_EQ(Frames(out), expected["bright"]);
  EXPECT_FALSE(HoldsHiddenFiles(dir.path()) || HoldsHiddenFiles(out));
}

TEST(RunOutput, AnInterruptedCommitWritesNothing) {
  const TempDir dir;
  MakeRun(dir / "out", "fit", {"a.json"});
  RunOutput output(dir / "out", "fit", false);
  WriteFile(output / "b.json", "new");
  WriteFile(output / "provenance.json", "{}");
  const std::string staged = output.staging();
  RemoveUnfinishedOutputs();
  fs::create_directory(staged);  // a thread that has not noticed goes on
  WriteFile(output / "provenance.json", "{}");
  EXPECT_THAT([&] { output.Commit(); }, ::testing::ThrowsMessage<DataError>(HasSubstr("interrupted")));
  EXPECT_THAT(FilesIn(dir / "out"), ::testing::IsSupersetOf({"a.json", "provenance.json"}));
  EXPECT_FALSE(fs::exists(dir / "out/b.json"));
}

TEST(RunOutput, OfTwoRunsAtOnceTheLastOneWins) {
  const TempDir dir;
  RunOutput first(dir / "out", "fit", false);
  RunOutput second(dir / "out", "fit", false);
  for (RunOutput* output : {&first, &second}) {
    WriteFile(*output / (output == &first ? "first.json" : "second.json"), "");
    WriteFile(*output / "provenance.json", R"({"program": "sonarcal", "command": "fit"})");
    output->Commit();
  }
  EXPECT_THAT(FilesIn(dir / "out"), UnorderedElementsAre("second.json", "provenance.json"));
}

}  // namespace
}  // namespace sonarcal::cli
