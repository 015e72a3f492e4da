// Moves outputs file by file into a folder that cannot be exchanged as a whole
// (data_io/files/folder_exchange.h), such as a mount point. The staged folder is first renamed to
// FOLDER/.NAME.partial-moving, with a list of the files to remove in it. From then on the outputs count as
// committed: if the program is killed, or if a disk refuses a move, the next run that opens the folder moves
// the rest.
//
// Callers of MoveFiles and FinishMoves hold LockOfParent().
#pragma once

#include <filesystem>
#include <set>
#include <vector>

namespace sonarcal::data_io {

// Names of the files to move from `staged` into `folder`, in their order: JSON files last, because they name
// the others, and provenance.json after all. Throws DataError if one is in the way of another.
std::vector<std::filesystem::path> FilesToMove(const std::filesystem::path& staged,
                                               const std::filesystem::path& folder);

// Moves all files of `staged` into `folder` and removes those of the `outdated` names that are not replaced,
// with the folders that become empty: after the new files, before the new provenance.json. Then removes
// `staged`. Throws DataError if the disk refuses a step. If `staged` still exists then, nothing was moved.
void MoveFiles(const std::filesystem::path& staged, const std::filesystem::path& folder,
               const std::set<std::filesystem::path>& outdated);

// Moves the rest of a run that was killed. Throws DataError if that run is under way, or if the disk refuses
// a step.
void FinishMoves(const std::filesystem::path& folder);

// True if only some of the files of a run have been moved into `folder` so far.
bool HasUnfinishedMoves(const std::filesystem::path& folder);

}  // namespace sonarcal::data_io
