// An argument or option of a command, for documentation.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace sonarcal::cli {

struct DocumentedOption {
  std::vector<std::string> names;  // "-q", "--quiet"; for an argument its name, "FILE"
  std::string value;               // "DIR", "paper|acoustic"; empty for flags and arguments
  std::string description;         // ends with "(required)" or "(default: 8)"
  std::vector<std::string> words;  // possible values, if they are a few words
  bool is_argument = false;
};

// Returns the commands that users see, in the order of --help.
std::vector<const CLI::App*> DocumentedCommands(const CLI::App& root);

std::vector<DocumentedOption> DocumentedOptions(const CLI::App& command);

}  // namespace sonarcal::cli
