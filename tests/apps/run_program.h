// The program as a shell runs it. SONARCAL_BINARY is its path.
#pragma once

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/temp_dir.h"

namespace sonarcal::testing {

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;
};

// Words before a command whose memory is measured. AddressSanitizer holds up to 256 MB of freed memory back;
// with these words only 1 MB. Without the sanitizer they have no effect.
inline constexpr const char* kFreeSoon = "env ASAN_OPTIONS=\"$ASAN_OPTIONS:quarantine_size_mb=1\"";

// Runs `PREFIX sonarcal ARGUMENTS` in a shell; single quotes guard what is quoted.
inline Outcome RunSonarcal(const std::string& arguments, const std::string& prefix = "") {
  const TempDir dir;
  const std::string command = prefix + ' ' + std::string(SONARCAL_BINARY) + ' ' + arguments + " >'" +
                              (dir / "out").string() + "' 2>'" + (dir / "err").string() + "'";
  const int wait_status = std::system(command.c_str());
  return {WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1, ReadFile(dir / "out"),
          ReadFile(dir / "err")};
}

// The same with `folder` as the working folder.
inline Outcome RunSonarcalIn(const std::filesystem::path& folder, const std::string& arguments) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  Outcome outcome = RunSonarcal(arguments);
  std::filesystem::current_path(before);
  return outcome;
}

inline std::string Quoted(const std::filesystem::path& path) {
  return fmt::format("'{}'", path.string());
}

}  // namespace sonarcal::testing
