#include "apps/cli/help_formatter.h"

#include <sstream>

#include <CLI/CLI.hpp>

#include "apps/cli/option_groups.h"

namespace sonarcal::cli {
namespace {

constexpr std::size_t kColumnWidth = 30;
constexpr std::size_t kHelpWidth = 100;

// Appends `text` from column kColumnWidth on, with line breaks between words.
void AppendWrapped(std::string& out, const std::string& text, std::size_t column) {
  if (column + 1 >= kColumnWidth) {
    out += '\n';
    column = 0;
  }
  out.append(kColumnWidth - column, ' ');
  column = kColumnWidth;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (column + word.size() > kHelpWidth) {
      out.back() = '\n';
      out.append(kColumnWidth, ' ');
      column = kColumnWidth;
    }
    out += word + ' ';
    column += word.size() + 1;
  }
  out.back() = '\n';
}

}  // namespace

HelpFormatter::HelpFormatter() {
  column_width(kColumnWidth);
  label("Positionals", "Arguments");
  label("SUBCOMMAND", "COMMAND");
}

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool is_positional) const {
  if (is_positional) return option->get_name(true, false);
  std::string names;
  for (const std::string& name : option->get_snames()) names += "-" + name + ", ";
  for (const std::string& name : option->get_lnames()) names += "--" + name + ", ";
  return names.substr(0, names.size() - 2);
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  std::string line = "  " + make_option_name(option, is_positional);
  const bool takes_value = option->get_type_size() != 0;
  if (takes_value && !is_positional && !option->get_type_name().empty())
    line += " " + option->get_type_name();
  if (option->get_expected_max() >= CLI::detail::expected_max_vector_size) line += "...";

  std::string description = option->get_description();
  if (option->get_required() && !is_positional) {
    description += " (required)";
  } else if (const std::string value = option->get_default_str(); takes_value && !value.empty()) {
    if (value != "[]") description += " (default: " + value + ")";  // an empty list is no default
  }
  const std::size_t column = line.size();
  AppendWrapped(line, description, column);
  return line;
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
  for (const std::string& group : OptionGroups()) {
    const std::vector<const CLI::Option*> options = app->get_options(
        [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
    if (!options.empty()) text += make_group(group, /*is_positional=*/false, options);
  }
  return text + make_subcommands(app, mode) + '\n' + make_footer(app);
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const {
  return '\n' + CLI::Formatter::make_usage(app, std::move(name));
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return app->get_description() + '\n';
}

}  // namespace sonarcal::cli
