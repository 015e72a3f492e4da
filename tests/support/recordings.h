// Where the real recordings are, if anywhere: $SONARCAL_RECORDINGS, or recordings/ at the project's root.
// They never enter the repository, so a test that needs one is skipped, with a sentence, where it is absent.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

namespace sonarcal::testing {

// Path of a file or folder of the recordings, or nothing.
std::optional<std::filesystem::path> FindRecording(const std::string& relative_path);

}  // namespace sonarcal::testing

// Declares `const std::filesystem::path variable`, or skips the test.
#define SONARCAL_NEEDS_RECORDING(variable, relative_path)                                             \
  const auto variable##_found = ::sonarcal::testing::FindRecording(relative_path);                    \
  if (!variable##_found) {                                                                            \
    GTEST_SKIP()                                                                                      \
        << "needs the recording " << (relative_path)                                                  \
        << ", which is neither under $SONARCAL_RECORDINGS nor under recordings/ at the project root"; \
  }                                                                                                   \
  /* NOLINTNEXTLINE(bugprone-macro-parentheses): a name */                                            \
  [[maybe_unused]] const std::filesystem::path& variable = *variable##_found
