// `sonarcal batch PLAN --out DIR`: simulates, compares, fits or calibrates over many recordings and
// parameter sets (docs/guide/batch.md).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/batch/batch_runner.h"
#include "apps/batch/batch_summary.h"
#include "apps/cli/command.h"
#include "apps/cli/interruption.h"
#include "apps/cli/progress.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/files/folder_path.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::commands {
namespace {

struct BatchOptions {
  cli::CommonOptions common;
  std::filesystem::path plan;
  std::filesystem::path out;
  int processes = 1;
  int threads = 0;
  bool dry_run = false;
  bool summary_only = false;
  std::string only;  // id of one job; empty: all
};

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string ArgumentWords(const batch::BatchJob& job) {
  std::string words = job.command;
  for (const std::string& argument : job.arguments) {
    const bool is_plain = argument.find_first_of(" \t\n'\"\\$") == std::string::npos && !argument.empty();
    words += is_plain ? fmt::format(" {}", argument) : fmt::format(" '{}'", argument);
  }
  return words;
}

cli::ExitStatus ListJobs(const BatchOptions& options, const batch::BatchPlan& plan,
                         const std::vector<batch::LedgerState>& states) {
  const Json summary = batch::BatchSummaryJson(plan, states, options.out);
  if (options.common.json) {
    Json jobs = Json::array();
    for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
      const batch::BatchJob& job = plan.jobs[i];
      jobs.push_back({{"job", job.id},
                      {"after", fmt::format("{}", fmt::join(job.after, ","))},
                      {"state", summary.at("jobs").at(i).at("state")},
                      {"command_line", ArgumentWords(job)}});
    }
    cli::PrintJson({{"jobs", jobs}});
    return cli::ExitStatus::kDone;
  }
  std::string text;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    text += fmt::format("{:20} {:8} {}\n", plan.jobs[i].id,
                        summary.at("jobs").at(i).at("state").get<std::string>(), ArgumentWords(plan.jobs[i]));
  }
  cli::PrintResult(text);
  return cli::ExitStatus::kDone;
}

// Writes and prints the summary. Returns kFailed if any job failed, or was skipped because the one before it
// failed.
cli::ExitStatus Finish(const BatchOptions& options, const fs::path& out, batch::BatchRunner& runner) {
  const Json summary = batch::BatchSummaryJson(runner.plan(), runner.States(), out);
  cli::RunOutput output = cli::RunOutput::Beside(out);
  data_io::WriteFileWhole(output / batch::kSummaryCsvFile, batch::BatchSummaryCsv(summary));
  data_io::WriteJson(output / batch::kSummaryJsonFile, summary);
  output.Commit();
  const int done = summary.at("done");
  const int failed = summary.at("failed");
  const int waiting = summary.at("waiting");
  if (options.common.json) {
    cli::PrintJson(summary);
  } else {
    cli::PrintResult(
        fmt::format("{}: of {} jobs {} done, {} failed, {} not run; summary.csv has one line each\n",
                    options.out.string(), runner.plan().jobs.size(), done, failed, waiting));
  }
  return failed + waiting == 0 ? cli::ExitStatus::kDone : cli::ExitStatus::kFailed;
}

cli::ExitStatus RunOneJob(const BatchOptions& options, batch::BatchRunner& runner) {
  const batch::LedgerState state = runner.RunOnly(options.only);
  const bool is_done = state.event == batch::LedgerState::Event::kDone;
  if (options.common.json) {
    cli::PrintJson({{"job", options.only}, {"state", is_done ? "done" : "failed"}, {"status", state.status}});
  } else if (is_done) {
    cli::PrintResult(fmt::format("{}: done\n", options.only));
  }
  if (!is_done) throw DataError("{}: failed: {}", options.only, state.why);
  return cli::ExitStatus::kDone;
}

void CheckOptions(const BatchOptions& options) {
  if (int{options.dry_run} + int{options.summary_only} + int{!options.only.empty()} > 1)
    throw UsageError("--dry-run, --summary and --only are given together, expected one of them");
}

}  // namespace

cli::ExitStatus RunBatch(const BatchOptions& options, const CLI::App& root) {
  CheckOptions(options);
  const fs::path out = data_io::PlainFolder(options.out);
  batch::BatchPlan plan = batch::ReadBatchPlan(options.plan, out, root);
  if (!options.dry_run) {
    fs::create_directories(out);
    batch::BatchLedger(out).CheckFolder();
  }
  batch::BatchRunner runner(std::move(plan), out,
                            {.processes = options.processes, .threads = options.threads});
  if (options.dry_run) return ListJobs(options, runner.plan(), runner.States());
  if (options.summary_only) return Finish(options, out, runner);
  if (!options.only.empty()) return RunOneJob(options, runner);

  const cli::Interruption interruption(cli::Interruption::IfSlow::kWait);
  bool is_complete = false;
  {
    cli::Progress progress("Batch", static_cast<int>(runner.plan().jobs.size()), options.common, "jobs");
    for (const batch::JobState state : runner.JobStates()) {
      if (state == batch::JobState::kDone) progress.Skip();
    }
    is_complete = runner.RunAll(
        [&](const batch::BatchJob& job, const batch::LedgerState& state) {
          progress.Advance();
          if (state.event == batch::LedgerState::Event::kFailed)
            cli::PrintError(fmt::format("{}: {}", job.id, state.why));
        },
        [&] { return interruption.asked(); });
  }
  if (!is_complete) {
    cli::PrintError(fmt::format("interrupted: finished jobs are in {}; the same command runs the rest",
                                options.out.string()));
    return cli::ExitStatus::kInterrupted;
  }
  return Finish(options, out, runner);
}

void SetupBatch(CLI::App& app) {
  auto options = std::make_shared<BatchOptions>();
  CLI::App* command = cli::AddCommand(app, "batch", "Runs commands over many recordings and parameter sets");
  command->add_option("PLAN", options->plan, "Plan of commands and their options (sonarcal-batch/1, JSON)")
      ->required();
  command->add_option("--out", options->out, "Folder of all outputs, of the ledger and of the summary")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("-j,--jobs", options->processes,
                   "Number of jobs that run at the same time, each as a process")
      ->type_name("N")
      ->check(CLI::Range(1, 1024).description(""));
  command->add_option("--threads", options->threads, "Threads per job; 0 divides the cores among the jobs")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""));
  command->add_flag("--dry-run", options->dry_run, "List the jobs and their states; run none");
  command->add_flag("--summary", options->summary_only, "Write the summary of the finished jobs; run none");
  command->add_option("--only", options->only, "Run only this job, for use with another scheduler")
      ->type_name("JOB")
      ->default_str("");
  cli::OnRun(command, options->common, [options, &app] { return RunBatch(*options, app); });
}

}  // namespace sonarcal::commands
