// The output folder of one run of a command: data_io's OutputDirectory, which also goes when the program is
// interrupted, and which carries a provenance.json.
#pragma once

#include <filesystem>

#include "data_io/atomic_output.h"

namespace sonarcal {

//   RunOutput output(options.out);
//   WriteJson(output / "metrics.json", metrics);
//   WriteProvenance(output.staging(), provenance);
//   output.Commit();
class RunOutput {
 public:
  // Throws DataError as OutputDirectory does.
  explicit RunOutput(const std::filesystem::path& folder, Aside aside = Aside::kThisRun);
  ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  const OutputDirectory& directory() const { return directory_; }
  const std::filesystem::path& staging() const { return directory_.staging(); }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return directory_ / name; }
  const std::filesystem::path& final_path() const { return directory_.final_path(); }

  bool found() const { return directory_.found(); }

  // As OutputDirectory's: and no interruption removes what was written.
  void Keep();

  void Commit() { directory_.Commit(); }

 private:
  OutputDirectory directory_;
};

// Removes what runs have written aside and not yet committed. For the end of an interrupted program.
void RemoveUnfinishedOutputs();

}  // namespace sonarcal
