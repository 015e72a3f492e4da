#include "apps/cli/documentation/man_pages.h"

#include <fmt/format.h>

#include <sstream>

#include <CLI/CLI.hpp>

#include "apps/cli/documentation/command_options.h"

namespace sonarcal::cli {
namespace {

// Escapes text for roff: hyphens stay hyphens, and no line begins like a request.
std::string Roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  if (escaped.starts_with('.') || escaped.starts_with('\'')) escaped.insert(0, "\\&");
  return escaped;
}

std::string Head(const std::string& name, const std::string& version, const std::string& description) {
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".TH {} 1 \"\" \"{}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n", Roff(upper),
                     Roff(version), Roff(name), Roff(description));
}

void AddOptions(const std::vector<DocumentedOption>& options, bool arguments, std::string& text) {
  for (const DocumentedOption& option : options) {
    if (option.is_argument != arguments) continue;
    std::string names;
    for (const std::string& name : option.names) {
      names += fmt::format("{}\\f{}{}\\fR", names.empty() ? "" : ", ", arguments ? 'I' : 'B', Roff(name));
    }
    if (!option.value.empty()) names += fmt::format(" \\fI{}\\fR", Roff(option.value));
    text += fmt::format(".TP\n{}\n{}\n", names, Roff(option.description));
  }
}

// The end of --help: its first line is a heading.
std::string Examples(const CLI::App& command) {
  std::istringstream footer(command.get_footer());
  std::string text;
  std::string line;
  std::getline(footer, line);
  while (std::getline(footer, line) && line.starts_with(' ')) text += Roff(line.substr(2)) + '\n';
  return text.empty() ? text : ".SH EXAMPLES\n.nf\n" + text + ".fi\n";
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n1\nBad data, or a run that failed.\n.TP\n2\nA wrong command "
    "line.\n.TP\n3\nA fit that ended without a usable solution.\n.TP\n4\nA figure exceeded a threshold of "
    "\\fB\\-\\-fail\\-above\\fR.\n.TP\n130, 143, 129\nInterrupted; unfinished outputs are removed.\n";

}  // namespace

std::string ProgramManPage(const CLI::App& root, const std::string& version) {
  std::string text = Head("sonarcal", version, "makes a simulated imaging sonar agree with a real one");
  text += ".SH SYNOPSIS\n.B sonarcal\n.I COMMAND\n[\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n";
  text += Roff(
      "Simulates the images of an imaging sonar in a scene, compares them with recorded images, and fits the "
      "physical parameters of the simulation until both agree as well as the data allow.");
  text += "\n.SH COMMANDS\n";
  for (const CLI::App* command : DocumentedCommands(root)) {
    text += fmt::format(".TP\n\\fBsonarcal\\-{}\\fR(1)\n{}\n", Roff(command->get_name()),
                        Roff(command->get_description()));
  }
  text += ".SH OPTIONS\n";
  AddOptions(DocumentedOptions(root), /*arguments=*/false, text);
  return text + Examples(root) + kExitStatus;
}

std::string CommandManPage(const CLI::App& command, const std::string& version) {
  const std::string& name = command.get_name();
  const std::vector<DocumentedOption> options = DocumentedOptions(command);
  std::string description = command.get_description();
  if (!description.empty()) description.front() = static_cast<char>(std::tolower(description.front()));
  std::string text = Head(fmt::format("sonarcal-{}", name), version, description);
  text += fmt::format(".SH SYNOPSIS\n.B sonarcal {}\n[\\fIOPTIONS\\fR]", Roff(name));
  std::string arguments;
  for (const DocumentedOption& option : options) {
    if (option.is_argument) arguments += fmt::format(" \\fI{}\\fR", Roff(option.names.front()));
  }
  text += arguments + "\n";
  if (!arguments.empty()) {
    text += ".SH ARGUMENTS\n";
    AddOptions(options, /*arguments=*/true, text);
  }
  text += ".SH OPTIONS\n";
  AddOptions(options, /*arguments=*/false, text);
  return text + Examples(command) + kExitStatus + ".SH SEE ALSO\n.BR sonarcal (1)\n";
}

}  // namespace sonarcal::cli
