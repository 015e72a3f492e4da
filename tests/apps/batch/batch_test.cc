// `sonarcal batch`: killed and run again it ends with what it would have ended with, and does nothing twice.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "tests/apps/tiny_world.h"

namespace sonarcal::batch {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using Json = nlohmann::json;

// Each job's events, in the order of the ledger.
std::map<std::string, std::vector<std::string>> EventsOf(const fs::path& out) {
  std::map<std::string, std::vector<std::string>> events;
  std::ifstream ledger(out / "ledger.jsonl");
  for (std::string line; std::getline(ledger, line) && !ledger.eof();) {
    const Json json = Json::parse(line);
    events[json.at("job")].push_back(json.at("event"));
  }
  return events;
}

int CountOf(const fs::path& out, const std::string& event) {
  int count = 0;
  for (const auto& [job, events] : EventsOf(out))
    count += static_cast<int>(std::count(events.begin(), events.end(), event));
  return count;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// Every output of a batch by its path, with one name for the batch's folder; but for what has hashes of
// inputs that name it.
std::map<std::string, std::string> OutputsOf(const fs::path& out, const std::vector<std::string>& entries) {
  const std::set<std::string> leave_out = {"provenance.json", "report.html"};
  std::map<std::string, std::string> outputs;
  for (const std::string& entry : entries) {
    for (const auto& file : fs::recursive_directory_iterator(out / entry)) {
      if (file.is_regular_file() && !leave_out.contains(file.path().filename().string()))
        outputs[fs::relative(file.path(), out).string()] =
            Replaced(testing::ReadFile(file.path()), out.string(), "OUT");
    }
  }
  return outputs;
}

class BatchTest : public ::testing::Test {
 protected:
  // Four simulations, each compared with a recording.
  void WritePlan(const std::string& rays = "96x200", const std::string& seeds = "1, 2") {
    recorded_ = world_.WriteSimulated("recorded", /*noise=*/true);
    testing::WriteFile(world_ / "plan.json", fmt::format(R"({{"format": "sonarcal-batch/1", "entries": [
      {{"name": "sim", "command": "simulate",
        "options": {{"scene": "scene.gltf", "sonar": "sonar.json", "params": "params.json", "poses": "poses.json",
                    "rays": "{}", "bits": 12, "noise": true, "sampling": ["beams", "frustum"], "seed": [{}]}}}},
      {{"name": "judged", "command": "compare", "for_each": "sim",
        "options": {{"real": "recorded", "sim": "{{out}}", "pictures": "{{seed}}"}}}}]}})",
                                                         rays, seeds));
  }

  // One recording, simulated and compared whole, and in ranges that are merged.
  void WriteRangesPlan() {
    recorded_ = world_.WriteSimulated("recorded", /*noise=*/true);
    testing::WriteFile(world_ / "plan.json", R"({"format": "sonarcal-batch/1", "entries": [
      {"name": "sim", "command": "simulate",
       "options": {"scene": "scene.gltf", "sonar": "sonar.json", "params": "params.json", "poses": "recorded",
                   "rays": "192x400", "bits": 12, "noise": true,
                   "frames": {"from": 0, "to": 4, "step": 1}}},
      {"name": "part", "command": "compare", "for_each": "sim",
       "options": {"real": "recorded", "sim": "{out}", "frames": "{frames}", "part": true, "pictures": 0,
                   "scene": "scene.gltf"}},
      {"name": "judged", "command": "compare", "for_all": "part",
       "options": {"real": "recorded", "merge": "{out}", "scene": "scene.gltf"}}]})");
  }

  // The comparison of all frames by one program.
  Json ComparedWhole() const {
    EXPECT_EQ(
        RunSonarcal(fmt::format("simulate -q --scene {} --sonar {} --params {} --poses {} --rays 192x400 "
                                "--bits 12 --noise --out {}",
                                Quoted(world_.scene()), Quoted(world_.sonar()), Quoted(world_.params()),
                                Quoted(recorded_), Quoted(world_ / "all")))
            .status,
        0);
    EXPECT_EQ(
        RunSonarcal(fmt::format("compare -q --real {} --sim {} --scene {} --out {}", Quoted(recorded_),
                                Quoted(world_ / "all"), Quoted(world_.scene()), Quoted(world_ / "compared")))
            .status,
        0);
    return ReadJsonFile(world_ / "compared" / "metrics.json");
  }

  std::string Batch(const std::string& out, const std::string& more = "") const {
    return fmt::format("batch {} --out {} {}", Quoted(world_ / "plan.json"), Quoted(world_ / out), more);
  }

  // Starts the program, and kills it once the ledger has so many jobs done and another begun.
  void KillAfter(const std::string& out, int done) const {
    const pid_t process = fork();
    if (process == 0) {
      execl(SONARCAL_BINARY, "sonarcal", "batch", (world_ / "plan.json").c_str(), "--out",
            (world_ / out).c_str(), "--quiet", nullptr);
      _exit(127);
    }
    for (int i = 0; i < 6000; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (CountOf(world_ / out, "done") >= done &&
          CountOf(world_ / out, "started") > CountOf(world_ / out, "done"))
        break;
    }
    kill(process, SIGKILL);
    int status = 0;
    waitpid(process, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "ended before it was killed";
  }

  testing::TinyWorld world_;
  fs::path recorded_;
};

TEST_F(BatchTest, RunsEveryCombinationAndTheComparisonsAfterThem) {
  WritePlan();
  const Outcome outcome = RunSonarcal(Batch("out", "--jobs 2"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("of 8 jobs 8 done, 0 failed, 0 not run"));
  const Json summary = ReadJsonFile(world_ / "out" / "summary.json");
  ASSERT_EQ(summary.at("jobs").size(), 8U);
  // The last list runs fastest.
  EXPECT_EQ(summary.at("jobs").at(3).at("options").at("sampling"), "frustum");
  EXPECT_EQ(summary.at("jobs").at(3).at("options").at("seed"), "2");
  EXPECT_EQ(summary.at("jobs").at(7).at("options").at("sim"), (world_ / "out" / "sim" / "0003").string());
  EXPECT_EQ(summary.at("jobs").at(7).at("options").at("pictures"), "2");
  // The table has the figures of the comparison of its own simulation: each seed gives another sample.
  std::map<int, double> iou;
  for (int i = 0; i < 4; ++i) {
    const Json metrics = ReadJsonFile(world_ / "out" / "judged" / fmt::format("{:04}", i) / "metrics.json");
    iou[i] = metrics.at("macro").at("iou");
    EXPECT_EQ(summary.at("jobs").at(4 + i).at("figures").at("iou").get<double>(), iou[i]);
  }
  EXPECT_NE(iou[2], iou[3]);
  EXPECT_NE(iou[0], iou[1]);

  std::istringstream csv(testing::ReadFile(world_ / "out" / "summary.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_THAT(line, HasSubstr("job,command,state,status,wall_s,"));
  const auto columns = std::count(line.begin(), line.end(), ',');
  int rows = 0;
  for (; std::getline(csv, line); ++rows)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
  EXPECT_EQ(rows, 8);

  // A simulation by hand with the same options is the same.
  ASSERT_EQ(RunSonarcal(world_.SimulateArguments() + " --bits 12 --noise --seed 2 --quiet --out " +
                        Quoted(world_ / "by_hand"))
                .status,
            0);
  EXPECT_EQ(testing::ReadFile(world_ / "by_hand" / "frame_0001.png"),
            testing::ReadFile(world_ / "out" / "sim" / "0001" / "frame_0001.png"));
}

TEST_F(BatchTest, KilledAndRunAgainItEndsTheSameAndDoesNothingTwice) {
  WritePlan("192x400");
  ASSERT_EQ(RunSonarcal(Batch("whole")).status, 0);
  for (const int done : {1, 5}) {
    SCOPED_TRACE(done);
    const std::string out = fmt::format("killed{}", done);
    KillAfter(out, done);
    const int done_before = CountOf(world_ / out, "done");
    EXPECT_LT(done_before, 8);
    const Outcome outcome = RunSonarcal(Batch(out));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    int begun_twice = 0;
    for (const auto& [job, events] : EventsOf(world_ / out)) {
      EXPECT_EQ(std::count(events.begin(), events.end(), "done"), 1) << job;
      EXPECT_EQ(events.back(), "done") << job;
      begun_twice += events.size() > 2 ? 1 : 0;
    }
    EXPECT_LE(begun_twice, 1);  // the one that was killed
    const auto outputs = OutputsOf(world_ / out, {"sim", "judged"});
    const auto expected = OutputsOf(world_ / "whole", {"sim", "judged"});
    ASSERT_EQ(outputs.size(), expected.size());
    for (const auto& [file, bytes] : expected)
      EXPECT_TRUE(outputs.contains(file) && outputs.at(file) == bytes) << file;
    // And once more: there is nothing left to do.
    const std::string ledger = testing::ReadFile(world_ / out / "ledger.jsonl");
    ASSERT_EQ(RunSonarcal(Batch(out)).status, 0);
    EXPECT_EQ(testing::ReadFile(world_ / out / "ledger.jsonl"), ledger);
  }
}

// Equal but for the last digits of sums, which are added in another order.
void ExpectSame(const Json& merged, const Json& whole, const std::string& where) {
  ASSERT_EQ(merged.type_name(), std::string(whole.type_name())) << where;
  if (whole.is_number()) {
    EXPECT_NEAR(merged.get<double>(), whole.get<double>(),
                1e-9 * std::max(1.0, std::abs(whole.get<double>())))
        << where;
  } else if (whole.is_structured()) {
    ASSERT_EQ(merged.size(), whole.size()) << where;
    for (const auto& [key, value] : whole.items())
      ExpectSame(whole.is_array() ? merged.at(std::stoul(key)) : merged.at(key), value,
                 fmt::format("{}.{}", where, key));
  } else {
    EXPECT_EQ(merged, whole) << where;
  }
}

TEST_F(BatchTest, RangesOfARecordingAreMergedToTheComparisonOfTheWhole) {
  WriteRangesPlan();
  const Json whole = ComparedWhole();
  KillAfter("out", 5);  // a part, with all simulations done
  const int done_before = CountOf(world_ / "out", "done");
  ASSERT_LT(done_before, 9);
  const Outcome outcome = RunSonarcal(Batch("out"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  int begun_twice = 0;
  for (const auto& [job, events] : EventsOf(world_ / "out")) {
    EXPECT_EQ(std::count(events.begin(), events.end(), "done"), 1) << job;
    begun_twice += events.size() > 2 ? 1 : 0;
  }
  EXPECT_LE(begun_twice, 1);  // the range that was killed
  EXPECT_EQ(EventsOf(world_ / "out").size(), 9U);
  const Json merged = ReadJsonFile(world_ / "out" / "judged" / "0000" / "metrics.json");
  EXPECT_EQ(merged.at("frames"), whole.at("frames"));
  EXPECT_EQ(merged.at("micro"), whole.at("micro"));
  EXPECT_EQ(merged.at("macro"), whole.at("macro"));
  for (const char* key : {"noise_floor", "residuals", "threshold_sweep", "segmentation", "notes", "ci"})
    ExpectSame(merged.at(key), whole.at(key), key);
  // A part is missing.
  const Outcome missing = RunSonarcal(fmt::format(
      "compare -q --real {} --scene {} --merge {},{} --out {}", Quoted(recorded_), Quoted(world_.scene()),
      Quoted(world_ / "out/part/0000"), Quoted(world_ / "out/part/0002"), Quoted(world_ / "missing")));
  EXPECT_EQ(missing.status, 1);
}

TEST_F(BatchTest, AClusterMergesRangesToo) {
  if (std::system(SONARCAL_PYTHON " -c 'import distributed' 2>/dev/null") != 0)
    GTEST_SKIP() << "needs python3-distributed";
  WriteRangesPlan();
  ASSERT_EQ(RunSonarcal(Batch("whole")).status, 0);
  ASSERT_EQ(std::system(fmt::format("{} {} {} --out {} --workers 2 --quiet --program {} >/dev/null 2>&1",
                                    SONARCAL_PYTHON, SONARCAL_DASK_BATCH, Quoted(world_ / "plan.json"),
                                    Quoted(world_ / "cluster"), SONARCAL_BINARY)
                            .c_str()),
            0);
  const Json by_processes = ReadJsonFile(world_ / "whole/judged/0000/metrics.json");
  const Json by_cluster = ReadJsonFile(world_ / "cluster/judged/0000/metrics.json");
  EXPECT_EQ(by_cluster.at("frames"), by_processes.at("frames"));
  EXPECT_EQ(by_cluster.at("micro"), by_processes.at("micro"));
}

TEST_F(BatchTest, OneCalibrationRunsOverManyRecordings) {
  WritePlan();
  testing::WriteFile(world_ / "many.json", R"({"format": "sonarcal-batch/1", "entries": [
      {"name": "calibrated", "command": "calibrate",
       "options": {"scene": "scene.gltf", "real": ["recorded", "other"], "max-frames": 12}}]})");
  const Outcome outcome = RunSonarcal(
      fmt::format("batch {} --out {} --dry-run", Quoted(world_ / "many.json"), Quoted(world_ / "out")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("calibrated/0001"));
  EXPECT_THAT(outcome.out, HasSubstr("--real other"));
}

TEST_F(BatchTest, InterruptedItSaysHowToGoOn) {
  WritePlan("192x400", "1, 2, 3");  // 12 jobs, so that they take longer than a second
  const std::string command = fmt::format("timeout --foreground -s INT 1 {} {} >/dev/null 2>{}",
                                          SONARCAL_BINARY, Batch("out"), Quoted(world_ / "err"));
  const int status = std::system(("bash -c \"" + command + "; exit \\$?\"").c_str());
  if (WEXITSTATUS(status) == 0) GTEST_SKIP() << "the batch was done within a second";
  EXPECT_THAT(testing::ReadFile(world_ / "err"), HasSubstr("interrupted: finished jobs are in"));
  ASSERT_EQ(RunSonarcal(Batch("out")).status, 0);
  EXPECT_EQ(CountOf(world_ / "out", "done"), 12);
}

// Files may not grow beyond 8 kB, or not even the ledger beyond half a kB.
TEST_F(BatchTest, WhenTheDiskHasSpaceAgainItEndsTheSame) {
  WritePlan();
  ASSERT_EQ(RunSonarcal(Batch("whole")).status, 0);
  for (const int blocks : {1, 16}) {
    const Outcome outcome = RunSonarcal(Batch("out"), fmt::format("trap '' XFSZ; ulimit -f {};", blocks));
    EXPECT_EQ(outcome.status, 1) << blocks;
    EXPECT_THAT(outcome.err, HasSubstr("cannot be written")) << blocks;
  }
  ASSERT_EQ(RunSonarcal(Batch("out")).status, 0);
  EXPECT_EQ(CountOf(world_ / "out", "done"), 8);
  EXPECT_EQ(OutputsOf(world_ / "out", {"sim", "judged"}), OutputsOf(world_ / "whole", {"sim", "judged"}));
}

// On a cluster of two workers, one of which is killed in the middle (dask_batch_test.py).
TEST_F(BatchTest, AClusterThatLosesAWorkerEndsTheSame) {
  if (std::system(SONARCAL_PYTHON " -c 'import distributed' 2>/dev/null") != 0)
    GTEST_SKIP() << "needs python3-distributed";
  WritePlan("192x400");
  ASSERT_EQ(RunSonarcal(Batch("whole")).status, 0);
  EXPECT_EQ(
      std::system(fmt::format("timeout --kill-after=10 900 {} {} {} {} {} 2>&1", SONARCAL_PYTHON,
                              SONARCAL_DASK_TEST, SONARCAL_BINARY, SONARCAL_DASK_BATCH, Quoted(world_ / "."))
                      .c_str()),
      0);
}

// As a power failure leaves it.
TEST_F(BatchTest, ALedgerThatWasCutOffIsGoneOnWith) {
  WritePlan();
  ASSERT_EQ(RunSonarcal(Batch("out", "--only sim/0000")).status, 0);
  std::ofstream(world_ / "out" / "ledger.jsonl", std::ios::app) << R"({"job": "sim/0001", "ke)";
  ASSERT_EQ(RunSonarcal(Batch("out")).status, 0);
  EXPECT_EQ(CountOf(world_ / "out", "done"), 8);
  EXPECT_EQ(EventsOf(world_ / "out").at("sim/0000").size(), 2U);
}

// A scheduler that ends a job sends its signal to all: a simulation then leaves a recording of its first
// frames, and the batch has no time to say how it ended.
TEST_F(BatchTest, ASimulationThatASignalCutShortIsGoneOnWith) {
  WritePlan();
  const std::string only = Batch("out", "--only sim/0000");
  ASSERT_EQ(RunSonarcal(only).status, 0);
  const auto whole = OutputsOf(world_ / "out", {"sim"});
  const fs::path ledger = world_ / "out" / "ledger.jsonl";
  const std::string lines = testing::ReadFile(ledger);
  testing::WriteFile(ledger, lines.substr(0, lines.find('\n') + 1));
  const fs::path recording = world_ / "out" / "sim" / "0000" / "recording.json";
  auto json = nlohmann::ordered_json::parse(testing::ReadFile(recording));
  fs::remove(recording.parent_path() / json["frames"].back()["file"].get<std::string>());
  json["frames"].erase(json["frames"].size() - 1);
  testing::WriteFile(recording, json.dump());

  ASSERT_EQ(RunSonarcal(only).status, 0);
  EXPECT_EQ(OutputsOf(world_ / "out", {"sim"}), whole);
  EXPECT_THAT(EventsOf(world_ / "out").at("sim/0000"), ::testing::ElementsAre("started", "started", "done"));
}

// Two at a time share the work.
TEST_F(BatchTest, TwoAtATimeDoEachJobOnce) {
  WritePlan();
  const std::string one = fmt::format("{} {} --quiet", SONARCAL_BINARY, Batch("out"));
  EXPECT_EQ(std::system(fmt::format("({0} & {0} ; s=$?; wait; exit $s) >/dev/null", one).c_str()), 0);
  EXPECT_EQ(CountOf(world_ / "out", "started"), 8);
  EXPECT_EQ(CountOf(world_ / "out", "done"), 8);
}

TEST_F(BatchTest, AFailedJobIsReportedAndTriedAgain) {
  WritePlan();
  testing::WriteFile(world_ / "bad.json", R"({"format": "sonarcal-batch/1", "entries": [
      {"name": "sim", "command": "simulate", "rows": [{"params": "params.json"}, {"params": "absent.json"}],
       "options": {"scene": "scene.gltf", "sonar": "sonar.json", "poses": "poses.json", "rays": "48x100", "bits": 12}},
      {"name": "judged", "command": "compare", "for_each": "sim", "options": {"real": "recorded", "sim": "{out}"}}]})");
  const std::string batch =
      fmt::format("batch {} --out {}", Quoted(world_ / "bad.json"), Quoted(world_ / "out"));
  const Outcome outcome = RunSonarcal(batch);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("sonarcal: sim/0001: "));
  EXPECT_THAT(outcome.err, HasSubstr("absent.json"));
  EXPECT_THAT(outcome.out, HasSubstr("of 4 jobs 2 done, 1 failed, 1 not run"));
  EXPECT_EQ(RunSonarcal(batch).status, 1);
  EXPECT_THAT(EventsOf(world_ / "out").at("sim/0001"),
              ::testing::ElementsAre("started", "failed", "started", "failed"));
}

TEST_F(BatchTest, OtherInputsNeedAnotherFolder) {
  WritePlan();
  ASSERT_EQ(RunSonarcal(Batch("out", "--only sim/0000")).status, 0);
  ParameterSet parameters = testing::TinyParameters();
  std::string text = testing::ReadFile(world_.params());
  text.replace(text.find("160"), 3, "159");
  testing::WriteFile(world_.params(), text);
  const Outcome outcome = RunSonarcal(Batch("out"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("sim/0000 was started with other options or other inputs"));
}

TEST_F(BatchTest, ASlashAfterTheFolderIsTheSameFolder) {
  WritePlan("48x100", "1");
  ASSERT_EQ(RunSonarcal(Batch("out/")).status, 0);
  const Outcome again = RunSonarcal(Batch("out/"));
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(RunSonarcal(Batch("out")).status, 0);
  EXPECT_EQ(CountOf(world_ / "out", "started"), 4) << "no job is run twice";
}

TEST_F(BatchTest, AJobWhoseOutputWasDeletedRunsAgain) {
  WritePlan("48x100", "1");
  ASSERT_EQ(RunSonarcal(Batch("out")).status, 0);
  const auto whole = OutputsOf(world_ / "out", {"sim", "judged"});
  fs::remove_all(world_ / "out" / "sim" / "0001");
  const Outcome listed = RunSonarcal(Batch("out", "--dry-run --json"));
  EXPECT_EQ(Json::parse(listed.out).at("jobs").at(1).at("state"), "waiting");
  ASSERT_EQ(RunSonarcal(Batch("out")).status, 0);
  EXPECT_EQ(OutputsOf(world_ / "out", {"sim", "judged"}), whole);
  EXPECT_EQ(CountOf(world_ / "out", "started"), 5);
}

TEST_F(BatchTest, AFolderOfOtherFilesIsRefused) {
  WritePlan("48x100", "1");
  const std::string before = testing::ReadFile(recorded_ / "recording.json");
  const Outcome outcome = RunSonarcal(Batch("recorded"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("holds files and no ledger.jsonl"));
  EXPECT_EQ(testing::ReadFile(recorded_ / "recording.json"), before);
  EXPECT_FALSE(fs::exists(recorded_ / "ledger.jsonl"));
  // What a batch leaves that was killed before its first job.
  fs::create_directories(world_ / "out" / "locks" / "sim");
  EXPECT_EQ(RunSonarcal(Batch("out")).status, 0);
}

TEST_F(BatchTest, AFolderThatWasMovedIsTheSameBatch) {
  WritePlan("48x100", "1");
  ASSERT_EQ(RunSonarcal(Batch("out")).status, 0);
  fs::rename(world_ / "out", world_ / "moved");
  const Outcome outcome = RunSonarcal(Batch("moved"));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(CountOf(world_ / "moved", "started"), 4) << "no job is run twice";
}

TEST_F(BatchTest, JobsRunWithoutStandardStreams) {
  WritePlan("48x100", "1");
  const std::string batch = fmt::format("{} {} <&- >&- 2>&-", SONARCAL_BINARY, Batch("out"));
  // Nothing can be printed, which the status says.
  EXPECT_NE(std::system(batch.c_str()), 0);
  EXPECT_EQ(CountOf(world_ / "out", "done"), 4);
  EXPECT_EQ(CountOf(world_ / "out", "failed"), 0);
}

TEST_F(BatchTest, TextThatLooksLikeAFlagStaysAValue) {
  testing::WriteFile(world_ / "plan.json", R"({"format": "sonarcal-batch/1", "entries": [
      {"name": "a", "command": "compare", "options": {"real": "false", "sim": "true", "as-displayed": true}}]})");
  const Outcome listed = RunSonarcal(Batch("out", "--dry-run --json"));
  ASSERT_EQ(listed.status, 0) << listed.err;
  const std::string line = Json::parse(listed.out).at("jobs").at(0).at("command_line");
  EXPECT_THAT(line, HasSubstr("--real false"));
  EXPECT_THAT(line, HasSubstr("--sim true"));
  EXPECT_THAT(line, HasSubstr("--as-displayed"));
}

TEST_F(BatchTest, LargeWholeNumbersKeepTheirDigits) {
  WritePlan("48x100", "9007199254740993, 9007199254740992");
  const Outcome listed = RunSonarcal(Batch("out", "--dry-run --json"));
  ASSERT_EQ(listed.status, 0) << listed.err;
  EXPECT_THAT(listed.out, HasSubstr("--seed 9007199254740993"));
}

TEST_F(BatchTest, DryRunListsAndDoesNothing) {
  WritePlan();
  const Outcome outcome = RunSonarcal(Batch("out", "--dry-run --json"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json jobs = Json::parse(outcome.out).at("jobs");
  EXPECT_EQ(jobs.size(), 8U);
  EXPECT_EQ(jobs.at(5).at("after"), "sim/0001");
  EXPECT_EQ(jobs.at(5).at("state"), "waiting");
  EXPECT_FALSE(fs::exists(world_ / "out"));
}

TEST_F(BatchTest, InvalidPlansAreRefusedWithFileAndLine) {
  WritePlan();
  const auto entry = [](const std::string& rest) {
    return R"({"format": "sonarcal-batch/1",
"entries": [{"name": "a", "command": "simulate", )" +
           rest + "}]}";
  };
  const std::pair<std::string, std::string> mistakes[] = {
      {R"({"format": "sonarcal-batch/2", "entries": []})", "sonarcal-batch/1"},
      {R"({"format": "sonarcal-batch/1", "entries": []})", "expected at least one entry"},
      {entry(R"("options": {"sonnar": "x"})"),
       "plan.json:2: 'entries[0].options.sonnar' is no option of simulate"},
      {entry(R"("options": {"out": "x"})"), "is an option that the batch sets itself"},
      {entry(R"("options": {"log": "x"})"), "is an option that the batch sets itself"},
      {entry(R"("options": {"noise": "yes"})"), "noise"},
      {entry(R"("options": {"seed": true})"), "expected a value of --seed"},
      {entry(R"("options": {"seed": []})"), "expected at least one value"},
      {entry(R"("rows": [{"seed": [1, 2]}])"), "each row is one job"},
      {entry(R"("rows": [{"seed": 1}], "options": {"seed": 2})"), "which is also in options"},
      {entry(R"("for_each": "b")"), "expected the name of an entry before this one"},
      {entry(R"("optoins": {})"), "unknown key"},
      {R"({"format": "sonarcal-batch/1", "entries": [{"name": "a", "command": "reproduce"}]})",
       "expected one of simulate, compare, fit"},
      {R"({"format": "sonarcal-batch/1", "entries": [{"name": "../a", "command": "fit"}]})",
       "as for a folder"},
      {R"({"format": "sonarcal-batch/1", "entries": [{"name": "logs", "command": "fit"}]})",
       "a name that the batch itself uses"},
      {R"({"format": "sonarcal-batch/1", "entries": [{"name": "a", "command": "fit"}, {"name": "a", "command": "fit"}]})",
       "another entry has already"},
      {R"({"format": "sonarcal-batch/1", "entries": [{"name": "a", "command": "simulate"},
        {"name": "b", "command": "compare", "for_each": "a", "options": {"sim": "{putput}"}}]})",
       "expected {out} or an option of a/0000"},
  };
  for (const auto& [text, sentence] : mistakes) {
    testing::WriteFile(world_ / "plan.json", text);
    const Outcome outcome = RunSonarcal(Batch("out"));
    EXPECT_EQ(outcome.status, 1) << text;
    EXPECT_TRUE(testing::IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(sentence));
    EXPECT_FALSE(fs::exists(world_ / "out"));
  }
  EXPECT_EQ(RunSonarcal(Batch("out", "--jobs 0")).status, 2);
  EXPECT_EQ(RunSonarcal(Batch("out", "--dry-run --summary")).status, 2);
}

}  // namespace
}  // namespace sonarcal::batch
