// Replaces a folder by another one in one step, so that a killed program or a full disk leaves one of them.
//
// Files of the old folder that the new one is to keep are first linked into it (hard links), so they are in
// both until the old one is removed. Then the two change places (renameat2 with RENAME_EXCHANGE). A file
// system that cannot do this gets two renames: a program killed between them leaves the old folder as
// .NAME.partial-replaced and none called NAME, and the next FinishExchange() puts it back.
//
// Callers of ExchangeFolder, FinishExchange and RemoveAbandoned hold LockOfParent().
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

namespace sonarcal::data_io {

// Exclusive lock of a folder. It ends with the object or the process. A disk without locks has none.
class FolderLock {
 public:
  FolderLock() = default;
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;

  // Locks `folder` unless another process or object has locked it.
  static FolderLock Try(const std::filesystem::path& folder);

  bool is_held() const { return file_ >= 0; }
  bool is_busy() const { return is_busy_; }  // somebody else holds it

 private:
  int file_ = -1;
  bool is_busy_ = false;
};

// Locks the parent of `folder`, so that no other run stages outputs for `folder` or exchanges it. Waits up to
// 5 s: another program may lock the parent for purposes of its own.
FolderLock LockOfParent(const std::filesystem::path& folder);

// Name of `folder` in the names of its staged outputs. Of a long name only a part, with a hash of the whole,
// because a file system allows 255 bytes.
std::string StagedStem(const std::filesystem::path& folder);

// True if the name of a file or folder may be that of staged outputs, for whatever folder.
bool IsStagedName(std::string_view name);

// Returns a hidden path in `place`, for outputs staged for `folder`, that no other process or thread uses.
std::filesystem::path UniquePath(const std::filesystem::path& place, const std::filesystem::path& folder);

// Name of staged outputs for `folder` that a later run can find.
std::filesystem::path UnfinishedName(const std::filesystem::path& folder);

// Throws DataError if another run holds `lock`, that of its outputs for `folder`. It may put them in place
// for longer than LockOfParent() waits.
void RefuseIfBusy(const FolderLock& lock, const std::filesystem::path& folder);

// Restores `folder` if a program was killed between two renames, and removes what remains of an exchange.
// Throws DataError if an exchange is under way, if `folder` was made anew meanwhile, or if the disk refuses
// to rename.
void FinishExchange(const std::filesystem::path& folder);

// Removes the folders at UniquePath() of killed programs, beside and in `folder`: those that nobody locks.
void RemoveAbandoned(const std::filesystem::path& folder);

// Puts `staged` in the place of `folder`, with the files of `folder` that `staged` does not have, except the
// `outdated` ones (paths within it). Returns the path of the old folder, which may be removed; empty if a
// later run has to remove it.
//
// On failure sets `error` and changes neither, except if the disk also refuses to undo a step. In this case
// `staged` does not exist, and the next FinishExchange() restores `folder`.
std::filesystem::path ExchangeFolder(const std::filesystem::path& staged, const std::filesystem::path& folder,
                                     const std::set<std::filesystem::path>& outdated, std::error_code& error);

// True for an error of ExchangeFolder that is due to the kind of folder, not to the state of the disk: the
// working directory, a mount point, a parent that is not writable, files or folders of another user, files
// that cannot be linked, or another program that writes into it.
bool CannotBeExchanged(const std::error_code& error);

}  // namespace sonarcal::data_io
