#include "apps/given_options.h"

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>

#include "core/types/error.h"

namespace sonarcal {
namespace {

bool Holds(const OptionNames& names, const CLI::Option& option) {
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return option.check_name(std::string(name)); });
}

template <typename Condition>
void RefuseWhere(const CLI::App& command, std::string_view why, Condition is_refused) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0 && is_refused(*option))
      throw UsageError("{} has no effect {}", option->get_name(), why);
  }
}

}  // namespace

bool IsGiven(const CLI::App& command, std::string_view name) {
  return command.count(std::string(name)) > 0;
}

void RefuseGiven(const CLI::App& command, const OptionNames& names, std::string_view why) {
  RefuseWhere(command, why, [&](const CLI::Option& option) { return Holds(names, option); });
}

void RefuseGivenExcept(const CLI::App& command, const OptionNames& names, std::string_view why) {
  static const OptionNames kOfEveryCommand = {"--json", "--quiet", "--force", "--help"};
  RefuseWhere(command, why, [&](const CLI::Option& option) {
    return !Holds(names, option) && !Holds(kOfEveryCommand, option);
  });
}

void RefuseSceneFormatAlone(const CLI::App& command) {
  if (!IsGiven(command, "--scene")) RefuseGiven(command, {"--scene-unit", "--scene-up"}, "without --scene");
}

}  // namespace sonarcal
