#include "apps/cli/options_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <sstream>

#include <CLI/CLI.hpp>

#include "apps/cli/documentation/command_options.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::cli {
namespace {

constexpr const char* kFlag = "--options";

struct Given {
  std::string file;
  std::set<std::string> names;  // options that the file set, without dashes
};

Given& Last() {
  static Given given;
  return given;
}

// Returns the value of --options.
std::optional<std::string> FileNamedBy(const std::vector<std::string>& words) {
  const std::string with_value = std::string(kFlag) + '=';
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--") break;
    if (words[i].starts_with(with_value)) return words[i].substr(with_value.size());
    if (words[i] == kFlag && i + 1 < words.size()) return words[i + 1];
  }
  return std::nullopt;
}

bool IsGiven(const CLI::Option& option, const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    if (word.starts_with("--")) return option.check_lname(word.substr(2, word.find('=') - 2));
    return word.size() > 1 && word[0] == '-' && option.check_sname(word.substr(1, 1));
  });
}

std::vector<CLI::ConfigItem> ReadItems(const std::string& file) {
  constexpr std::size_t kMaxBytes = 1 << 20;
  const std::string bytes = data_io::ReadFileBytes(file, kMaxBytes);
  std::istringstream stream{std::string(data_io::WithoutByteOrderMark(bytes))};
  try {
    return CLI::ConfigTOML().from_config(stream);
  } catch (const CLI::Error& error) {
    throw DataError("{}: {}, expected lines NAME = VALUE", file, error.what());
  }
}

const CLI::Option& FindOption(const CLI::App& command, const std::string& file, const CLI::ConfigItem& item) {
  if (!item.parents.empty() || item.name == "++")
    throw DataError("{}: has the section [{}], expected options only", file, fmt::join(item.parents, "."));
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->check_lname("help") || option->check_lname(kFlag + 2)) continue;
    for (const std::string& name : option->get_lnames()) {
      if (name == item.name) return *option;
      names.push_back(name);
    }
  }
  const std::optional<std::string> nearest = NearestWord(item.name, names);
  throw DataError("{}: unknown option '{}' of sonarcal {}{}", file, Printable(item.name), command.get_name(),
                  nearest ? fmt::format(", did you mean '{}'?", *nearest)
                          : std::string(", expected a name of its --help without dashes"));
}

// Converts an item to words of a command line.
std::vector<std::string> WordsOf(const std::string& file, const CLI::Option& option,
                                 const CLI::ConfigItem& item) {
  const std::string flag = "--" + item.name;
  if (option.get_items_expected_max() == 0) {
    if (item.inputs == std::vector<std::string>{"false"}) return {};
    if (item.inputs != std::vector<std::string>{"true"})
      throw DataError("{}: {} is '{}', expected true or false", file, item.name,
                      Printable(fmt::format("{}", fmt::join(item.inputs, ","))));
    return {flag};
  }
  if (fmt::format("{}", fmt::join(item.inputs, "")).empty())
    throw DataError("{}: {} has no value, expected NAME = VALUE", file, item.name);
  if (option.get_expected_max() < CLI::detail::expected_max_vector_size)
    return {fmt::format("{}={}", flag, fmt::join(item.inputs, ","))};
  std::vector<std::string> words;
  for (const std::string& input : item.inputs) words.push_back(fmt::format("{}={}", flag, input));
  return words;
}

}  // namespace

void AddOptionsFile(CLI::App& command) {
  command
      .add_option_function<std::string>(
          kFlag, [](const std::string&) {}, "File of options, NAME = VALUE; those of the command line win")
      ->type_name("FILE");
}

void AddOptionsFromFile(const CLI::App& root, std::vector<std::string>& words) {
  Last() = {};
  const auto name =
      std::ranges::find_if(words, [](const std::string& word) { return !word.starts_with('-'); });
  const std::optional<std::string> file = FileNamedBy(words);
  if (!file || name == words.end()) return;
  const std::vector<const CLI::App*> commands =
      root.get_subcommands([&](const CLI::App* command) { return command->get_name() == *name; });
  if (commands.empty()) return;  // an unknown command, which the parser refuses
  const CLI::App* command = commands.front();
  Last().file = *file;
  std::vector<std::string> added;
  for (const CLI::ConfigItem& item : ReadItems(*file)) {
    const CLI::Option& option = FindOption(*command, *file, item);
    if (IsGiven(option, words)) continue;
    const std::vector<std::string> of_item = WordsOf(*file, option, item);
    added.insert(added.end(), of_item.begin(), of_item.end());
    Last().names.insert(item.name);
  }
  words.insert(name + 1, added.begin(), added.end());
}

const std::string& OptionsFile() {
  return Last().file;
}

bool IsFromOptionsFile(const CLI::Option& option) {
  return std::ranges::any_of(option.get_lnames(),
                             [](const std::string& name) { return Last().names.contains(name); });
}

}  // namespace sonarcal::cli
