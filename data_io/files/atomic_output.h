// Outputs that appear completely or not at all: they are written to a temporary place, then renamed.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace sonarcal::data_io {

// Replaces `file` by `bytes`. On failure throws DataError and leaves the old file. The directory must exist;
// `file` must not be a directory or device.
void WriteFileWhole(const std::filesystem::path& file, std::string_view bytes);

// Outputs of one run, staged until all of them are complete:
//
//   OutputDirectory output("out");
//   WriteJson(output / "metrics.json", metrics);
//   output.Commit();  // only now out/metrics.json appears
//
// A directory that did not exist appears in one step. Into an existing one, the files are moved one by one:
// JSON files last, because they name the others, and provenance.json after all. Files of the same name are
// replaced. Others are not changed, except those that Commit() gets to remove. Without Commit(), e.g. after
// an exception, nothing appears and the staged files are removed.
//
// Throws DataError if the directory cannot be created or written, or if a file would replace a directory.
//
// Staged files of a long run may be kept, so that a later run can continue. Those of kAnew and kFound lie
// where a later run looks for them. They remain after Keep(), or if the program is killed. Only one run at a
// time may use them: a second one gets a DataError.
enum class Aside {
  kThisRun,  // unique name; removed without Commit()
  kAnew,     // name that a later run finds; removes files of an earlier run
  kFound,    // name that a later run finds; keeps complete files of an earlier run
};

class OutputDirectory {
 public:
  explicit OutputDirectory(const std::filesystem::path& directory, Aside aside = Aside::kThisRun);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  // Directory to write to until Commit(). The caller creates subdirectories.
  const std::filesystem::path& staging() const { return staging_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return staging_ / name; }

  // Absolute path at which the outputs will appear.
  const std::filesystem::path& final_path() const { return final_; }

  // True if files of an earlier run were kept. They remain without Commit(), as after Keep().
  bool found() const { return found_; }

  // Keeps the staged files for a later run, even without Commit().
  void Keep() { kept_ = true; }

  // Moves the outputs into place. Removes the files `stale` (paths within the directory) that are not
  // replaced, and the folders that become empty. They are removed after the new files have been moved and
  // before the new provenance.json, so after a crash the old one still lists them. Paths that lead out of the
  // directory are not touched.
  void Commit(const std::vector<std::filesystem::path>& stale = {});

 private:
  void TakeOver(Aside aside);
  void MoveFilesIntoPlace(const std::vector<std::filesystem::path>& stale) const;
  void RemoveStale(const std::vector<std::filesystem::path>& stale) const;

  std::filesystem::path final_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_parents_;  // outermost first; removed if they stay empty
  int lock_ = -1;                                    // lock of staged files that other runs look for
  bool found_ = false;
  bool kept_ = false;
};

}  // namespace sonarcal::data_io
