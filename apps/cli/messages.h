// Messages of a run: where they go, by --quiet, --verbose and --log.
//
//                  terminal (stderr)     --log FILE
//   error          always                yes
//   note           unless --quiet        yes
//   detail         with --verbose        yes
//
// With --verbose, notes and details begin with the seconds since the start. Each line of the log begins with
// the local time and is written at once, so an interrupted run leaves a complete log. All functions are
// thread-safe.
#pragma once

#include <filesystem>
#include <string_view>

namespace sonarcal::cli {

enum class MessageKind { kError, kNote, kDetail };

struct MessageSettings {
  bool verbose = false;
  std::filesystem::path log;  // empty: none. Appends to a file that exists.
};

// True for a file that is empty or begins as a log does, with the time of a message.
bool IsLog(const std::filesystem::path& file);

// Sets the destinations for the rest of the program. --quiet is left to the callers of kNote, see PrintNote
// in apps/cli/command.h. Throws DataError if the log cannot be written.
void StartMessages(const MessageSettings& settings);

// Prints a message. In the log, and as an error, it is one line.
void PrintMessage(MessageKind kind, std::string_view sentence);

// Prints a detail: a file that is read or written, the time of a phase, the origin of an option.
void PrintDetail(std::string_view sentence);

// Writes a line to the log only. Ignored without a log.
void LogLine(std::string_view line);

bool HasLog();

}  // namespace sonarcal::cli
