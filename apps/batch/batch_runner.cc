#include "apps/batch/batch_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <list>
#include <thread>

#include "apps/batch/job_process.h"
#include "apps/cli/command.h"
#include "core/types/error.h"

namespace sonarcal::batch {
namespace {

namespace fs = std::filesystem;

constexpr auto kBetweenLooks = std::chrono::milliseconds(20);

// A comparison that exceeded a threshold is done: it has written its output.
bool IsDoneStatus(int status) {
  return status == static_cast<int>(cli::ExitStatus::kDone) ||
         status == static_cast<int>(cli::ExitStatus::kThreshold);
}

}  // namespace

struct BatchRunner::Running {
  const BatchJob* job;
  JobLock lock;
  JobProcess process;
};

BatchRunner::BatchRunner(BatchPlan plan, const fs::path& out, const BatchSettings& settings)
    : plan_(std::move(plan)), out_(out), settings_(settings), ledger_(out) {
  for (const BatchJob& job : plan_.jobs) {
    const std::optional<LedgerState> state = StateOf(job);
    if (state && state->key != job.key) {
      throw DataError(
          "{}: the job {} was started with other options or other inputs, expected the present ones: use "
          "another --out, or restore the files",
          ledger_.file().string(), job.id);
    }
  }
}

std::optional<LedgerState> BatchRunner::StateOf(const BatchJob& job) {
  const auto& states = ledger_.Read();
  const auto found = states.find(job.id);
  if (found == states.end()) return std::nullopt;
  LedgerState state = found->second;
  if (state.event == LedgerState::Event::kDone && !fs::exists(out_ / job.id))
    state.event = LedgerState::Event::kStarted;
  return state;
}

bool BatchRunner::IsDone(const BatchJob& job) {
  const std::optional<LedgerState> state = StateOf(job);
  return state && state->event == LedgerState::Event::kDone;
}

std::vector<LedgerState> BatchRunner::States() {
  std::vector<LedgerState> states;
  for (const BatchJob& job : plan_.jobs) {
    states.push_back(StateOf(job).value_or(LedgerState{}));
  }
  return states;
}

std::vector<JobState> BatchRunner::JobStates() {
  std::vector<JobState> states;
  for (const LedgerState& state : States()) {
    states.push_back(state.event == LedgerState::Event::kDone     ? JobState::kDone
                     : state.event == LedgerState::Event::kFailed ? JobState::kFailed
                                                                  : JobState::kWaiting);
  }
  return states;
}

fs::path BatchRunner::LogOf(const BatchJob& job) const {
  fs::path log = out_ / kLogsFolder / job.id;
  log += ".log";
  return log;
}

std::vector<std::string> BatchRunner::CommandLineOf(const BatchJob& job) const {
  std::vector<std::string> line = {job.command};
  line.insert(line.end(), job.arguments.begin(), job.arguments.end());
  if (job.command != "compare" && !job.options.contains("threads")) {
    const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const int threads = settings_.threads > 0 ? settings_.threads : std::max(1, cores / settings_.processes);
    line.insert(line.end(), {"--threads", fmt::format("{}", threads)});
  }
  // Continues a killed run.
  if (job.command == "simulate" || job.command == "calibrate") line.emplace_back("--resume");
  line.insert(line.end(), {"--quiet", "--out", (out_ / job.id).string()});
  return line;
}

bool BatchRunner::TakeFoundOutput(const BatchJob& job) {
  const fs::path output = out_ / job.id;
  if (!fs::exists(output)) return false;
  const std::optional<LedgerState> state = StateOf(job);
  if (!state) {
    throw DataError("{}: exists, but is not in the ledger: move it away, or use another --out",
                    output.string());
  }
  // The output of an interrupted simulation may be incomplete: --resume makes the rest.
  if (state->event == LedgerState::Event::kStarted && job.command == "simulate") return false;
  // Other commands write their output as a whole, so it is complete. But the result of the thresholds of a
  // comparison is lost.
  if (state->event == LedgerState::Event::kStarted && !job.options.contains("fail-above")) {
    ledger_.Done(job.id, job.key, 0, 0.0);
    return true;
  }
  fs::remove_all(output);
  return false;
}

void BatchRunner::WriteEnd(const BatchJob& job, int status, double wall_s) {
  if (IsDoneStatus(status)) return ledger_.Done(job.id, job.key, status, wall_s);
  std::string why = LastSentence(LogOf(job));
  if (why.empty()) why = fmt::format("ended with status {}", status);
  fs::remove_all(out_ / job.id);  // incomplete output of a simulation
  ledger_.Failed(job.id, job.key, status, wall_s, why);
}

bool BatchRunner::RunAll(const std::function<void(const BatchJob& job, const LedgerState& state)>& on_job,
                         const std::function<bool()>& stop) {
  std::map<std::string, bool> succeeded;  // jobs that ended, in this run or an earlier one
  std::list<const BatchJob*> waiting;
  for (const BatchJob& job : plan_.jobs) {
    if (IsDone(job)) {
      succeeded[job.id] = true;
    } else {
      waiting.push_back(&job);
    }
  }
  std::list<Running> running;
  const auto end = [&](const BatchJob& job) {
    const LedgerState state = *StateOf(job);
    succeeded[job.id] = state.event == LedgerState::Event::kDone;
    on_job(job, state);
  };
  while (!waiting.empty() || !running.empty()) {
    if (stop()) return false;  // the destructors end the processes
    for (auto one = running.begin(); one != running.end();) {
      const std::optional<int> status = one->process.Ended();
      if (!status) {
        ++one;
        continue;
      }
      const BatchJob& job = *one->job;
      WriteEnd(job, *status, one->process.wall_s());
      one = running.erase(one);
      end(job);
    }
    for (auto next = waiting.begin();
         next != waiting.end() && static_cast<int>(running.size()) < settings_.processes;) {
      const BatchJob& job = **next;
      const auto has_failed = [&](const std::string& id) {
        const auto ended = succeeded.find(id);
        return ended != succeeded.end() && !ended->second;
      };
      const bool is_lost = std::ranges::any_of(job.after, has_failed);
      if (!is_lost &&
          std::ranges::any_of(job.after, [&](const auto& id) { return !succeeded.contains(id); })) {
        ++next;
        continue;
      }
      if (is_lost) {  // its input will not be made
        succeeded[job.id] = false;
        next = waiting.erase(next);
        continue;
      }
      JobLock lock(out_, job.id, /*wait=*/false);
      if (!lock.held()) {  // held by another process
        ++next;
        continue;
      }
      next = waiting.erase(next);
      if (IsDone(job) || TakeFoundOutput(job)) {
        end(job);
        continue;
      }
      ledger_.Started(job.id, job.key);
      running.push_back({&job, std::move(lock), JobProcess(CommandLineOf(job), plan_.folder, LogOf(job))});
    }
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return true;
}

LedgerState BatchRunner::RunOnly(const std::string& id) {
  const auto found =
      std::find_if(plan_.jobs.begin(), plan_.jobs.end(), [&](const BatchJob& job) { return job.id == id; });
  if (found == plan_.jobs.end())
    throw DataError("the plan has no job {}, expected one that --dry-run lists", id);
  const BatchJob& job = *found;
  const JobLock lock(out_, id, /*wait=*/true);
  if (IsDone(job)) return *StateOf(job);
  for (const BatchJob& before : plan_.jobs) {
    if (std::ranges::find(job.after, before.id) != job.after.end() && !IsDone(before))
      throw DataError("the job {} needs {}, which is not done", id, before.id);
  }
  if (!TakeFoundOutput(job)) {
    ledger_.Started(job.id, job.key);
    JobProcess process(CommandLineOf(job), plan_.folder, LogOf(job));
    const int status = process.Wait();
    WriteEnd(job, status, process.wall_s());
  }
  return *StateOf(job);
}

}  // namespace sonarcal::batch
