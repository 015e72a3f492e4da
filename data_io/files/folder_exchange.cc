#include "data_io/files/folder_exchange.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "data_io/files/hash.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

// Suffixes of hidden folders beside a folder. The first may always be removed if the second does not exist.
constexpr const char* kNext = "exchange";      // new folder before the exchange, old one after it
constexpr const char* kReplaced = "replaced";  // old folder, if there is no exchange in one step

fs::path HiddenName(const fs::path& folder, const std::string& suffix) {
  return fmt::format(".{}.partial-{}", StagedStem(folder), suffix);
}

fs::path Beside(const fs::path& folder, const char* suffix) {
  return folder.parent_path() / HiddenName(folder, suffix);
}

// True if `name` is that of a UniquePath() for `folder`.
bool IsUniqueName(const std::string& name, const fs::path& folder) {
  const std::string start = HiddenName(folder, "").string();
  return name.starts_with(start) && name.size() > start.size() &&
         name.find_first_not_of("0123456789-", start.size()) == std::string::npos;
}

bool IsStaged(const fs::path& name, const fs::path& folder) {
  return IsUniqueName(name.string(), folder) || name == UnfinishedName(folder);
}

std::error_code Error(int number) {
  return std::error_code(number != 0 ? number : EIO, std::generic_category());
}

bool HoldsWorkingDirectory(const fs::path& folder) {
  std::error_code error;
  const fs::path work = fs::current_path(error);
  const auto [in_folder, in_work] = std::mismatch(folder.begin(), folder.end(), work.begin(), work.end());
  return !error && in_folder == folder.end();
}

// Links the files of one folder into another one.
class CarryOver {
 public:
  // `folder`: path at which one of them lies, has lain or will lie.
  CarryOver(fs::path from, fs::path to, fs::path folder, const std::set<fs::path>& outdated)
      : from_(std::move(from)), to_(std::move(to)), folder_(std::move(folder)), outdated_(outdated) {}

  std::error_code All() {
    const std::error_code error = Folder({});
    return error ? error : CopyMode({});
  }

  // Removes the links again.
  std::error_code Undo() {
    std::error_code error;
    for (; !made_.empty() && !error; made_.pop_back()) fs::remove(made_.back(), error);
    return error;
  }

 private:
  // `name`: folder within both.
  std::error_code Folder(const fs::path& name) {
    std::error_code error = CheckFolder(name);
    if (error) return error;
    bool is_empty = true;
    for (fs::directory_iterator entry(from_ / name, error), end; !error && entry != end;
         entry.increment(error)) {
      is_empty = false;
      const fs::path within = name / entry->path().filename();
      const fs::file_type type = entry->symlink_status(error).type();
      if (error) return error;
      if (type == fs::file_type::directory) {
        error = name.empty() && IsStaged(within, folder_) ? CheckAbandoned(within) : Folder(within);
      } else if (type != fs::file_type::regular || !outdated_.contains(within)) {
        error = File(within);
      }
      if (error) return error;
    }
    return error || !is_empty ? error : Make(name);
  }

  // Staged outputs are not linked. Those of a run that is under way must stay where they are.
  std::error_code CheckAbandoned(const fs::path& name) const {
    return FolderLock::Try(from_ / name).is_held() ? std::error_code() : Error(EBUSY);
  }

  // The old folder must be one that can be removed later.
  std::error_code CheckFolder(const fs::path& name) const {
    struct stat from = {};
    struct stat to = {};
    if (stat((from_ / name).c_str(), &from) != 0 || stat(to_.c_str(), &to) != 0) return Error(errno);
    if (from.st_dev != to.st_dev) return Error(EXDEV);
    if (from.st_uid != to.st_uid || from.st_gid != to.st_gid) return Error(EPERM);
    return access((from_ / name).c_str(), R_OK | W_OK | X_OK) == 0 ? std::error_code() : Error(errno);
  }

  std::error_code File(const fs::path& name) {
    std::error_code error;
    const fs::file_status present = fs::symlink_status(to_ / name, error);
    if (fs::is_directory(present)) return Error(ENOTDIR);
    if (fs::exists(present)) return {};
    if ((error = Make(name.parent_path()))) return error;
    if (linkat(AT_FDCWD, (from_ / name).c_str(), AT_FDCWD, (to_ / name).c_str(), 0) != 0) {
      return errno == ENOENT ? std::error_code() : Error(errno);  // another program has removed it
    }
    made_.push_back(to_ / name);
    return {};
  }

  // Makes a folder like the one in `from_`, unless it exists.
  std::error_code Make(const fs::path& name) {
    std::error_code error;
    if (name.empty() || fs::is_directory(fs::symlink_status(to_ / name, error))) return {};
    if ((error = Make(name.parent_path()))) return error;
    if (!fs::create_directory(to_ / name, error)) return error ? error : Error(ENOTDIR);
    made_.push_back(to_ / name);
    return CopyMode(name);
  }

  std::error_code CopyMode(const fs::path& name) const {
    std::error_code error;
    const fs::perms mode = fs::status(from_ / name, error).permissions();
    if (!error) fs::permissions(to_ / name, mode, error);
    return error;
  }

  fs::path from_;
  fs::path to_;
  fs::path folder_;
  const std::set<fs::path>& outdated_;
  std::vector<fs::path> made_;
};

// Exchanges the two, or renames one after the other. Sets `old` to the path that the old folder has then.
std::error_code Swap(const fs::path& next, const fs::path& folder, fs::path& old) {
  old = next;
  if (renameat2(AT_FDCWD, next.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) return {};
  if (errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) return Error(errno);
  old = Beside(folder, kReplaced);
  std::error_code error;
  fs::rename(folder, old, error);
  if (error) return error;
  fs::rename(next, folder, error);
  std::error_code ignored;
  if (error) fs::rename(old, folder, ignored);
  return error;
}

}  // namespace

FolderLock::~FolderLock() {
  if (file_ >= 0) close(file_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : file_(std::exchange(other.file_, -1)), is_busy_(other.is_busy_) {}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(is_busy_, other.is_busy_);
  return *this;
}

FolderLock FolderLock::Try(const fs::path& folder) {
  FolderLock lock;
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return lock;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) {
    lock.file_ = file;
  } else {
    lock.is_busy_ = errno == EWOULDBLOCK;
    close(file);
  }
  return lock;
}

FolderLock LockOfParent(const fs::path& folder) {
  constexpr std::chrono::milliseconds kPause{5};
  constexpr int kMaxAttempts = 1000;
  const fs::path parent = folder.parent_path();
  FolderLock lock = FolderLock::Try(parent);
  // The run that stages other outputs there has locked them, and nobody else writes there.
  if (IsStagedName(parent.filename().string())) return lock;
  for (int attempt = 1; lock.is_busy() && attempt < kMaxAttempts; ++attempt) {
    std::this_thread::sleep_for(kPause);
    lock = FolderLock::Try(parent);
  }
  return lock;
}

std::string StagedStem(const fs::path& folder) {
  constexpr std::size_t kMaxBytes = 200;
  std::string name = folder.filename().string();
  if (name.size() <= kMaxBytes) return name;
  const std::string hash = Sha256(name).substr(0, 16);
  return name.substr(0, kMaxBytes - hash.size() - 1) + '~' + hash;
}

bool IsStagedName(std::string_view name) {
  return name.starts_with('.') &&
         (name.find(".partial-") != std::string_view::npos || name.ends_with(".unfinished"));
}

// mkdtemp is not used because its folders are readable only for their owner; outputs must follow the user's
// umask.
fs::path UniquePath(const fs::path& place, const fs::path& folder) {
  static std::atomic<unsigned> counter{0};
  std::error_code error;
  fs::path path;
  do {
    path = place / HiddenName(folder, fmt::format("{}-{}", getpid(), counter++));
  } while (fs::exists(fs::symlink_status(path, error)));
  return path;
}

fs::path UnfinishedName(const fs::path& folder) {
  return fmt::format(".{}.unfinished", StagedStem(folder));
}

void RefuseIfBusy(const FolderLock& lock, const fs::path& folder) {
  if (lock.is_busy())
    throw DataError("{}: cannot be the output directory: another run is writing it", folder.string());
}

void FinishExchange(const fs::path& folder) {
  const fs::path next = Beside(folder, kNext);
  RefuseIfBusy(FolderLock::Try(next), folder);
  const fs::path old = Beside(folder, kReplaced);
  std::error_code error;
  if (fs::exists(fs::symlink_status(old, error))) {
    const bool is_replaced = fs::exists(folder, error) && !fs::exists(fs::symlink_status(next, error));
    fs::rename(old, is_replaced ? next : folder, error);
    if (error) {
      throw DataError(
          "{}: a run that was killed left the earlier contents in {}, which cannot be renamed: {}",
          folder.string(), old.string(), error.message());
    }
  }
  fs::remove_all(next, error);
}

void RemoveAbandoned(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (const fs::path& place : {folder.parent_path(), folder}) {
    for (fs::directory_iterator entry(place, error), end; !error && entry != end; entry.increment(error)) {
      if (IsUniqueName(entry->path().filename().string(), folder)) found.push_back(entry->path());
    }
  }
  for (const fs::path& path : found) {
    const FolderLock lock = FolderLock::Try(path);
    if (lock.is_held()) fs::remove_all(path, error);
  }
}

fs::path ExchangeFolder(const fs::path& staged, const fs::path& folder, const std::set<fs::path>& outdated,
                        std::error_code& error) {
  error = HoldsWorkingDirectory(folder) ? Error(EBUSY) : std::error_code();
  const fs::path next = Beside(folder, kNext);
  if (!error) fs::rename(staged, next, error);
  if (error) return {};
  std::error_code ignored;
  fs::path old;
  CarryOver carry_over(folder, next, folder, outdated);
  error = carry_over.All();
  if (!error) error = Swap(next, folder, old);
  if (error) {
    if (!fs::exists(folder, ignored)) return {};
    std::error_code undone = carry_over.Undo();
    if (!undone) fs::rename(next, staged, undone);
    if (undone) error = undone;
    return {};
  }
  const fs::path unique = UniquePath(folder.parent_path(), folder);
  fs::rename(old, unique, ignored);
  if (ignored) return {};
  // Files that another program has made meanwhile.
  return CarryOver(unique, folder, folder, outdated).All() ? fs::path() : unique;
}

bool CannotBeExchanged(const std::error_code& error) {
  constexpr int kReasons[] = {EACCES,       EBUSY,   EEXIST,    EINVAL, ENOSYS,     EMLINK, EPERM,
                              ENAMETOOLONG, ENOTDIR, ENOTEMPTY, EROFS,  EOPNOTSUPP, EXDEV};
  return std::find(std::begin(kReasons), std::end(kReasons), error.value()) != std::end(kReasons);
}

}  // namespace sonarcal::data_io
