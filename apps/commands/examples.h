// Examples at the end of --help.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sonarcal::commands {

enum class Needs {
  kNothing,
  kTime,   // minutes, or a user who ends it
  kFiles,  // files of the user
};

struct Example {
  std::string command;             // "fit"
  std::vector<std::string> lines;  // works from an empty folder on, unless it needs files
  Needs needs = Needs::kNothing;
};

// One example per command.
const std::vector<Example>& Examples();

// Ends the help of each command with its example, and that of the program with the first steps.
void AddExamples(CLI::App& app);

}  // namespace sonarcal::commands
