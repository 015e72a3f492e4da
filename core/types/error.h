// Three kinds of failure:
//
//   DataError       Wrong data or files of the user. One sentence that names file, key or line, the value
//                   found and the value expected. The command ends with status 1.
//   UsageError      Wrong command line. Status 2.
//   SONARCAL_CHECK  Programming error. Prints the condition and the message, then throws std::logic_error, so
//                   that no incomplete result is written.
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
