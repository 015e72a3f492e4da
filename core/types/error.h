// Three kinds of failure, kept apart:
//
//   DataError   the user's data or files are wrong: one sentence that names file, key or line, what was
//               found and what was expected. The command ends with status 1.
//   UsageError  the command line is wrong. Status 2.
//   SONARCAL_CHECK  a programmer's mistake: prints the condition and the message, then aborts by exception
//               (std::logic_error), so that nothing half-computed is ever written.
//
// A point at which a model cannot be evaluated is none of these: cost functions return false.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace sonarcal {

class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  template <typename... Args>
  explicit DataError(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  template <typename... Args>
  explicit UsageError(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

}  // namespace sonarcal

// SONARCAL_CHECK(rows > 0, "rows = {}", rows);
#define SONARCAL_CHECK(condition, ...)                                                                  \
  do {                                                                                                  \
    if (!(condition)) {                                                                                 \
      throw std::logic_error(fmt::format("{}:{}: check failed: {}: {}", __FILE__, __LINE__, #condition, \
                                         fmt::format(__VA_ARGS__)));                                    \
    }                                                                                                   \
  } while (false)
