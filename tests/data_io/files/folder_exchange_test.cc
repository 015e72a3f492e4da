// Outputs that replace a folder: the program is killed at each system call of a commit, or each call fails,
// and the folder is wholly old or wholly new.
#include "data_io/files/folder_exchange.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/files/folder_moves.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace {

enum class Fate { kFail, kKillBefore, kKillAfter };

// Fate of the system calls below.
struct Faults {
  bool is_armed = false;
  int calls = 0;               // so far
  int at = -1;                 // number of the call that meets its fate
  bool lasts = false;          // all later ones do, too
  std::string_view only = {};  // the calls of this name; empty: all
  Fate fate = Fate::kFail;
  int error = 0;             // of kFail
  bool has_exchange = true;  // of the file system
  bool has_locks = true;
  bool is_mount = false;  // the folder is a mount point, which cannot be exchanged
};

Faults faults;

// The calls meet their fates until the end of its life.
class Armed {
 public:
  Armed() { faults.is_armed = true; }
  ~Armed() { faults.is_armed = false; }
  Armed(const Armed&) = delete;
  Armed& operator=(const Armed&) = delete;
};

template <typename Call>
int Pass(std::string_view name, const Call& call) {
  if (!faults.is_armed || (!faults.only.empty() && faults.only != name)) return static_cast<int>(call());
  const int number = faults.calls++;
  const bool is_hit = number == faults.at || (faults.lasts && faults.at >= 0 && number > faults.at);
  if (is_hit && faults.fate == Fate::kFail) {
    errno = faults.error;
    return -1;
  }
  if (is_hit && faults.fate == Fate::kKillBefore) raise(SIGKILL);
  const int result = static_cast<int>(call());
  if (is_hit) raise(SIGKILL);
  return result;
}

int RenameAt(const char* from, const char* to, unsigned flags) {
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, flags));
}

}  // namespace

// These stand in front of the functions of the C library, also for the C++ library. They have other names,
// because the C library reserves the names of its parameters, and flock is also a struct.
extern "C" {

int Rename(const char* from, const char* to) noexcept __asm__("rename");
int RenameOrExchange(int, const char* from, int, const char* to, unsigned flags) noexcept
    __asm__("renameat2");
int LinkAt(int from_dir, const char* from, int to_dir, const char* to, int flags) noexcept __asm__("linkat");
int MakeFolder(const char* path, mode_t mode) noexcept __asm__("mkdir");
int ChangeModeAt(int dir, const char* path, mode_t mode, int flags) noexcept __asm__("fchmodat");
int UnlinkAt(int dir, const char* path, int flags) noexcept __asm__("unlinkat");
int Remove(const char* path) noexcept __asm__("remove");
int LockFile(int file, int operation) noexcept __asm__("flock");

int Rename(const char* from, const char* to) noexcept {
  return Pass("rename", [&] { return RenameAt(from, to, 0); });
}

int RenameOrExchange(int /*from_dir*/, const char* from, int /*to_dir*/, const char* to,
                     unsigned flags) noexcept {
  return Pass("renameat2", [&] {
    if (faults.is_armed && faults.is_mount) {
      errno = EBUSY;
      return -1;
    }
    if (faults.has_exchange || !faults.is_armed) return RenameAt(from, to, flags);
    errno = EINVAL;
    return -1;
  });
}

int LinkAt(int from_dir, const char* from, int to_dir, const char* to, int flags) noexcept {
  return Pass("linkat", [&] { return syscall(SYS_linkat, from_dir, from, to_dir, to, flags); });
}

int MakeFolder(const char* path, mode_t mode) noexcept {
  return Pass("mkdir", [&] { return syscall(SYS_mkdirat, AT_FDCWD, path, mode); });
}

int ChangeModeAt(int dir, const char* path, mode_t mode, int /*flags*/) noexcept {
  return Pass("fchmodat", [&] { return syscall(SYS_fchmodat, dir, path, mode); });
}

int UnlinkAt(int dir, const char* path, int flags) noexcept {
  return Pass("unlinkat", [&] { return syscall(SYS_unlinkat, dir, path, flags); });
}

int Remove(const char* path) noexcept {
  return Pass("remove", [&] {
    const auto result = syscall(SYS_unlinkat, AT_FDCWD, path, 0);
    return result != 0 && errno == EISDIR ? syscall(SYS_unlinkat, AT_FDCWD, path, AT_REMOVEDIR) : result;
  });
}

int LockFile(int file, int operation) noexcept {
  if (!faults.is_armed || faults.has_locks) return static_cast<int>(syscall(SYS_flock, file, operation));
  errno = ENOTSUP;
  return -1;
}

}  // extern "C"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MessageOf;
using testing::ReadFile;
using testing::TempDir;
using testing::WriteFile;

using Names = std::set<fs::path>;
using Contents = std::map<std::string, std::string>;

const Contents kOld = {{"a.png", "old"},
                       {"b.png", "old"},
                       {"gone/d.png", "old"},
                       {"recording.json", "old"},
                       {"sub/c.png", "old"}};
const Contents kNew = {
    {"a.png", "new"}, {"more/f.png", "new"}, {"recording.json", "new"}, {"sub/e.png", "new"}};
const Contents kForeign = {
    {".hidden", "mine"}, {"deep/er/mine.txt", "mine"}, {"notes.txt", "mine"}, {"sub/mine.txt", "mine"}};

Names NamesOf(const Contents& contents) {
  Names names;
  for (const auto& [name, text] : contents) names.insert(name);
  return names;
}

Contents operator+(Contents a, const Contents& b) {
  a.insert(b.begin(), b.end());
  return a;
}

void Write(const fs::path& folder, const Contents& contents) {
  for (const auto& [name, text] : contents) {
    fs::create_directories((folder / name).parent_path());
    WriteFile(folder / name, text);
  }
}

int EntryCount(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

bool IsStaged(const fs::path& path) {
  return path.filename().string().starts_with(".out.");
}

// Files of a folder without staged ones; nullopt if there is no folder.
std::optional<Contents> Read(const fs::path& folder) {
  if (!fs::exists(folder)) return std::nullopt;
  Contents contents;
  for (fs::recursive_directory_iterator entry(folder), end; entry != end; ++entry) {
    if (IsStaged(entry->path())) {
      entry.disable_recursion_pending();
    } else if (!entry->is_directory()) {
      contents[entry->path().lexically_relative(folder).string()] = ReadFile(entry->path());
    }
  }
  return contents;
}

// Hidden folders beside `out` and in it.
std::vector<std::string> Leftovers(const fs::path& out) {
  std::vector<std::string> names;
  for (const fs::path& place : {out.parent_path(), out}) {
    if (!fs::exists(place)) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(place)) {
      if (IsStaged(entry.path())) names.push_back(entry.path().filename().string());
    }
  }
  return names;
}

struct Scenario {
  const char* name;
  bool exists = true;  // an older output
  Contents foreign = {};
  bool has_exchange = true;
  bool is_mount = false;
  Aside aside = Aside::kThisRun;
};

const Scenario kScenarios[] = {
    {.name = "new", .exists = false},
    {.name = "own"},
    {.name = "foreign files", .foreign = kForeign},
    {.name = "no exchange", .foreign = kForeign, .has_exchange = false},
    {.name = "mount point", .foreign = kForeign, .is_mount = true},
    {.name = "kept aside", .foreign = kForeign, .aside = Aside::kAnew},
};

class Replacing {
 public:
  explicit Replacing(const Scenario& scenario) : scenario_(scenario) {
    if (scenario.exists) Write(out(), before());
  }

  fs::path out() const { return dir_ / "out"; }
  Contents before() const { return kOld + scenario_.foreign; }
  Contents after() const { return kNew + scenario_.foreign; }

  // One run of a command, with these faults.
  void Run(const Faults& with = {}) const {
    faults = with;
    faults.has_exchange = scenario_.has_exchange;
    faults.is_mount = scenario_.is_mount;
    const Armed armed;
    OutputDirectory output(out(), scenario_.aside);
    faults.is_armed = false;
    Write(output.staging(), kNew);
    if (scenario_.aside == Aside::kAnew) output.Keep();
    faults.is_armed = true;
    output.Replace([&] { return NamesOf(kOld); });
  }

  // Run in a process of its own. Returns whether it was killed.
  bool RunToDeath(const Faults& with) const {
    const pid_t child = fork();
    if (child == 0) {
      try {
        Run(with);
      } catch (...) {
        _exit(3);
      }
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0) << status;
    return WIFSIGNALED(status);
  }

  bool IsWhole() const {
    const std::optional<Contents> contents = Read(out());
    return contents ? contents == after() || contents == before() : !scenario_.exists;
  }

  // True if a reader is told that only a part is there, and if the next run moves the rest.
  bool IsBeingMoved() const { return scenario_.is_mount && HasUnfinishedMoves(out()); }

  void ExpectWhole() const {
    if (IsBeingMoved()) return;
    // Between two renames there is neither, until the next run.
    if (!scenario_.has_exchange && !Read(out())) return;
    EXPECT_TRUE(IsWhole()) << ::testing::PrintToString(Read(out()).value_or(Contents()));
  }

  // A run that fails cleans up, and one that succeeds replaces the outputs.
  void ExpectRecovery() const {
    { const OutputDirectory output(out(), scenario_.aside); }
    EXPECT_TRUE(IsWhole()) << ::testing::PrintToString(Read(out()).value_or(Contents()));
    EXPECT_THAT(Leftovers(out()), IsEmpty());
    Run();
    EXPECT_EQ(Read(out()), after());
    EXPECT_THAT(Leftovers(out()), IsEmpty());
    EXPECT_EQ(EntryCount(dir_.path()), 1);
  }

 private:
  Scenario scenario_;
  TempDir dir_;
};

TEST(FolderExchangeTest, KilledAtAnyCallItLeavesOldOrNew) {
  for (const Scenario& scenario : kScenarios) {
    for (const Fate fate : {Fate::kKillBefore, Fate::kKillAfter}) {
      bool is_killed = true;
      int call = 0;
      for (; is_killed; ++call) {
        SCOPED_TRACE(fmt::format("{}, {} call {}", scenario.name,
                                 fate == Fate::kKillBefore ? "before" : "after", call));
        const Replacing replacing(scenario);
        is_killed = replacing.RunToDeath({.at = call, .fate = fate});
        replacing.ExpectWhole();
        if (!is_killed) {
          EXPECT_EQ(Read(replacing.out()), replacing.after());
        }
        replacing.ExpectRecovery();
      }
      EXPECT_GE(call, scenario.exists ? 10 : 3) << scenario.name;
    }
  }
}

TEST(FolderExchangeTest, IfAnyCallFailsItIsOldOrNew) {
  for (const Scenario& scenario : kScenarios) {
    for (const bool lasts : {false, true}) {
      for (const int error : lasts ? std::vector{EIO} : std::vector{ENOSPC, EDQUOT, EIO}) {
        bool is_hit = true;
        for (int call = 0; is_hit; ++call) {
          SCOPED_TRACE(
              fmt::format("{}, error {} {} call {}", scenario.name, error, lasts ? "from" : "at", call));
          const Replacing replacing(scenario);
          std::optional<std::string> message;
          try {
            replacing.Run({.at = call, .lasts = lasts, .error = error});
          } catch (const DataError& failure) {
            message = failure.what();
          }
          is_hit = faults.calls > call;
          const std::optional<Contents> contents = Read(replacing.out());
          if (message) {
            EXPECT_THAT(*message, HasSubstr(std::generic_category().message(error)));
            EXPECT_THAT(*message, ::testing::Not(HasSubstr("\n")));
            EXPECT_TRUE(contents != replacing.after() || replacing.IsBeingMoved());
          } else {
            EXPECT_EQ(contents, replacing.after());
          }
          replacing.ExpectWhole();
          if (!lasts) {
            EXPECT_TRUE(replacing.IsWhole() || replacing.IsBeingMoved());
            // A mount point was refused once already. A second failure may leave that to the next run.
            EXPECT_TRUE(!message || scenario.is_mount || scenario.aside == Aside::kAnew ||
                        Leftovers(replacing.out()).empty());
          }
          replacing.ExpectRecovery();
        }
      }
    }
  }
}

TEST(FolderExchangeTest, OutputsKeptAsideOutliveAFullDisk) {
  const Replacing replacing({.name = "", .foreign = kForeign, .aside = Aside::kAnew});
  EXPECT_THAT(MessageOf([&] { replacing.Run({.at = 2, .only = "linkat", .error = ENOSPC}); }),
              HasSubstr("out: cannot be written: No space left"));
  OutputDirectory output(replacing.out(), Aside::kFound);
  EXPECT_TRUE(output.found());
  EXPECT_EQ(Read(output.staging()), kNew) << "and none of the files that stay";
  output.Replace([] { return NamesOf(kOld); });
  EXPECT_EQ(Read(replacing.out()), replacing.after());
}

TEST(FolderExchangeTest, FilesOfOthersStayTheSameFiles) {
  const Replacing replacing({.name = "", .foreign = kForeign});
  const fs::path out = replacing.out();
  fs::create_symlink("nowhere", out / "link");
  fs::create_directories(out / "empty/within");
  fs::permissions(out / "deep", fs::perms(0710));
  fs::permissions(out, fs::perms(0750));
  struct stat before = {};
  struct stat after = {};
  ASSERT_EQ(stat((out / "sub/mine.txt").c_str(), &before), 0);
  {
    OutputDirectory output(out);
    Write(output.staging(), kNew);
    output.Replace([] { return NamesOf(kOld); });
  }
  ASSERT_EQ(stat((out / "sub/mine.txt").c_str(), &after), 0);
  EXPECT_EQ(after.st_ino, before.st_ino);
  EXPECT_EQ(after.st_nlink, 1U);
  EXPECT_EQ(fs::read_symlink(out / "link"), "nowhere");
  EXPECT_TRUE(fs::is_directory(out / "empty/within"));
  EXPECT_FALSE(fs::exists(out / "gone"));
  EXPECT_EQ(fs::status(out).permissions(), fs::perms(0750));
  EXPECT_EQ(fs::status(out / "deep").permissions(), fs::perms(0710));
}

TEST(FolderExchangeTest, AFolderThatCannotBeExchangedGetsItsFilesOneByOne) {
  for (const auto& [call, error] : std::vector<std::pair<std::string_view, int>>{{"renameat2", EBUSY},
                                                                                 {"renameat2", EXDEV},
                                                                                 {"linkat", EPERM},
                                                                                 {"linkat", EMLINK},
                                                                                 {"rename", EXDEV}}) {
    SCOPED_TRACE(fmt::format("{} {}", call, error));
    const Replacing replacing({.name = "", .foreign = kForeign});
    struct stat before = {};
    struct stat after = {};
    ASSERT_EQ(stat(replacing.out().c_str(), &before), 0);
    replacing.Run({.at = 0, .only = call, .error = error});
    ASSERT_EQ(stat(replacing.out().c_str(), &after), 0);
    EXPECT_EQ(after.st_ino, before.st_ino);
    EXPECT_EQ(Read(replacing.out()), replacing.after());
    EXPECT_FALSE(fs::exists(replacing.out() / "gone"));
    EXPECT_THAT(Leftovers(replacing.out()), IsEmpty());
  }
}

TEST(FolderExchangeTest, TheWorkingDirectoryStays) {
  const Replacing replacing({.name = "", .foreign = kForeign});
  const fs::path before = fs::current_path();
  fs::current_path(replacing.out() / "sub");
  replacing.Run();
  EXPECT_EQ(ReadFile("e.png"), "new");
  fs::current_path(before);
  EXPECT_EQ(Read(replacing.out()), replacing.after());
}

TEST(FolderExchangeTest, ALinkToAFolderStays) {
  const TempDir dir;
  Write(dir / "disk/real", kOld);
  fs::create_directory_symlink(dir / "disk/real", dir / "out");
  OutputDirectory output(dir / "out");
  Write(output.staging(), kNew);
  output.Replace([] { return NamesOf(kOld); });
  EXPECT_TRUE(fs::is_symlink(dir / "out"));
  EXPECT_EQ(Read(dir / "disk/real"), kNew);
  EXPECT_EQ(EntryCount(dir / "disk"), 1);
}

// A file system allows 255 bytes.
TEST(FolderExchangeTest, TheLongestNamesWork) {
  const TempDir dir;
  const fs::path out = dir / std::string(255, 'n');
  Write(out, kOld + kForeign);
  for (const Aside aside : {Aside::kThisRun, Aside::kAnew}) {
    OutputDirectory output(out, aside);
    Write(output.staging(), kNew);
    output.Replace([] { return NamesOf(kOld); });
    EXPECT_EQ(Read(out), kNew + kForeign);
  }
  WriteFileWhole(dir / std::string(250, 'f').append(".json"), "{}");
  EXPECT_EQ(EntryCount(dir.path()), 2);
  EXPECT_NE(StagedStem(dir / std::string(254, 'n').append("1")),
            StagedStem(dir / std::string(254, 'n').append("2")));
}

TEST(FolderExchangeTest, ADiskWithoutLocksWorks) {
  for (const Aside aside : {Aside::kThisRun, Aside::kAnew}) {
    const Replacing replacing({.name = "", .foreign = kForeign, .aside = aside});
    replacing.Run({.has_locks = false});
    EXPECT_EQ(Read(replacing.out()), replacing.after());
    EXPECT_THAT(Leftovers(replacing.out()), IsEmpty());
  }
}

// The wait for the lock of the parent ends after some seconds.
TEST(FolderExchangeTest, WhatARunIsPuttingInPlaceIsSafeFromOtherRuns) {
  const TempDir dir;
  Write(dir / "out", kOld);
  const std::vector<std::pair<fs::path, std::function<void()>>> cases = {
      {dir / ".out.partial-exchange", [&] { FinishExchange(dir / "out"); }},
      {dir / "out/.out.partial-moving", [&] { FinishMoves(dir / "out"); }}};
  for (const auto& [staged, finish] : cases) {
    SCOPED_TRACE(staged);
    Write(staged, kNew);
    {
      const FolderLock lock = FolderLock::Try(staged);
      EXPECT_THAT(MessageOf(finish),
                  HasSubstr("out: cannot be the output directory: another run is writing it"));
    }
    EXPECT_EQ(Read(staged), kNew);
    EXPECT_EQ(ReadFile(dir / "out/a.png"), "old");
    finish();
    EXPECT_FALSE(fs::exists(staged));
  }
  EXPECT_EQ(ReadFile(dir / "out/a.png"), "new") << "moved";
}

TEST(FolderExchangeTest, OfRunsAtOnceTheLastOneWins) {
  for (const bool exists : {false, true}) {
    SCOPED_TRACE(exists);
    const Replacing replacing({.name = "", .exists = exists, .foreign = exists ? kForeign : Contents()});
    OutputDirectory first(replacing.out());
    OutputDirectory second(replacing.out());
    Write(first.staging(), kNew);
    Write(second.staging(), {{"a.png", "second"}, {"g.png", "second"}});
    first.Replace([] { return NamesOf(kOld); });
    EXPECT_EQ(Read(replacing.out()), replacing.after());
    EXPECT_EQ(ReadFile(second / "g.png"), "second");
    second.Replace([] { return NamesOf(kNew); });
    EXPECT_EQ(ReadFile(replacing.out() / "a.png"), "second");
    EXPECT_FALSE(fs::exists(replacing.out() / "more"));
    EXPECT_THAT(Leftovers(replacing.out()), IsEmpty());
  }
}

TEST(FolderExchangeTest, OnlyWhatKilledRunsStagedIsRemoved) {
  const Replacing replacing({.name = ""});
  const fs::path out = replacing.out();
  Write(out.parent_path(),
        {{".out.partial-1-2/a", ""}, {".out.partial-mine/a", ""}, {".other.partial-1-2/a", ""}});
  Write(out, {{".out.partial-7-0/a", ""}, {".out.unfinished/a", ""}});
  const OutputDirectory under_way(out);
  const OutputDirectory output(out);
  EXPECT_TRUE(fs::exists(under_way.staging()));
  EXPECT_FALSE(fs::exists(out.parent_path() / ".out.partial-1-2"));
  EXPECT_FALSE(fs::exists(out / ".out.partial-7-0"));
  EXPECT_TRUE(fs::exists(out.parent_path() / ".out.partial-mine"));
  EXPECT_TRUE(fs::exists(out.parent_path() / ".other.partial-1-2"));
  EXPECT_TRUE(fs::exists(out / ".out.unfinished"));
}

TEST(FolderExchangeTest, AFolderMadeAnewAfterAKillIsNotOverwritten) {
  const Replacing replacing({.name = "", .foreign = kForeign, .has_exchange = false});
  const fs::path out = replacing.out();
  // Killed before the new folder is renamed: the third rename.
  ASSERT_TRUE(replacing.RunToDeath({.at = 2, .only = "rename", .fate = Fate::kKillBefore}));
  ASSERT_FALSE(fs::exists(out));
  Write(out, {{"mine.txt", "mine"}});
  EXPECT_THAT(MessageOf([&] { const OutputDirectory output(out); }),
              HasSubstr("a run that was killed left the earlier contents in"));
  EXPECT_EQ(Read(out), (Contents{{"mine.txt", "mine"}}));
  EXPECT_EQ(Read(out.parent_path() / ".out.partial-replaced"), replacing.before());
  fs::remove_all(out);
  fs::create_directory(out);
  replacing.ExpectRecovery();
}

TEST(FolderExchangeTest, OutputsWithinStagedOutputsDoNotWait) {
  const TempDir dir;
  OutputDirectory outer(dir / "out");
  OutputDirectory inner(outer / "recording");
  Write(inner.staging(), kNew);
  const FolderLock parent = FolderLock::Try(outer.staging());
  EXPECT_TRUE(parent.is_busy());
  inner.Commit();
  EXPECT_EQ(Read(outer / "recording"), kNew);
}

}  // namespace
}  // namespace sonarcal::data_io
