#include "data_io/files/atomic_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

// Name that no other process or thread uses. mkstemp is not used because its files are readable only for
// their owner; outputs must follow the user's umask.
std::string UniqueName(const std::string& stem) {
  static std::atomic<unsigned> counter{0};
  return fmt::format(".{}.partial-{}-{}", stem, getpid(), counter++);
}

[[noreturn]] void FailToWrite(const fs::path& path, const std::error_code& error) {
  throw DataError("{}: cannot be written: {}", path.string(), error.message());
}

std::error_code LastError() {
  const int number = errno;
  return std::error_code(number != 0 ? number : EIO, std::generic_category());
}

void RefuseWhatIsNoFile(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw DataError("{}: cannot be written: there is a {} of this name, expected a file or nothing",
                    path.string(), fs::is_directory(status) ? "directory" : "device");
  }
}

// Order in which files are moved into place: files that name others come last.
int Turn(const fs::path& path) {
  if (path == "provenance.json") return 2;
  return path.extension() == ".json" ? 1 : 0;
}

}  // namespace

void WriteFileWhole(const fs::path& file, std::string_view bytes) {
  RefuseWhatIsNoFile(file);
  const fs::path aside = file.parent_path() / UniqueName(file.filename().string());
  errno = 0;
  std::ofstream stream(aside, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  std::error_code error;
  if (!stream) {
    error = LastError();
  } else {
    fs::rename(aside, file, error);
  }
  if (error) {
    std::error_code ignored;
    fs::remove(aside, ignored);
    FailToWrite(file, error);
  }
}

OutputDirectory::OutputDirectory(const fs::path& directory, Aside aside)
    : final_((fs::absolute(directory) / "").lexically_normal().parent_path()) {
  std::error_code error;
  const fs::file_status status = fs::status(final_, error);
  const bool exists = fs::exists(status);
  if (exists && !fs::is_directory(status)) {
    throw DataError("{}: cannot be the output directory: it is a file", directory.string());
  }
  // The temporary directory lies inside an existing directory (its parent may be on another disk or not
  // writable), and beside a directory that does not exist yet.
  for (fs::path parent = final_.parent_path(); !exists && !fs::exists(parent, error);
       parent = parent.parent_path()) {
    made_parents_.insert(made_parents_.begin(), parent);
  }
  for (const fs::path& parent : made_parents_) {
    if (!fs::create_directory(parent, error) && error) FailToWrite(directory, error);
  }
  const std::string name = final_.filename().string();
  const bool is_shared = aside != Aside::kThisRun;
  staging_ = (exists ? final_ : final_.parent_path()) /
             (is_shared ? fmt::format(".{}.unfinished", name) : UniqueName(name));
  if (!fs::create_directory(staging_, error) && (error || !is_shared)) {
    FailToWrite(directory, error ? error : std::make_error_code(std::errc::file_exists));
  }
  if (is_shared) TakeOver(aside);
}

// The lock ends with the process. On a disk without locks there is none.
void OutputDirectory::TakeOver(Aside aside) {
  lock_ = open(staging_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ >= 0 && flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(lock_);
    throw DataError("{}: cannot be the output directory: another run is writing it", final_.string());
  }
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) {
    if (aside == Aside::kFound && !entry.path().filename().string().starts_with('.')) {
      found_ = kept_ = true;
    } else {
      fs::remove_all(entry.path(), ignored);
    }
  }
}

OutputDirectory::~OutputDirectory() {
  std::error_code ignored;
  if (!kept_) fs::remove_all(staging_, ignored);
  if (lock_ >= 0) close(lock_);
  for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) {
    fs::remove(*parent, ignored);  // fails, as intended, if the directory is not empty
  }
}

void OutputDirectory::Commit(const std::vector<fs::path>& stale) {
  std::error_code error;
  if (fs::exists(final_, error)) {
    MoveFilesIntoPlace(stale);
  } else {
    fs::rename(staging_, final_, error);
    if (error) FailToWrite(final_, error);
  }
  kept_ = false;
}

void OutputDirectory::MoveFilesIntoPlace(const std::vector<fs::path>& stale) const {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging_)) {
    const fs::path name = entry.path().lexically_relative(staging_);
    if (!entry.is_directory()) {
      files.push_back(name);
      RefuseWhatIsNoFile(final_ / name);
    }
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return Turn(a) != Turn(b) ? Turn(a) < Turn(b) : a < b;
  });
  std::vector<fs::path> gone;
  std::copy_if(stale.begin(), stale.end(), std::back_inserter(gone), [&](const fs::path& name) {
    return std::find(files.begin(), files.end(), name) == files.end();
  });
  bool is_removed = false;
  for (const fs::path& name : files) {
    if (Turn(name) == 2 && !std::exchange(is_removed, true)) RemoveStale(gone);
    std::error_code error;
    fs::create_directories((final_ / name).parent_path(), error);
    fs::rename(staging_ / name, final_ / name, error);
    if (error) FailToWrite(final_ / name, error);
  }
  if (!is_removed) RemoveStale(gone);
}

void OutputDirectory::RemoveStale(const std::vector<fs::path>& stale) const {
  std::error_code error;
  for (const fs::path& name : stale) {
    const fs::path file = final_ / name;
    const fs::path folder = fs::canonical(file.parent_path(), error);
    if (error) continue;
    const fs::path within = folder.lexically_relative(fs::canonical(final_));
    if (name.empty() || within.empty() || *within.begin() == "..") continue;
    if (!fs::is_regular_file(fs::symlink_status(file, error))) continue;
    if (!fs::remove(file, error) && error) FailToWrite(file, error);
    for (fs::path parent = name.parent_path(); !parent.empty(); parent = parent.parent_path()) {
      if (!fs::remove(final_ / parent, error)) break;  // fails, as intended, if the directory is not empty
    }
  }
}

}  // namespace sonarcal::data_io
