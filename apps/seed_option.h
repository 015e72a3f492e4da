// --seed, for every command that draws random numbers.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace sonarcal {

// `seed`: a std::uint64_t, or an optional one. CLI11 alone would take -1 for 2^64 - 1.
template <typename Seed>
CLI::Option* AddSeed(CLI::App& command, Seed& seed, const std::string& description) {
  const CLI::Validator is_whole(
      [](std::string& text) {
        const bool is_number = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        return is_number ? std::string() : "'" + text + "', expected a whole number from 0 on";
      },
      "");
  return command.add_option("--seed", seed, description)->type_name("N")->check(is_whole);
}

}  // namespace sonarcal
