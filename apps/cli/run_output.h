// Output folder of one run of a command: OutputDirectory of data_io, which is also removed when the program
// is interrupted, with a provenance.json.
//
// A folder belongs to one command. provenance.json lists the files that a run wrote (`outputs`). The next run
// of the command puts its outputs in the place of these in one step, and other files stay. A folder with
// other contents is refused without --force, which moves the files into it one by one.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "data_io/files/atomic_output.h"

namespace CLI {
class Option;
}

namespace sonarcal::cli {

// Adds --out DIR, and --force into `common`.
CLI::Option* AddOutFolder(CLI::App& command, std::filesystem::path& out, CommonOptions& common,
                          const std::string& description);

// Throws DataError if `folder` holds anything that no earlier run of `command` wrote, unless `force`. Ignores
// hidden files. RunOutput checks this too; this function is for commands that write late.
void CheckOutFolder(const std::filesystem::path& folder, const std::string& command, bool force);

// Throws UsageError if `out` is, by whatever path, one of the inputs, the folder of one that is a
// recording.json, or a file in the folder of a recording. For commands whose outputs have the form of their
// inputs.
void RefuseInputAsOutput(const std::filesystem::path& out, const std::vector<std::filesystem::path>& inputs);

// Throws as RefuseInputAsOutput does, and DataError if there is a file at `out` that no earlier run wrote,
// unless `force`. An earlier run left a file whose name has ".provenance.json" or ".account.json" after it.
void CheckOutFile(const std::filesystem::path& out, const std::vector<std::filesystem::path>& inputs,
                  bool force);

// Writes the outputs of a run aside, and moves them into the folder at the end:
//
//   RunOutput output(options.out, "compare", options.common.force);
//   WriteJson(output / "metrics.json", metrics);
//   WriteProvenance(output.staging(), provenance);
//   output.Commit();
class RunOutput {
 public:
  // Throws DataError as OutputDirectory and CheckOutFolder do.
  RunOutput(const std::filesystem::path& folder, std::string command, bool force,
            data_io::Aside aside = data_io::Aside::kThisRun);

  // For single files in a folder with other contents. Removes and refuses nothing.
  static RunOutput Beside(const std::filesystem::path& folder) { return RunOutput(folder); }

  ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  const data_io::OutputDirectory& directory() const { return directory_; }
  const std::filesystem::path& staging() const { return directory_.staging(); }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return directory_ / name; }
  const std::filesystem::path& final_path() const { return directory_.final_path(); }

  bool found() const { return directory_.found(); }

  // As in OutputDirectory. Also protects the written files from removal at an interruption.
  void Keep();

  // Continues the earlier run: its files stay and are listed.
  void GoOn() { goes_on_ = true; }

  // Needs a provenance.json of the run, except with Beside. An interruption meanwhile takes effect after it.
  void Commit();

 private:
  void Register();
  void ListOutputs(std::set<std::string> outputs);
  std::set<std::filesystem::path> OutputsOfEarlierRun() const;
  void MoveIntoPlace();

  explicit RunOutput(const std::filesystem::path& folder, data_io::Aside aside = data_io::Aside::kThisRun);

  std::string command_;  // empty: Beside
  bool force_ = false;
  bool replaces_ = false;  // the outputs of an earlier run, or none
  bool goes_on_ = false;
  bool is_registered_ = false;  // removed at an interruption, unless kept
  data_io::OutputDirectory directory_;
  std::filesystem::path staging_;  // before Commit()
};

// True if `folder`, by whatever path, is that of a RunOutput, not of one Beside, that exists.
bool IsBeingWritten(const std::filesystem::path& folder);

// Removes staged files of runs that are not committed. For the end of an interrupted program. Returns what
// became of them: there were none, they were removed, or something was kept for a later run.
enum class LeftOutputs { kNone, kRemoved, kKept };
LeftOutputs RemoveUnfinishedOutputs();

}  // namespace sonarcal::cli
