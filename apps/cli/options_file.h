// --options FILE of every command: a TOML or INI file with options by their long names, without dashes.
//
//   rays = "300x200"
//   seed = 7
//   fan = true
//   free = ["materials", "noise"]
//
// Options on the command line win. A path is relative to the working folder, as on the command line. The file
// gives options, not arguments, and has no sections. `fit --config` is another file: it describes the problem
// of a fit.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sonarcal::cli {

// Adds --options to a command.
void AddOptionsFile(CLI::App& command);

// Inserts the options of the file that `words` name after the name of the command, except those that `words`
// give. `words`: the command line without the program. Throws DataError if the file cannot be read, or gives
// an option that the command does not have.
void AddOptionsFromFile(const CLI::App& root, std::vector<std::string>& words);

// File of the last AddOptionsFromFile; empty if none was given.
const std::string& OptionsFile();

bool IsFromOptionsFile(const CLI::Option& option);

}  // namespace sonarcal::cli
