// Refuses options that have no effect together with the other options.
#pragma once

#include <string_view>
#include <vector>

#include "apps/workflow/comparison_options.h"

namespace CLI {
class App;
}

namespace sonarcal::cli {

using OptionNames = std::vector<std::string_view>;  // "--rays"

bool IsGiven(const CLI::App& command, std::string_view name);

// Throws UsageError "--rays has no effect WHY" for the first of these options that the user gave.
void RefuseGiven(const CLI::App& command, const OptionNames& names, std::string_view why);

// Refuses every option that the user gave except these, --force and those of every command.
void RefuseGivenExcept(const CLI::App& command, const OptionNames& names, std::string_view why);

// Throws UsageError for settings of other segmentation methods than the chosen one.
void RefuseUnusedSegmentation(const CLI::App& command, const workflow::ComparisonOptions& options);

// Throws UsageError for --scene-unit and --scene-up without --scene.
void RefuseSceneFormatAlone(const CLI::App& command);

}  // namespace sonarcal::cli
