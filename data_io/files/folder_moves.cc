#include "data_io/files/folder_moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/folder_exchange.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

using Names = std::set<fs::path>;

constexpr const char* kOutdated = ".outdated";  // names to remove, each with a 0 behind it

fs::path MovesOf(const fs::path& folder) {
  return folder / fmt::format(".{}.partial-moving", StagedStem(folder));
}

int Turn(const fs::path& path) {
  if (path == "provenance.json") return 2;
  return path.extension() == ".json" ? 1 : 0;
}

void WriteOutdated(const fs::path& file, const Names& outdated) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  for (const fs::path& name : outdated) stream << name.string() << '\0';
  stream.close();
  if (!stream) FailToWrite(file);
}

Names ReadOutdated(const fs::path& file) {
  Names names;
  std::ifstream stream(file, std::ios::binary);
  for (std::string name; std::getline(stream, name, '\0');) names.insert(name);
  return names;
}

// Looks for the names among the files that are there, because a name may lead out of the folder.
void RemoveOutdated(const fs::path& folder, const Names& outdated) {
  if (outdated.empty()) return;
  Names present;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, kOptions)) {
    const fs::path name = entry.path().lexically_relative(folder);
    if (entry.symlink_status().type() == fs::file_type::regular && outdated.contains(name))
      present.insert(name);
  }
  for (const fs::path& name : present) {
    std::error_code error;
    if (!fs::remove(folder / name, error) && error) FailToWrite(folder / name, error);
    for (fs::path parent = name.parent_path(); !parent.empty(); parent = parent.parent_path()) {
      if (!fs::remove(folder / parent, error)) break;  // fails, as intended, if the directory is not empty
    }
  }
}

void MoveRest(const fs::path& moves, const fs::path& folder) {
  const std::vector<fs::path> files = FilesToMove(moves, folder);
  const Names outdated = ReadOutdated(moves / kOutdated);
  bool is_removed = false;
  for (const fs::path& name : files) {
    if (Turn(name) == 2 && !std::exchange(is_removed, true)) RemoveOutdated(folder, outdated);
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    if (!error) fs::rename(moves / name, folder / name, error);
    if (error) FailToWrite(folder / name, error);
  }
  if (!is_removed) RemoveOutdated(folder, outdated);
  std::error_code error;
  fs::remove_all(moves, error);
  if (error) FailToWrite(folder, error);
}

}  // namespace

std::vector<fs::path> FilesToMove(const fs::path& staged, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staged)) {
    const fs::path name = entry.path().lexically_relative(staged);
    if (!entry.is_directory()) {
      if (name == kOutdated) continue;
      files.push_back(name);
      RefuseWhatIsNoFile(folder / name);
    } else if (fs::exists(folder / name) && !fs::is_directory(folder / name)) {
      throw DataError("{}: cannot be written: there is a file of this name, expected a directory or nothing",
                      (folder / name).string());
    }
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return Turn(a) != Turn(b) ? Turn(a) < Turn(b) : a < b;
  });
  return files;
}

void MoveFiles(const fs::path& staged, const fs::path& folder, const Names& outdated) {
  Names gone = outdated;
  for (const fs::path& name : FilesToMove(staged, folder)) gone.erase(name);
  WriteOutdated(staged / kOutdated, gone);
  const fs::path moves = MovesOf(folder);
  std::error_code error;
  fs::rename(staged, moves, error);
  if (error) FailToWrite(folder, error);
  MoveRest(moves, folder);
}

void FinishMoves(const fs::path& folder) {
  if (!HasUnfinishedMoves(folder)) return;
  RefuseIfBusy(FolderLock::Try(MovesOf(folder)), folder);
  MoveRest(MovesOf(folder), folder);
}

bool HasUnfinishedMoves(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(fs::symlink_status(MovesOf(folder), error));
}

}  // namespace sonarcal::data_io
