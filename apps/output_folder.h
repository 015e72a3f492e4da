// Outputs appear whole or not at all. They are written into a hidden folder, beside the one asked for or
// inside it where it is already there, and moved to their place by Commit(). An object that goes without
// Commit() removes what it wrote, and so does an interrupted program.
#pragma once

#include <filesystem>

namespace sonarcal {

class OutputFolder {
 public:
  // Makes the hidden folder, and the parents of `folder`. Throws DataError where that is impossible, and
  // where `folder` exists as something else than a folder.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Where to write.
  const std::filesystem::path& path() const { return partial_; }

  // Where it will be found.
  const std::filesystem::path& destination() const { return destination_; }

  // Moves everything written to the destination. A folder that is already there keeps its other files, and
  // gets each new file by a rename of its own, *.json last: whoever reads an index finds what it names.
  void Commit();

 private:
  std::filesystem::path destination_;
  std::filesystem::path partial_;
  bool committed_ = false;
};

// Removes every folder that is being written. Called when the program is interrupted.
void RemoveUnfinishedOutputs();

}  // namespace sonarcal
