// An option whose value is one of a few words, held as the enumeration they name.
//
//   constexpr JsonWords<Sampling, 2> kSamplings = {{{"frustum", Sampling::kFrustum}, ...}};
//   AddChoice(*command, "--sampling", options->sampling, kSamplings, "How rays are spread");
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "data_io/json/json_reader.h"

namespace sonarcal {
namespace internal {

template <typename E, std::size_t N, typename Store>
CLI::Option* AddChoice(CLI::App& command, const std::string& name, const JsonWords<E, N>& words,
                       const std::string& description, Store store) {
  std::string expected;
  for (const auto& [word, meaning] : words) expected += (expected.empty() ? "" : "|") + std::string(word);
  const auto read = [name, words, expected, store](const CLI::results_t& results) {
    for (const auto& [word, meaning] : words) {
      if (word != results.back()) continue;
      store(meaning);
      return true;
    }
    throw CLI::ValidationError(name, "'" + results.back() + "', expected " + expected);
  };
  return command.add_option(name, read, description)->type_name(expected);
}

}  // namespace internal

// `value` holds the default.
template <typename E, std::size_t N>
CLI::Option* AddChoice(CLI::App& command, const std::string& name, E& value, const JsonWords<E, N>& words,
                       const std::string& description) {
  return internal::AddChoice(command, name, words, description, [&value](E chosen) { value = chosen; })
      ->default_str(std::string(JsonWord(words, value)));
}

// Without a default: nothing where the option is not given.
template <typename E, std::size_t N>
CLI::Option* AddChoice(CLI::App& command, const std::string& name, std::optional<E>& value,
                       const JsonWords<E, N>& words, const std::string& description) {
  return internal::AddChoice(command, name, words, description, [&value](E chosen) { value = chosen; });
}

}  // namespace sonarcal
