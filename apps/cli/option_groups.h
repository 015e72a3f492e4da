// Headings of the options of a command in --help.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sonarcal::cli {

// Gives each option of the command its group. Options of the command alone stay in "Options".
void GroupOptions(CLI::App& command);

// Groups in the order of --help.
const std::vector<std::string>& OptionGroups();

}  // namespace sonarcal::cli
