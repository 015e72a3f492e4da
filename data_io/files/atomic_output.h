// Outputs that appear whole or not at all: written aside, then renamed.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace sonarcal::data_io {

// Replaces `file` by `bytes`. On failure throws DataError and leaves what was there. The directory must
// exist; `file` may not be a directory or device.
void WriteFileWhole(const std::filesystem::path& file, std::string_view bytes);

// The outputs of one run, gathered aside until all of them are complete:
//
//   OutputDirectory output("out");
//   WriteJson(output / "metrics.json", metrics);
//   output.Commit();  // now, and only now, out/metrics.json appears
//
// A directory that did not exist appears in one step. Into one that did, the files are moved one by one
// (JSON files last, as they name the others, and of those provenance.json last): files of the same name are
// replaced, others are left alone, except those that Commit() is told to remove.
// Without Commit(), as when an exception passes, nothing appears and the files aside are removed.
//
// Throws DataError where the directory cannot be made or written, or where a file would replace a directory.
//
// The files aside of a long run may outlive it, to be gone on with: those of kAnew and kFound lie where a
// later run looks, and stay after Keep(), or when the program is killed. One run at a time may hold them: a
// second is refused by DataError.
enum class Aside {
  kThisRun,  // under a name of their own, and removed without Commit()
  kAnew,     // where a later run finds them; what an earlier one left is removed
  kFound,    // the same, and what an earlier one left is taken over, but for files that are not whole
};

class OutputDirectory {
 public:
  explicit OutputDirectory(const std::filesystem::path& directory, Aside aside = Aside::kThisRun);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  // Where to write until Commit(). Subdirectories are the caller's to make.
  const std::filesystem::path& staging() const { return staging_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return staging_ / name; }

  // Where the outputs will be, absolute.
  const std::filesystem::path& final_path() const { return final_; }

  // Whether files of an earlier run were taken over. They stay without Commit(), as after Keep().
  bool found() const { return found_; }

  // From now on the files aside stay without Commit(), for a later run.
  void Keep() { kept_ = true; }

  // Removes the files `stale` (paths within the directory) that are not replaced, and the folders that become
  // empty. They go after the new files have come and before the new provenance.json, so that after a crash
  // the old one still lists them. Paths that lead out of the directory are left alone.
  void Commit(const std::vector<std::filesystem::path>& stale = {});

 private:
  void TakeOver(Aside aside);
  void MoveFilesIntoPlace(const std::vector<std::filesystem::path>& stale) const;
  void RemoveStale(const std::vector<std::filesystem::path>& stale) const;

  std::filesystem::path final_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path>
      made_parents_;  // outermost first; removed if nothing comes to lie in them
  int lock_ = -1;     // of files aside that other runs look for: held while this lives
  bool found_ = false;
  bool kept_ = false;
};

}  // namespace sonarcal::data_io
