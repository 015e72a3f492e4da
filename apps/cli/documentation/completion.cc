#include "apps/cli/documentation/completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "apps/cli/documentation/command_options.h"

namespace sonarcal::cli {
namespace {

// Quotes text with single quotes of a shell.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

std::string Joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

// Description without its default, and without characters that end it in zsh.
std::string Short(const DocumentedOption& option) {
  std::string text;
  for (const char c : option.description.substr(0, option.description.find(" ("))) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') {
      text += '\\';
    }
    text += c;
  }
  return text;
}

}  // namespace

std::string BashCompletion(const CLI::App& root) {
  std::vector<std::string> names;
  std::string cases;
  for (const CLI::App* command : DocumentedCommands(root)) {
    names.push_back(command->get_name());
    std::vector<std::string> options;
    std::string values;
    std::vector<std::string> with_files;
    for (const DocumentedOption& option : DocumentedOptions(*command)) {
      if (option.is_argument) continue;
      options.insert(options.end(), option.names.begin(), option.names.end());
      if (!option.words.empty()) {
        values += fmt::format("        {}) words={} ;;\n", fmt::join(option.names, "|"),
                              Quoted(Joined(option.words)));
      } else if (!option.value.empty()) {
        with_files.push_back(fmt::format("{}", fmt::join(option.names, "|")));
      }
    }
    if (!with_files.empty()) values += fmt::format("        {}) files=yes ;;\n", fmt::join(with_files, "|"));
    cases += fmt::format("    {})\n      options={}\n      case \"$previous\" in\n{}      esac\n      ;;\n",
                         command->get_name(), Quoted(Joined(options)), values);
  }
  std::vector<std::string> of_program;
  for (const DocumentedOption& option : DocumentedOptions(root))
    of_program.insert(of_program.end(), option.names.begin(), option.names.end());
  return fmt::format(R"(# bash completion for sonarcal, written by the program itself
_sonarcal() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD-1]}}"
  local command="" options="" words="" files=no i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ "${{COMP_WORDS[i]}}" != -* ]]; then
      command="${{COMP_WORDS[i]}}"
      break
    fi
  done
  case "$command" in
    "")
      mapfile -t COMPREPLY < <(compgen -W {} -- "$word")
      return
      ;;
{}    *) return ;;
  esac
  if [[ -n "$words" ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  elif [[ "$files" == no && "$word" == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames 2>/dev/null
  fi
}}
complete -F _sonarcal sonarcal
)",
                     Quoted(Joined(names) + " " + Joined(of_program)), cases);
}

std::string ZshCompletion(const CLI::App& root) {
  std::string commands;
  std::string cases;
  for (const CLI::App* command : DocumentedCommands(root)) {
    commands += fmt::format("    {}\n",
                            Quoted(fmt::format("{}:{}", command->get_name(), command->get_description())));
    cases += fmt::format("    {})\n      _arguments", command->get_name());
    for (const DocumentedOption& option : DocumentedOptions(*command)) {
      if (option.is_argument) continue;
      for (const std::string& name : option.names) {
        std::string action;
        if (!option.words.empty()) {
          action = fmt::format(":value:({})", Joined(option.words));
        } else if (!option.value.empty()) {
          action = ":value:_files";
        }
        cases += fmt::format(" \\\n        {}", Quoted(fmt::format("{}[{}]{}", name, Short(option), action)));
      }
    }
    cases += " \\\n        '*:file:_files'\n      ;;\n";
  }
  return fmt::format(R"(#compdef sonarcal
# zsh completion for sonarcal, written by the program itself
_sonarcal() {{
  local -a commands
  commands=(
{}  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command="${{words[2]}}"
  shift words
  ((CURRENT--))
  case "$command" in
{}  esac
}}
_sonarcal "$@"
)",
                     commands, cases);
}

std::string FishCompletion(const CLI::App& root) {
  std::string text = "# fish completion for sonarcal, written by the program itself\n";
  for (const CLI::App* command : DocumentedCommands(root)) {
    text += fmt::format("complete -c sonarcal -n __fish_use_subcommand -f -a {} -d {}\n", command->get_name(),
                        Quoted(command->get_description()));
    for (const DocumentedOption& option : DocumentedOptions(*command)) {
      if (option.is_argument) continue;
      text += fmt::format("complete -c sonarcal -n '__fish_seen_subcommand_from {}'", command->get_name());
      for (const std::string& name : option.names) {
        text += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2))
                                       : fmt::format(" -s {}", name.substr(1));
      }
      if (!option.words.empty()) {
        text += fmt::format(" -x -a {}", Quoted(Joined(option.words)));
      } else if (!option.value.empty()) {
        text += " -r";
      }
      text += fmt::format(" -d {}\n", Quoted(option.description));
    }
  }
  return text;
}

}  // namespace sonarcal::cli
