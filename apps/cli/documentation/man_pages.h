// Manual pages, generated from the commands, so that they agree with --help.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sonarcal::cli {

// Returns roff (man macros) of "sonarcal.1": purpose of the program, commands, exit statuses. `version` as in
// --version.
std::string ProgramManPage(const CLI::App& root, const std::string& version);

// Returns roff of "sonarcal-NAME.1": usage, arguments and options with their defaults.
std::string CommandManPage(const CLI::App& command, const std::string& version);

}  // namespace sonarcal::cli
