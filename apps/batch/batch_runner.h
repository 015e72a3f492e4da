// Runs the jobs of a batch as processes and writes its ledger. If killed at any moment, it continues when run
// again. Several runners may work on one batch, on machines that share its folder.
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
  int processes = 1;  // number of jobs at the same time
  int threads = 0;    // per job, if its command has --threads; 0: divides the cores among them
};

class BatchRunner {
 public:
  // `out` must exist and be absolute. Throws DataError if its ledger has a job of the plan with another key.
  BatchRunner(BatchPlan plan, const std::filesystem::path& out, const BatchSettings& settings);

  const BatchPlan& plan() const { return plan_; }

  // Return the states by the present ledger, in the order of the plan.
  std::vector<LedgerState> States();
  std::vector<JobState> JobStates();

  // Runs all jobs that are not done, once each, except those after a failed job. Calls `on_job` after each
  // job. If `stop` returns true, kills its processes and returns false.
  bool RunAll(const std::function<void(const BatchJob& job, const LedgerState& state)>& on_job,
              const std::function<bool()>& stop);

  // Runs one job in this process, unless it is done. Waits while another process holds it. Throws DataError
  // for an unknown name, or if the job before it is not done.
  LedgerState RunOnly(const std::string& id);

 private:
  struct Running;

  std::filesystem::path LogOf(const BatchJob& job) const;
  std::vector<std::string> CommandLineOf(const BatchJob& job) const;
  // State by the ledger; absent: not in it. A finished job whose output was deleted counts as started only.
  std::optional<LedgerState> StateOf(const BatchJob& job);
  bool IsDone(const BatchJob& job);
  // Records and returns true if the complete output exists, from a run that was killed before it recorded
  // this.
  bool TakeFoundOutput(const BatchJob& job);
  void WriteEnd(const BatchJob& job, int status, double wall_s);

  BatchPlan plan_;
  std::filesystem::path out_;
  BatchSettings settings_;
  BatchLedger ledger_;
};

}  // namespace sonarcal::batch
