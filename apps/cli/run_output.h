// The output folder of one run of a command: data_io's OutputDirectory, which also goes when the program is
// interrupted, and which carries a provenance.json.
//
// A folder belongs to one command. provenance.json lists the files that a run wrote (`outputs`), and the next
// run removes those that it does not replace. A folder that holds anything else is refused without --force.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "data_io/files/atomic_output.h"

namespace CLI {
class Option;
}

namespace sonarcal::cli {

// --out DIR, and --force into `common`.
CLI::Option* AddOutFolder(CLI::App& command, std::filesystem::path& out, CommonOptions& common,
                          const std::string& description);

// Throws DataError where `folder` holds what no earlier run of `command` wrote as far as the folder tells,
// unless `force`. Hidden files do not count. RunOutput checks it too: this is for commands that write late.
void CheckOutFolder(const std::filesystem::path& folder, const std::string& command, bool force);

//   RunOutput output(options.out, "compare", options.common.force);
//   WriteJson(output / "metrics.json", metrics);
//   WriteProvenance(output.staging(), provenance);
//   output.Commit();
class RunOutput {
 public:
  // Throws DataError as OutputDirectory and CheckOutFolder do.
  RunOutput(const std::filesystem::path& folder, std::string command, bool force,
            data_io::Aside aside = data_io::Aside::kThisRun);

  // Single files in a folder that holds other things; nothing is removed or refused.
  static RunOutput Beside(const std::filesystem::path& folder) { return RunOutput(folder); }

  ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  const data_io::OutputDirectory& directory() const { return directory_; }
  const std::filesystem::path& staging() const { return directory_.staging(); }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return directory_ / name; }
  const std::filesystem::path& final_path() const { return directory_.final_path(); }

  bool found() const { return directory_.found(); }

  // As OutputDirectory's: and no interruption removes what was written.
  void Keep();

  // This run goes on with the earlier one: what that wrote stays and is listed.
  void GoOn() { goes_on_ = true; }

  // Needs a provenance.json of the run, except of Beside.
  void Commit();

 private:
  explicit RunOutput(const std::filesystem::path& folder, data_io::Aside aside = data_io::Aside::kThisRun);

  std::string command_;                         // empty: Beside
  std::vector<std::filesystem::path> earlier_;  // outputs of the earlier run
  bool goes_on_ = false;
  data_io::OutputDirectory directory_;
};

// Removes what runs have written aside and not yet committed. For the end of an interrupted program.
void RemoveUnfinishedOutputs();

}  // namespace sonarcal::cli
