#include "apps/cli/command.h"

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/help_formatter.h"
#include "apps/cli/interruption.h"
#include "apps/cli/run_output.h"
#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::cli {
namespace {

// Replaces line breaks. A sentence may quote user input, and a line break in it would make two sentences.
std::string OneLine(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

int Fail(ExitStatus status, std::string_view sentence) {
  PrintError(sentence);
  return static_cast<int>(status);
}

// Reports an exception that leaves a thread. It cannot be caught, but the user gets one sentence.
[[noreturn]] void Terminate() {
  Fail(ExitStatus::kFailed, "internal error: an exception left its thread; please report this");
  RemoveUnfinishedOutputs();
  std::_Exit(static_cast<int>(ExitStatus::kFailed));
}

// The selected command: "sonarcal inspect", or "sonarcal" without one.
struct ChosenCommand {
  const CLI::App* app;
  std::string parent;  // words before its name on a command line

  std::string path() const { return parent.empty() ? app->get_name() : parent + ' ' + app->get_name(); }
};

ChosenCommand Chosen(const CLI::App& root) {
  ChosenCommand chosen{&root, ""};
  while (!chosen.app->get_subcommands().empty()) {
    chosen.parent = chosen.path();
    chosen.app = chosen.app->get_subcommands().front();
  }
  return chosen;
}

std::string UsageMistake(const CLI::App& root, const ChosenCommand& chosen, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = root.remaining();
  if (chosen.app != &root) return error.what();
  std::string commands;
  for (const CLI::App* command : root.get_subcommands({})) {
    if (command->get_group().empty()) continue;  // hidden
    commands += (commands.empty() ? "" : ", ") + command->get_name();
  }
  const std::string expected = commands.empty() ? "" : ", expected one of " + commands;
  if (unknown.empty()) return "no command given" + expected;
  const char* what = unknown.front().starts_with('-') ? "option" : "command";
  return fmt::format("unknown {} '{}'{}", what, Printable(unknown.front()), expected);
}

int ParseFailure(const CLI::App& root, const CLI::ParseError& error) {
  const ChosenCommand chosen = Chosen(root);
  if (dynamic_cast<const CLI::CallForHelp*>(&error) != nullptr) {
    std::cout << chosen.app->help(chosen.parent);
    return static_cast<int>(ExitStatus::kDone);
  }
  if (dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr) {
    std::cout << error.what() << '\n';
    return static_cast<int>(ExitStatus::kDone);
  }
  return Fail(ExitStatus::kUsage,
              fmt::format("{} (see '{} --help')", UsageMistake(root, chosen, error), chosen.path()));
}

int ParseAndRun(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return static_cast<int>(ExitStatus::kDone);
  } catch (const CLI::RuntimeError& error) {  // OnRun returns a status in this way
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return ParseFailure(app, error);
  } catch (const UsageError& error) {
    return Fail(ExitStatus::kUsage, error.what());
  } catch (const DataError& error) {
    return Fail(ExitStatus::kFailed, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    const std::filesystem::path& path = error.path2().empty() ? error.path1() : error.path2();
    return Fail(ExitStatus::kFailed, fmt::format("{}: {}", path.string(), error.code().message()));
  } catch (const std::bad_alloc&) {
    return Fail(ExitStatus::kFailed, "not enough memory for this run");
  } catch (const std::exception& error) {
    return Fail(ExitStatus::kFailed, fmt::format("internal error: {}; please report this", error.what()));
  } catch (...) {
    return Fail(ExitStatus::kFailed, "internal error: an unknown exception; please report this");
  }
}

std::vector<std::string>& MutableCommandLine() {
  static std::vector<std::string> words;
  return words;
}

}  // namespace

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description) {
  return app.add_subcommand(name, description)->group("Commands");
}

void OnRun(CLI::App* command, CommonOptions& common, std::function<ExitStatus()> run) {
  command->add_flag("--json", common.json, "Print the results as JSON");
  command->add_flag("-q,--quiet", common.quiet, "Print nothing but results and errors");
  command->final_callback([run = std::move(run)] {
    const ExitStatus status = run();
    if (status != ExitStatus::kDone) throw CLI::RuntimeError(static_cast<int>(status));
  });
}

void SetUpRoot(CLI::App& app) {
  app.name("sonarcal");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag("--version", "sonarcal " SONARCAL_VERSION, "Print the version");
  app.option_defaults()->always_capture_default();
  app.require_subcommand(1);
}

int RunApp(CLI::App& app, int argc, const char* const* argv) {
  HandleSignals();
  std::set_terminate(Terminate);
  MutableCommandLine().assign(argv, argv + argc);
  const int status = ParseAndRun(app, argc, argv);
  std::cout.flush();
  if (!std::cout && status == static_cast<int>(ExitStatus::kDone)) {
    return Fail(ExitStatus::kFailed, "cannot write the results to standard output: is the disk full?");
  }
  return status;
}

const std::vector<std::string>& CommandLine() {
  return MutableCommandLine();
}

void PrintNote(const CommonOptions& common, std::string_view sentence) {
  if (!common.quiet) std::cerr << "sonarcal: " << sentence << std::endl;
}

void PrintError(std::string_view sentence) {
  std::cout.flush();  // keeps the order of results and errors on a common terminal
  std::cerr << "sonarcal: " << OneLine(std::string(sentence)) << std::endl;
}

void PrintResult(std::string_view text) {
  std::cout << text;
}

void PrintJson(const nlohmann::ordered_json& json) {
  std::cout << data_io::JsonText(json);
}

}  // namespace sonarcal::cli
