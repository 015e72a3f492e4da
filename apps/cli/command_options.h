// What a command takes, as documentation shows it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace sonarcal::cli {

struct DocumentedOption {
  std::vector<std::string> names;  // "-q", "--quiet"; of an argument its name, "FILE"
  std::string value;               // "DIR", "paper|acoustic"; empty for flags and arguments
  std::string description;         // with "(required)" or "(default: 8)" at its end
  std::vector<std::string> words;  // what the value may be, where it is one of a few
  bool is_argument = false;
};

// The commands that users see, in the order of --help.
std::vector<const CLI::App*> DocumentedCommands(const CLI::App& root);

std::vector<DocumentedOption> DocumentedOptions(const CLI::App& command);

}  // namespace sonarcal::cli
