// Adds an option whose value is one of a few words (core/types/words.h).
//
//   AddChoice(*command, "--sampling", options->sampling, "How rays are spread");
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "apps/cli/add_options.h"
#include "core/types/words.h"

namespace sonarcal::cli {
namespace internal {

template <HasWords E, typename Store>
CLI::Option* AddChoice(CLI::App& command, const std::string& name, const std::string& description,
                       Store store) {
  const auto read = [name, store](const CLI::results_t& results) {
    const std::optional<E> value = FromWord<E>(results.back());
    if (!value) {
      throw CLI::ValidationError(name, UnknownWord(results.back(), JoinedWords<E>("|")));
    }
    store(*value);
    return true;
  };
  return command.add_option(name, read, description)->type_name(JoinedWords<E>("|"));
}

}  // namespace internal

// `value` holds the default.
template <HasWords E>
CLI::Option* AddChoice(CLI::App& command, const std::string& name, E& value, const std::string& description) {
  return internal::AddChoice<E>(command, name, description, [&value](E chosen) { value = chosen; })
      ->default_str(std::string(ToString(value)));
}

// As above without a default: nullopt if the option is not given.
template <HasWords E>
CLI::Option* AddChoice(CLI::App& command, const std::string& name, std::optional<E>& value,
                       const std::string& description) {
  return internal::AddChoice<E>(command, name, description, [&value](E chosen) { value = chosen; });
}

}  // namespace sonarcal::cli
