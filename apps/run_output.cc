#include "apps/run_output.h"

#include <mutex>
#include <set>
#include <system_error>

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

// Never destroyed: the thread that waits for signals may look at it while the program ends.
struct Registry {
  std::mutex mutex;
  std::set<fs::path> staging;
};

Registry& Unfinished() {
  static auto* registry = new Registry;
  return *registry;
}

}  // namespace

RunOutput::RunOutput(const fs::path& folder, Aside aside) : directory_(folder, aside) {
  if (directory_.found()) return;
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().staging.insert(directory_.staging());
}

void RunOutput::Keep() {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().staging.erase(directory_.staging());
  directory_.Keep();
}

RunOutput::~RunOutput() {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().staging.erase(directory_.staging());
}

void RemoveUnfinishedOutputs() {
  const std::lock_guard lock(Unfinished().mutex);
  for (const fs::path& staging : Unfinished().staging) {
    // Other threads still write: a file that appears during the removal makes it fail, so try again.
    std::error_code error;
    for (int attempt = 0; attempt < 10; ++attempt) {
      fs::remove_all(staging, error);
      if (!error) break;
    }
  }
}

}  // namespace sonarcal
