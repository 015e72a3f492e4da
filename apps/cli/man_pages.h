// Manual pages made from the commands themselves, so that they say what --help says.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sonarcal::cli {

// roff (man macros) of "sonarcal.1": what the program is, its commands, exit statuses. `version` as in
// --version.
std::string ProgramManPage(const CLI::App& root, const std::string& version);

// roff of "sonarcal-NAME.1": usage, arguments and options with their defaults.
std::string CommandManPage(const CLI::App& command, const std::string& version);

}  // namespace sonarcal::cli
