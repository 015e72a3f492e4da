#include "apps/output_folder.h"

#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <vector>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

// Never destroyed: the thread that waits for signals may look at it while the program ends.
struct Registry {
  std::mutex mutex;
  std::set<fs::path> folders;
};

Registry& Unfinished() {
  static auto* registry = new Registry;
  return *registry;
}

void Register(const fs::path& folder) {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().folders.insert(folder);
}

void Unregister(const fs::path& folder) {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().folders.erase(folder);
}

// Inside the destination where that exists (its parent may be closed to us, or another file system), beside
// it where not. A name of this process alone, so that two runs with one destination don't share it.
fs::path MakePartialFolder(const fs::path& destination) {
  const fs::path parent = fs::exists(destination) ? destination : destination.parent_path();
  for (int attempt = 0;; ++attempt) {
    const fs::path partial =
        parent / fmt::format(".{}.partial-{}-{}", destination.filename().string(), getpid(), attempt);
    std::error_code error;
    if (fs::create_directory(partial, error)) return partial;
    if (error) throw DataError("cannot write into {}: {}", parent.string(), error.message());
  }
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& folder) {
  if (folder.empty()) throw DataError("the output folder has an empty name, expected a path");
  destination_ = fs::absolute(folder).lexically_normal();
  if (!destination_.has_filename()) destination_ = destination_.parent_path();  // "out/" is "out"
  if (fs::exists(destination_) && !fs::is_directory(destination_)) {
    throw DataError("{} is a file, expected a folder to write into", folder.string());
  }
  std::error_code error;
  fs::create_directories(destination_.parent_path(), error);
  if (error) throw DataError("cannot make {}: {}", destination_.parent_path().string(), error.message());
  partial_ = MakePartialFolder(destination_);
  Register(partial_);
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
  Unregister(partial_);
}

void OutputFolder::Commit() {
  SONARCAL_CHECK(!committed_, "{} committed twice", destination_.string());
  if (!fs::exists(destination_)) {
    fs::rename(partial_, destination_);
  } else {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(partial_)) {
      const fs::path relative = entry.path().lexically_relative(partial_);
      if (entry.is_directory()) {
        fs::create_directories(destination_ / relative);
      } else {
        files.push_back(relative);
      }
    }
    std::stable_partition(files.begin(), files.end(),
                          [](const fs::path& file) { return file.extension() != ".json"; });
    for (const fs::path& file : files) fs::rename(partial_ / file, destination_ / file);
    fs::remove_all(partial_);
  }
  committed_ = true;
  Unregister(partial_);
}

void RemoveUnfinishedOutputs() {
  const std::lock_guard lock(Unfinished().mutex);
  for (const fs::path& folder : Unfinished().folders) {
    // Other threads still write: a file that appears during the removal makes it fail, so try again.
    std::error_code error;
    for (int attempt = 0; attempt < 10; ++attempt) {
      fs::remove_all(folder, error);
      if (!error) break;
    }
  }
  Unfinished().folders.clear();
}

}  // namespace sonarcal
