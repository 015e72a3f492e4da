#include "apps/cli/documentation/command_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace sonarcal::cli {
namespace {

// Splits "frustum|beams" into its words. Returns none for "NAME|FILE", which are placeholders.
std::vector<std::string> WordsOf(const std::string& value) {
  const bool has_capitals =
      std::any_of(value.begin(), value.end(), [](unsigned char c) { return std::isupper(c) != 0; });
  if (value.find('|') == std::string::npos || has_capitals) return {};
  std::vector<std::string> words;
  std::istringstream stream(value);
  for (std::string word; std::getline(stream, word, '|');) words.push_back(word);
  return words;
}

}  // namespace

std::vector<const CLI::App*> DocumentedCommands(const CLI::App& root) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : root.get_subcommands({})) {
    if (!command->get_group().empty()) commands.push_back(command);
  }
  return commands;
}

std::vector<DocumentedOption> DocumentedOptions(const CLI::App& command) {
  std::vector<DocumentedOption> options;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    DocumentedOption documented;
    documented.is_argument = option->get_positional();
    if (documented.is_argument) {
      documented.names.push_back(option->get_name(true, false));
    } else {
      for (const std::string& name : option->get_snames()) documented.names.push_back("-" + name);
      for (const std::string& name : option->get_lnames()) documented.names.push_back("--" + name);
      if (option->get_type_size() != 0) documented.value = option->get_type_name();
    }
    documented.words = WordsOf(documented.value);
    documented.description = option->get_description();
    const std::string value = option->get_default_str();
    if (option->get_required() && !documented.is_argument) {
      documented.description += " (required)";
    } else if (option->get_type_size() != 0 && !value.empty() && value != "[]") {
      documented.description += fmt::format(" (default: {})", value);
    }
    options.push_back(std::move(documented));
  }
  return options;
}

}  // namespace sonarcal::cli
