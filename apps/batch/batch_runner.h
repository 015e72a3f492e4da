// Runs the jobs of a batch by processes, and keeps its ledger. Killed at any moment and run again it goes on;
// several may run one batch at a time, on machines that share its folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/batch/batch_ledger.h"
#include "apps/batch/batch_plan.h"

namespace sonarcal::batch {

enum class JobState { kWaiting, kDone, kFailed };

struct BatchSettings {
  int processes = 1;  // jobs at a time
  int threads = 0;    // of each job, where its command takes --threads; 0: the cores divided among them
};

class BatchRunner {
 public:
  // `out` is there, absolute. Throws DataError where its ledger has a job of the plan with another key.
  BatchRunner(BatchPlan plan, const std::filesystem::path& out, const BatchSettings& settings);

  const BatchPlan& plan() const { return plan_; }

  // By the ledger as it is now, in the order of the plan.
  std::vector<LedgerState> States();
  std::vector<JobState> JobStates();

  // Runs all that is not done, once each; jobs after one that failed are left. `on_job` is told of each that
  // ends. Stops, its processes killed, where `stop` says so; then the answer is false.
  bool RunAll(const std::function<void(const BatchJob& job, const LedgerState& state)>& on_job,
              const std::function<bool()>& stop);

  // Runs one job here, unless it is done, waiting while another process has it. Throws DataError where there
  // is none of that name, or the job before it is not done.
  LedgerState RunOnly(const std::string& id);

 private:
  struct Running;

  std::filesystem::path LogOf(const BatchJob& job) const;
  std::vector<std::string> CommandLineOf(const BatchJob& job) const;
  const LedgerState* StateOf(const BatchJob& job);
  bool IsDone(const BatchJob& job);
  // Whether the job's whole output lies there, from a run that was killed before it could say so.
  bool TakeFoundOutput(const BatchJob& job);
  void WriteEnd(const BatchJob& job, int status, double wall_s);

  BatchPlan plan_;
  std::filesystem::path out_;
  BatchSettings settings_;
  BatchLedger ledger_;
};

}  // namespace sonarcal::batch
