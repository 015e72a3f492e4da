// Refuses options that have no effect together with the other options.
#pragma once

#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace sonarcal {

using OptionNames = std::vector<std::string_view>;  // "--rays"

bool IsGiven(const CLI::App& command, std::string_view name);

// Throws UsageError "--rays has no effect WHY" for the first of these options that the user gave.
void RefuseGiven(const CLI::App& command, const OptionNames& names, std::string_view why);

// Refuses every option that the user gave except these, --json, --quiet, --force and --help.
void RefuseGivenExcept(const CLI::App& command, const OptionNames& names, std::string_view why);

// --scene-unit and --scene-up without --scene.
void RefuseSceneFormatAlone(const CLI::App& command);

}  // namespace sonarcal
