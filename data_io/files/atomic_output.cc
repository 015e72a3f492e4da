#include "data_io/files/atomic_output.h"

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/folder_moves.h"
#include "data_io/files/folder_path.h"

namespace sonarcal::data_io {

namespace fs = std::filesystem;

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

OutputDirectory::OutputDirectory(const fs::path& directory, Aside aside) : final_(PlainFolder(directory)) {
  std::error_code error;
  const fs::file_status status = fs::status(final_, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw DataError("{}: cannot be the output directory: it is a file", directory.string());
  }
  if (!fs::exists(status) && fs::is_symlink(fs::symlink_status(final_, error)))
    throw DataError("{}: cannot be the output directory: it is a link to nothing", directory.string());
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
  FinishMoves(place_);
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
  RefuseIfBusy(lock_, final_);
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
  FinishMoves(place_);
  std::error_code error;
  if (!fs::exists(place_, error)) {
    fs::rename(staging_, place_, error);
    if (error) FailToWrite(final_, error);
  } else {
    FilesToMove(staging_, place_);  // refuses before anything changes
    const Names outdated = earlier != nullptr ? (*earlier)() : Names();
    fs::path old;
    if (earlier != nullptr) old = ExchangeFolder(staging_, place_, outdated, error);
    if (earlier != nullptr && !error) {
      staging_ = old;
    } else if (earlier == nullptr || (CannotBeExchanged(error) && fs::exists(staging_))) {
      MoveFiles(staging_, place_, outdated);
    } else {
      FailToWrite(final_, error);
    }
  }
  kept_ = false;
}

}  // namespace sonarcal::data_io
