// What an action is refused with, and damage that any reader must survive.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <random>
#include <string>

#include "core/types/error.h"

namespace sonarcal::testing {

// The message of the DataError that `action` throws; empty, and a failed test, where it throws none.
template <typename Action>
std::string MessageOf(const Action& action) {
  try {
    action();
  } catch (const DataError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no DataError was thrown";
  return {};
}

// Feeds `read` with `bytes` cut at `cuts` places and with random bytes changed `flips` times: it returns or
// throws DataError; anything else fails the test.
template <typename Read>
void ExpectSurvivesDamage(const std::string& bytes, std::size_t cuts, unsigned flips, const Read& read) {
  const auto expect_survives = [&read](const std::string& damaged, const std::string& how) {
    try {
      read(damaged);
    } catch (const DataError& error) {
      EXPECT_STRNE(error.what(), "");
    } catch (const std::exception& error) {
      ADD_FAILURE() << how << ": something else than a DataError: " << error.what();
    }
  };
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / cuts);
  for (std::size_t length = 0; length < bytes.size(); length += step) {
    expect_survives(bytes.substr(0, length), "cut to " + std::to_string(length));
  }
  for (unsigned seed = 1; seed <= flips; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = bytes;
    for (unsigned i = 0; i < 1 + seed % 4; ++i)
      damaged[random() % bytes.size()] = static_cast<char>(random());
    expect_survives(damaged, "seed " + std::to_string(seed));
  }
}

}  // namespace sonarcal::testing
