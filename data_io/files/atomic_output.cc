#include "data_io/files/atomic_output.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

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

// Names of the files to move into `place`, in their order. Throws DataError if one is in the way of another.
std::vector<fs::path> StagedFiles(const fs::path& staging, const fs::path& place) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging)) {
    const fs::path name = entry.path().lexically_relative(staging);
    if (!entry.is_directory()) {
      files.push_back(name);
      RefuseWhatIsNoFile(place / name);
    } else if (fs::exists(place / name) && !fs::is_directory(place / name)) {
      throw DataError("{}: cannot be written: there is a file of this name, expected a directory or nothing",
                      (place / name).string());
    }
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return Turn(a) != Turn(b) ? Turn(a) < Turn(b) : a < b;
  });
  return files;
}

}  // namespace

void WriteFileWhole(const fs::path& file, std::string_view bytes) {
  RefuseWhatIsNoFile(file);
  const fs::path aside = UniquePath(file.parent_path(), file);
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
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw DataError("{}: cannot be the output directory: it is a file", directory.string());
  }
  try {
    Stage(aside);
  } catch (const fs::filesystem_error& failure) {
    RemoveMadeParents();
    FailToWrite(final_, failure.code());
  } catch (...) {
    RemoveMadeParents();
    throw;
  }
}

// The staged files lie inside an existing directory (its parent may be on another disk or not writable), and
// beside a directory that does not exist yet.
void OutputDirectory::Stage(Aside aside) {
  std::error_code error;
  place_ = fs::canonical(final_, error);
  if (error) place_ = final_;
  for (fs::path parent = place_.parent_path(); !fs::exists(parent, error); parent = parent.parent_path()) {
    made_parents_.insert(made_parents_.begin(), parent);
  }
  for (const fs::path& parent : made_parents_) {
    if (!fs::create_directory(parent, error) && error) FailToWrite(final_, error);
  }
  const FolderLock lock = LockOfParent(place_);
  FinishExchange(place_);
  RemoveAbandoned(place_);
  const fs::path where = fs::exists(place_, error) ? place_ : place_.parent_path();
  const bool is_shared = aside != Aside::kThisRun;
  staging_ = is_shared ? where / UnfinishedName(place_) : UniquePath(where, place_);
  if (!fs::create_directory(staging_, error) && (error || !is_shared)) {
    FailToWrite(final_, error ? error : std::make_error_code(std::errc::file_exists));
  }
  lock_ = FolderLock::Try(staging_);
  if (is_shared) TakeOver(aside);
}

void OutputDirectory::TakeOver(Aside aside) {
  if (lock_.is_busy()) {
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

void OutputDirectory::RemoveMadeParents() const {
  std::error_code ignored;
  for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) {
    fs::remove(*parent, ignored);  // fails, as intended, if the directory is not empty
  }
}

OutputDirectory::~OutputDirectory() {
  std::error_code ignored;
  if (!kept_ && !staging_.empty()) fs::remove_all(staging_, ignored);
  RemoveMadeParents();
}

void OutputDirectory::Commit() {
  try {
    MoveIntoPlace(nullptr);
  } catch (const fs::filesystem_error& failure) {
    FailToWrite(final_, failure.code());
  }
}

void OutputDirectory::Replace(const std::function<Names()>& earlier) {
  try {
    MoveIntoPlace(&earlier);
  } catch (const fs::filesystem_error& failure) {
    FailToWrite(final_, failure.code());
  }
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);  // the old directory, after the lock
}

// After this, `staging_` is what has to be removed.
void OutputDirectory::MoveIntoPlace(const std::function<Names()>* earlier) {
  const FolderLock lock = LockOfParent(place_);
  FinishExchange(place_);
  std::error_code error;
  if (!fs::exists(place_, error)) {
    fs::rename(staging_, place_, error);
    if (error) FailToWrite(final_, error);
  } else {
    const std::vector<fs::path> files = StagedFiles(staging_, place_);
    const Names outdated = earlier != nullptr ? (*earlier)() : Names();
    fs::path old;
    if (earlier != nullptr) old = ExchangeFolder(staging_, place_, outdated, error);
    if (earlier != nullptr && !error) {
      staging_ = old;
    } else if (earlier == nullptr || (CannotBeExchanged(error) && fs::exists(staging_))) {
      MoveFilesIntoPlace(files, outdated);
    } else {
      FailToWrite(final_, error);
    }
  }
  kept_ = false;
}

void OutputDirectory::MoveFilesIntoPlace(const std::vector<fs::path>& files, const Names& outdated) const {
  Names gone = outdated;
  for (const fs::path& name : files) gone.erase(name);
  bool is_removed = false;
  for (const fs::path& name : files) {
    if (Turn(name) == 2 && !std::exchange(is_removed, true)) RemoveOutdated(gone);
    std::error_code error;
    fs::create_directories((place_ / name).parent_path(), error);
    fs::rename(staging_ / name, place_ / name, error);
    if (error) FailToWrite(final_ / name, error);
  }
  if (!is_removed) RemoveOutdated(gone);
}

// Looks for the names among the files that are there, because a name may lead out of the directory.
void OutputDirectory::RemoveOutdated(const Names& outdated) const {
  if (outdated.empty()) return;
  Names present;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(place_, kOptions)) {
    const fs::path name = entry.path().lexically_relative(place_);
    if (entry.symlink_status().type() == fs::file_type::regular && outdated.contains(name))
      present.insert(name);
  }
  for (const fs::path& name : present) {
    std::error_code error;
    if (!fs::remove(place_ / name, error) && error) FailToWrite(final_ / name, error);
    for (fs::path parent = name.parent_path(); !parent.empty(); parent = parent.parent_path()) {
      if (!fs::remove(place_ / parent, error)) break;  // fails, as intended, if the directory is not empty
    }
  }
}

}  // namespace sonarcal::data_io
