// Long runs of the real program: ended by signals in the middle, resumed, and held to constant memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <map>
#include <thread>

#include "core/types/units.h"
#include "data_io/files/hash.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/scenes/scene_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::ReadFile;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;

// A sonar that turns on the spot.
void WriteTurningPoses(const fs::path& file, int count) {
  std::vector<data_io::TimedPose> poses;
  for (int i = 0; i < count; ++i) {
    const double yaw_deg = 20.0 * i / count;
    poses.push_back(
        {0.1 * i, {RotationFromYawPitchRoll(RadFromDeg(yaw_deg), RadFromDeg(-25.0), 0.0), {0.0, -2.5, 1.2}}});
  }
  data_io::WritePoses(file, poses);
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

// Names, and digests of contents, but for what does not decide them: the words of the command line, threads.
std::map<std::string, std::string> Contents(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name != "provenance.json") {
      contents[name] = entry.is_regular_file() ? data_io::Sha256OfFile(entry.path()) : "folder";
      continue;
    }
    nlohmann::json json = ReadJsonFile(entry.path());
    json.erase("command_line");
    json["configuration"].erase("out");
    json["configuration"].erase("threads");
    contents[name] = json.dump();
  }
  return contents;
}

// Rays of a frame that takes about as long with ThreadSanitizer as without: after a signal, a frame must end
// before the signal ends the command.
#if defined(__SANITIZE_THREAD__)
constexpr int kFewer = 4;
#else
constexpr int kFewer = 1;
#endif
constexpr int kColumns = 800 / kFewer;
constexpr int kRows = 600 / kFewer;

struct Ended {
  int wait_status = -1;
  std::int64_t peak_rss_kib = 0;
};

// `sonarcal` as a process of its own: the shell of RunSonarcal would stand between it and a signal.
// `prefix`: a program that replaces itself by sonarcal, such as nohup.
class Running {
 public:
  Running(const std::string& arguments, const fs::path& err, const std::string& prefix = "") : pid_(fork()) {
    if (pid_ != 0) return;
    [[maybe_unused]] const int niceness = nice(5);  // the test that waits for it goes first
    // A test in the background may have inherited an ignored signal.
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_DFL);
    const std::string command =
        fmt::format("exec {} {} {} >/dev/null 2>{}", prefix, SONARCAL_BINARY, arguments, Quoted(err));
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }

  // Sends the signal as soon as there is such a file; false where the process ends before.
  bool SignalOnce(const fs::path& file, int signal) const {
    siginfo_t info = {};
    while (!fs::exists(file)) {
      info.si_pid = 0;
      waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
      if (info.si_pid != 0) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return kill(pid_, signal) == 0;
  }

  // Sends the signal, whatever the process does.
  void Signal(int signal) const { kill(pid_, signal); }

  Ended Wait() const {
    Ended ended;
    rusage usage = {};
    wait4(pid_, &ended.wait_status, 0, &usage);
    ended.peak_rss_kib = usage.ru_maxrss;
    return ended;
  }

 private:
  pid_t pid_;
};

class SimulateResume : public ::testing::Test {
 protected:
  static constexpr int kFrames = 40;

  SimulateResume() { WriteTurningPoses(world_.poses(), kFrames); }

  // Slow enough to be met in the middle: some 10 ms a frame.
  std::string Arguments(const std::string& out, const std::string& extra = "") const {
    return fmt::format("{} --noise --seed 7 --fan {} --out {}",
                       Replaced(world_.SimulateArguments(), "96x200", rays_), extra, Quoted(world_ / out));
  }

  // Ends a run by the signal once this frame is there.
  int EndAt(int frame, int signal, const std::string& extra = "") {
    Running running(Arguments("out", extra), world_ / "err");
    const std::string aside = fs::exists(world_ / "out") ? "out/.out.unfinished" : ".out.unfinished";
    EXPECT_TRUE(running.SignalOnce(world_ / fmt::format("{}/frame_{:04}.png", aside, frame), signal));
    return running.Wait().wait_status;
  }

  std::map<std::string, std::string> Uninterrupted() const {
    const Outcome outcome = RunSonarcal(Arguments("whole", "-q --threads 1"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Contents(world_ / "whole");
  }

  TinyWorld world_;
  std::string rays_ = fmt::format("{}x{}", kColumns, kRows);
};

TEST_F(SimulateResume, AnInterruptionLeavesARecordingThatCanBeGoneOnWith) {
  int frames = 0;
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(world_ / "out");
    const int status = EndAt(3, signal, "-q");
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 130);
    const auto recording = data_io::OpenRecording(world_ / "out");
    frames = recording->frame_count();
    EXPECT_GE(frames, 4);
    EXPECT_LT(frames, kFrames);
    const std::string sentence = ReadFile(world_ / "err");
    EXPECT_TRUE(IsOneSentence(sentence)) << sentence;
    EXPECT_THAT(sentence, HasSubstr(fmt::format("{} of {} frames", frames, kFrames)));
    EXPECT_THAT(sentence, HasSubstr("--resume"));
    EXPECT_FALSE(fs::exists(world_ / ".out.unfinished"));
    for (int i = 0; i < frames; ++i) EXPECT_NO_THROW(recording->ReadFrame(i));
  }
  const Outcome inspected = RunSonarcal("inspect " + Quoted(world_ / "out"));
  EXPECT_EQ(inspected.status, 0) << inspected.err;
  EXPECT_THAT(inspected.out, HasSubstr(fmt::format("of {} frames", kFrames)));
  // Ended once more, further on.
  const int status = EndAt(frames + 3, SIGINT, "-q --resume");
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const Outcome resumed = RunSonarcal(Arguments("out", "-q --resume --json"));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  constexpr int kBeams = 24;
  constexpr int kColumnsOfABeam = (kColumns + kBeams - 1) / kBeams;
  EXPECT_LE(nlohmann::json::parse(resumed.out)["rays_cast"].get<std::int64_t>(),
            std::int64_t{kFrames - frames - 4} * kBeams * kColumnsOfABeam * kRows)
      << "no frame is rendered twice";
  EXPECT_EQ(Contents(world_ / "out"), Uninterrupted());
}

// As a power failure leaves them.
TEST_F(SimulateResume, FramesWithoutTheirEndAreMadeAgain) {
  const int status = EndAt(5, SIGINT, "-q");
  ASSERT_TRUE(WIFEXITED(status));
  ASSERT_EQ(WEXITSTATUS(status), 130);
  const fs::path folder = world_ / "out";
  fs::resize_file(folder / "frame_0000.png", fs::file_size(folder / "frame_0000.png") / 2);
  fs::resize_file(folder / "frame_0001.png", 0);
  const Outcome resumed = RunSonarcal(Arguments("out", "-q --resume"));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(Contents(folder), Uninterrupted());
}

TEST_F(SimulateResume, AnInterruptedSecondRunLeavesTheRecordingOfTheFirst) {
  ASSERT_EQ(RunSonarcal(Arguments("out", "-q --frames :2")).status, 0);
  const std::map<std::string, std::string> first = Contents(world_ / "out");
  const int status = EndAt(3, SIGINT, "-q");
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string sentence = ReadFile(world_ / "err");
  EXPECT_TRUE(IsOneSentence(sentence)) << sentence;
  EXPECT_THAT(sentence, HasSubstr("stays as it was"));
  std::map<std::string, std::string> kept = Contents(world_ / "out");
  EXPECT_EQ(kept.erase(".out.unfinished"), 1U);
  EXPECT_EQ(kept, first);
  const Outcome resumed = RunSonarcal(Arguments("out", "-q --resume"));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(Contents(world_ / "out"), Uninterrupted());
}

// A frame of this many rays takes many seconds.
TEST_F(SimulateResume, ASlowFrameIsGivenUpAtAnInterruption) {
  const Outcome some = RunSonarcal(Arguments("out", "-q --frames :2"));
  ASSERT_EQ(some.status, 0) << some.err;
  const std::map<std::string, std::string> before = Contents(world_ / "out");
  rays_ = "2400x30000";
  Running running(Arguments("out", "-q --model coherent"), world_ / "err");
  ASSERT_TRUE(running.SignalOnce(world_ / "out/.out.unfinished", 0));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // into the frame
  ASSERT_TRUE(running.SignalOnce(world_ / "out/.out.unfinished", SIGINT));
  const auto asked = std::chrono::steady_clock::now();
  const int status = running.Wait().wait_status;
  EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(10)) << "a frame takes longer";
  const std::string sentence = ReadFile(world_ / "err");
  ASSERT_TRUE(WIFSIGNALED(status)) << sentence;
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  EXPECT_THAT(sentence, HasSubstr("interrupted, unfinished outputs were removed"));
  EXPECT_EQ(Contents(world_ / "out"), before) << "the recording that was there stays";
  EXPECT_FALSE(fs::exists(world_ / "out/.out.unfinished"));
}

// As GNU timeout sends it: to the process, then to its group. A frame takes longer than the time between.
TEST_F(SimulateResume, TwoCopiesOfASignalAreOneInterruption) {
  rays_ = fmt::format("{}x{}", 2 * kColumns, 2 * kRows);
  Running running(Arguments("out", "-q"), world_ / "err");
  ASSERT_TRUE(running.SignalOnce(world_ / ".out.unfinished/frame_0001.png", SIGTERM));
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  running.Signal(SIGTERM);
  const int status = running.Wait().wait_status;
  ASSERT_TRUE(WIFEXITED(status)) << ReadFile(world_ / "err");
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_GE(data_io::OpenRecording(world_ / "out")->frame_count(), 2);
}

// A command that has stopped as asked is not ended by the signal while the process exits.
TEST_F(SimulateResume, AnExitMayTakeLongAfterAnInterruption) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  const std::string prefix;  // a sanitizer must be loaded first, and its exit is slow
#else
  const std::string prefix = "env LD_PRELOAD=" + Quoted(SONARCAL_SLOW_EXIT);
#endif
  Running running(Arguments("out", "-q"), world_ / "err", prefix);
  ASSERT_TRUE(running.SignalOnce(world_ / ".out.unfinished/frame_0001.png", SIGINT));
  const int status = running.Wait().wait_status;
  const std::string sentence = ReadFile(world_ / "err");
  ASSERT_TRUE(WIFEXITED(status)) << sentence;
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_TRUE(IsOneSentence(sentence)) << sentence;
}

TEST_F(SimulateResume, NohupKeepsARunGoingWhenTheTerminalCloses) {
  Running running(Arguments("out", "-q"), world_ / "err", "nohup");
  ASSERT_TRUE(running.SignalOnce(world_ / ".out.unfinished/frame_0003.png", SIGHUP));
  const int status = running.Wait().wait_status;
  ASSERT_TRUE(WIFEXITED(status)) << ReadFile(world_ / "err");
  EXPECT_EQ(WEXITSTATUS(status), 0) << ReadFile(world_ / "err");
  EXPECT_EQ(data_io::OpenRecording(world_ / "out")->frame_count(), kFrames);
}

TEST_F(SimulateResume, AKilledRunIsContinued) {
  rays_ = "384x250";  // a depth image takes longer than a frame
  const int status = EndAt(12, SIGKILL, "-q --depth");
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_FALSE(fs::exists(world_ / "out"));
  // As if it had been killed within a write.
  testing::WriteFile(world_ / ".out.unfinished/.frame_0030.png.partial-1-1", "half");
  fs::remove(world_ / ".out.unfinished/depth_0003.png");
  const Outcome resumed = RunSonarcal(Arguments("out", "-q --depth --resume --json"));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  // The image and the depth of each frame that was missing; those of frame 3 again.
  EXPECT_LE(nlohmann::json::parse(resumed.out)["rays_cast"].get<std::int64_t>(),
            2LL * (kFrames - 12) * 384 * 250);
  ASSERT_EQ(RunSonarcal(Arguments("whole", "-q --depth")).status, 0);
  EXPECT_EQ(Contents(world_ / "out"), Contents(world_ / "whole"));
  EXPECT_FALSE(fs::exists(world_ / ".out.unfinished"));
}

TEST(SimulateResumed, CompareAndFitReadAnUnfinishedRecording) {
  const TinyWorld world;
  const fs::path real = world.WriteSimulated("real", true);
  // The first two of the four frames, as an interruption leaves them.
  nlohmann::json json = ReadJsonFile(real / "recording.json");
  json["notes"] = {"unfinished: 2 of 4 frames"};
  json["frames"].erase(3);
  json["frames"].erase(2);
  testing::WriteFile(real / "recording.json", json.dump());
  EXPECT_EQ(RunSonarcal(fmt::format("compare -q --real {0} --sim {0} --out {1}", Quoted(real),
                                    Quoted(world / "comparison")))
                .status,
            0);
  EXPECT_EQ(RunSonarcal(fmt::format("fit -q --real {} --scene {} --params {} --rays 96x200 --starts 1 --free "
                                    "'display.db_max' --held-out 1 --out {}",
                                    Quoted(real), Quoted(world.scene()), Quoted(world.params()),
                                    Quoted(world / "fit")))
                .status,
            0);
}

TEST(SimulateResumed, OnlyTheSameCommandGoesOn) {
  const TinyWorld world;
  const std::string good = world.SimulateArguments() + " -q --noise --seed 3 --out " + Quoted(world / "out");
  ASSERT_EQ(RunSonarcal(good).status, 0);
  const auto made = Contents(world / "out");
  // Finished, so that the same command has nothing to do, on any number of threads.
  const Outcome again = RunSonarcal(good + " --resume --json --threads 1");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["rays_cast"], 0);
  ASSERT_EQ(RunSonarcal(good + " --resume").status, 0);
  EXPECT_EQ(Contents(world / "out"), made);

  // Another content of each input, in a file of its own.
  ParameterSet parameters = testing::TinyParameters();
  parameters.materials["box"].gsab.c *= 1.01;
  data_io::WriteParameters(world / "other_params.json", parameters);
  std::vector<data_io::TimedPose> poses = data_io::ReadPoses(world.poses());
  poses[3].world_from_sonar.position_m.z() += 1e-9;
  data_io::WritePoses(world / "other_poses.json", poses);
  Scene scene = data_io::ReadGltf(world.scene());
  scene.vertices_m[2].x() += 0.01F;
  data_io::WriteGltf(scene, world / "other_scene.gltf");
  nlohmann::json sonar = ReadJsonFile(world.sonar());
  sonar["sonar"]["range_max_m"] = 4.6;
  testing::WriteFile(world / "other_sonar.json", sonar.dump());
  const auto with = [&](const std::string& what, const std::string& by) {
    return Replaced(good + " --resume", what, by);
  };
  const std::vector<std::pair<std::string, std::string>> others = {
      {with("/scene.gltf", "/other_scene.gltf"), "other contents of 'scene'"},
      {with("/sonar.json", "/other_sonar.json"), "other contents of 'sonar'"},
      {with("/params.json", "/other_params.json"), "other contents of 'parameters'"},
      {with("/poses.json", "/other_poses.json"), "other contents of 'poses'"},
      {with("96x200", "96x201"), "rays 96x200 (now 96x201)"},
      {with("--seed 3", "--seed 4"), "seed 3 (now 4)"},
      {good + " --resume --model acoustic", "model paper (now acoustic)"},
      {good + " --resume --sampling frustum", "sampling beams (now frustum)"},
      {good + " --resume --bits 12", "bits 8 (now 12)"},
      {good + " --resume --fan", "fan false (now true)"}};
  const auto expect_refused = [](const std::string& command, const std::string& difference) {
    const Outcome outcome = RunSonarcal(command);
    EXPECT_EQ(outcome.status, 1) << command;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("cannot be resumed"));
    EXPECT_THAT(outcome.err, HasSubstr(difference));
  };
  for (const auto& [command, difference] : others) expect_refused(command, difference);
  EXPECT_EQ(Contents(world / "out"), made) << "a refusal changes nothing";

  // Options that the paper's model does not take.
  const std::string coherent = fmt::format(
      "{} -q --seed 3 --model coherent --sampling frustum --margin 1 --point-target 0:0:1:-20 --out {}",
      world.SimulateArguments(), Quoted(world / "coherent"));
  ASSERT_EQ(RunSonarcal(coherent).status, 0);
  EXPECT_EQ(RunSonarcal(coherent + " --resume").status, 0);
  expect_refused(Replaced(coherent + " --resume", "--margin 1", "--margin 2"), "margin 1 (now 2)");
  expect_refused(Replaced(coherent + " --resume", "0:0:1:-20", "0:0:1:-30"),
                 R"(point_target ["0:0:1:-20"] (now ["0:0:1:-30"]))");
  expect_refused(Replaced(coherent + " --resume", " --point-target 0:0:1:-20", ""),
                 R"(point_target ["0:0:1:-20"] (now none))");

  fs::remove(world / "out/provenance.json");
  const Outcome unknown = RunSonarcal(good + " --resume");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_TRUE(IsOneSentence(unknown.err)) << unknown.err;
  // Where nothing is, there is everything to do.
  fs::remove_all(world / "out");
  EXPECT_EQ(RunSonarcal(good + " --resume").status, 0);
  EXPECT_EQ(Contents(world / "out"), made);
}

// Frames of 512 beams x 1000 bins, 2 MB each in memory: kept, 45 of them would be 90 MB.
TEST(SimulateResumed, MemoryDoesNotGrowWithTheSequence) {
  const TinyWorld world;
  nlohmann::json sonar = ReadJsonFile(world.sonar());
  sonar["sonar"]["range_bins"] = 1000;
  sonar["sonar"]["beam_azimuth_deg"].clear();
  for (int beam = 0; beam < 512; ++beam) sonar["sonar"]["beam_azimuth_deg"].push_back(0.1 * (beam - 255.5));
  testing::WriteFile(world.sonar(), sonar.dump());
  const auto peak_rss_kib = [&](int frames) {
    WriteTurningPoses(world.poses(), frames);
    const std::string arguments =
        fmt::format("{} -q --threads 1 --out {}", Replaced(world.SimulateArguments(), "96x200", "512x200"),
                    Quoted(world / std::to_string(frames)));
    const Ended ended = Running(arguments, world / "err", testing::kFreeSoon).Wait();
    EXPECT_EQ(ended.wait_status, 0) << ReadFile(world / "err");
    return ended.peak_rss_kib;
  };
  const std::int64_t of_five = peak_rss_kib(5);
  const std::int64_t of_fifty = peak_rss_kib(50);
  RecordProperty("peak_rss_kib_5", std::to_string(of_five));
  RecordProperty("peak_rss_kib_50", std::to_string(of_fifty));
  EXPECT_LT(of_fifty, of_five + 8 * 1024) << of_five << " KiB for 5 frames, " << of_fifty << " KiB for 50";
}

}  // namespace
}  // namespace sonarcal::commands
