// Outputs that appear completely or not at all: they are written to a temporary place, then renamed.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string_view>
#include <vector>

#include "data_io/files/folder_exchange.h"

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
// A directory that did not exist appears in one step. For an existing one there are two ways:
//
//   Replace()  for a directory that the program made: puts the new outputs in the place of the old ones in
//              one step
//   Commit()   for a directory with other contents: moves the files one by one, JSON files last, because they
//              name the others, and provenance.json after all; replaces files of the same name and leaves the
//              others
//
// If the program is killed while it moves files one by one, the next OutputDirectory of this name moves the
// rest.
//
// Without either, e.g. after an exception, nothing appears and the staged files are removed.
//
// Throws DataError if the directory cannot be created or written, or if a file would replace a directory.
//
// Staged and replaced files lie in hidden folders, .NAME.partial-*, beside the directory or in it. If a
// program is killed, the next OutputDirectory of this name removes them or restores the directory. Runs lock
// their staged files, so those of a run that is under way are safe. On a disk without locks (flock), staged
// files of killed programs remain.
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

  // Moves the outputs into the directory.
  void Commit();

  // Puts the outputs in the place of those of an earlier run. The files that `earlier` returns (paths within
  // the directory) vanish unless they are replaced, and so do the folders that become empty. All other files
  // stay. If several runs replace a directory at once, the last one wins: `earlier` is called when no other
  // run can change the directory.
  //
  // Moves the files one by one, as Commit() does, if the directory cannot be exchanged as a whole: it is a
  // mount point or holds the working directory, its parent is not writable, another run is writing into it,
  // or files that stay belong to another user or cannot be linked. In this case the earlier files are removed
  // after the new ones have been moved and before the new provenance.json (data_io/files/folder_moves.h).
  void Replace(const std::function<std::set<std::filesystem::path>()>& earlier);

 private:
  using Names = std::set<std::filesystem::path>;  // paths within the directory

  void Stage(Aside aside);
  void TakeOver(Aside aside);
  void RemoveMadeParents() const;
  void MoveIntoPlace(const std::function<Names()>* earlier);

  std::filesystem::path final_;
  std::filesystem::path place_;  // the same without symbolic links
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_parents_;  // outermost first; removed if they stay empty
  FolderLock lock_;                                  // of staging_
  bool found_ = false;
  bool kept_ = false;
};

}  // namespace sonarcal::data_io
