#include "apps/cli/command.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/documentation/command_options.h"
#include "apps/cli/documentation/licences.h"
#include "apps/cli/help_formatter.h"
#include "apps/cli/interruption.h"
#include "apps/cli/messages.h"
#include "apps/cli/option_groups.h"
#include "apps/cli/options_file.h"
#include "apps/cli/run_output.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::cli {
namespace {

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

std::vector<std::string> CommandNames(const CLI::App& root) {
  std::vector<std::string> names;
  for (const CLI::App* command : DocumentedCommands(root)) names.push_back(command->get_name());
  return names;
}

std::string UnknownCommand(const CLI::App& root, const std::string& found) {
  return fmt::format("unknown command '{}'{}", Printable(found), ExpectedWord(found, CommandNames(root)));
}

// `found`: "--rays" or "--rays=300x200".
std::string UnknownOption(const CLI::App& command, const std::string& found) {
  const std::string name = found.substr(0, found.find('='));
  std::vector<std::string> names;
  for (const DocumentedOption& option : DocumentedOptions(command)) {
    if (!option.is_argument) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  const std::optional<std::string> nearest = NearestWord(name, names);
  return fmt::format("unknown option '{}'{}", Printable(name),
                     nearest ? fmt::format(", did you mean '{}'?", *nearest) : std::string());
}

std::string UsageMistake(const CLI::App& root, const ChosenCommand& chosen, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = chosen.app->remaining();
  // A misspelt option comes before the required option that is missing because of it.
  for (const std::string& word : unknown) {
    if (word.size() > 1 && word.starts_with('-')) return UnknownOption(*chosen.app, word);
  }
  if (chosen.app != &root) return error.what();
  if (!unknown.empty()) return UnknownCommand(root, unknown.front());
  return "no command given" + ExpectedWord("", CommandNames(root));
}

int ParseFailure(const CLI::App& root, const CLI::ParseError& error) {
  const ChosenCommand chosen = Chosen(root);
  if (dynamic_cast<const CLI::CallForHelp*>(&error) != nullptr) {
    if (chosen.app == &root && !root.remaining().empty())  // "sonarcal help fti"
      return Fail(ExitStatus::kUsage, UnknownCommand(root, root.remaining().front()));
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

// Refuses an empty argument and `--name=`. A shell variable that is not set leaves them.
void CheckWords(const std::vector<std::string>& words) {
  std::string before = "sonarcal";
  for (const std::string& word : words) {
    if (word.empty())
      throw UsageError("the argument after '{}' is empty, expected a value", Printable(before));
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      throw UsageError("{} has no value, expected one behind it", word.substr(0, word.size() - 1));
    before = word;
  }
}

int ParseAndRun(CLI::App& app, std::vector<std::string> words) {
  try {
    if (!words.empty() && words.front() == "help") {  // "sonarcal help fit" is "sonarcal fit --help"
      words.erase(words.begin());
      words.emplace_back("--help");
    }
    CheckWords(words);
    AddOptionsFromFile(app, words);
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(std::move(words));
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

// Options of OnRun beside those of CommonOptions.
struct MessageOptions {
  bool verbose = false;
  std::filesystem::path log;
};

// Throws UsageError for a file that no run wrote as a log, for a pipe that nobody reads, and for a log in the
// output folder, which must be empty before a run.
void CheckLog(const CLI::App& command, const std::filesystem::path& log) {
  if (log.empty()) return;
  std::error_code error;
  if (std::filesystem::is_fifo(log, error)) {
    const int descriptor = open(log.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0)
      throw UsageError("--log {} is a pipe that nobody reads, expected a file", log.string());
    close(descriptor);
  }
  if (std::filesystem::is_regular_file(log, error) && !IsLog(log))
    throw UsageError("--log {} is a file without messages, expected a new file or a log", log.string());
  const CLI::Option* out = command.get_option_no_throw("--out");
  if (out == nullptr || out->count() == 0) return;
  const auto whole = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal();
  };
  const std::string relative = whole(log).lexically_relative(whole(out->as<std::string>())).string();
  if (!relative.starts_with(".."))
    throw UsageError("--log {} is inside --out, expected a file outside the folder of the outputs",
                     log.string());
}

// An option without its value takes the next word for it, also if that is an option.
void CheckValues(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& value : option->results()) {
      if (value.size() > 1 && value.starts_with('-') && command.get_option_no_throw(value) != nullptr)
        throw UsageError("{} has the value '{}', which is an option, expected a value", option->get_name(),
                         value);
    }
  }
}

void StartRun(const CLI::App& command, const CommonOptions& common, const MessageOptions& options) {
  CheckValues(command);
  if (options.verbose && common.quiet) throw UsageError("--verbose has no effect with --quiet");
  CheckLog(command, options.log);
  StartMessages({.verbose = options.verbose, .log = options.log});
  std::error_code error;  // the working directory may be deleted
  PrintDetail(fmt::format("version {}, in {}: {}", SONARCAL_VERSION,
                          std::filesystem::current_path(error).string(), fmt::join(CommandLine(), " ")));
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    PrintDetail(fmt::format("{} = {} ({})", option->get_name(), fmt::join(option->results(), " "),
                            IsFromOptionsFile(*option) ? "options file" : "command line"));
  }
}

// Takes the place of standard streams that are closed, so that no output file gets their number. Writing to
// them fails, as to closed ones.
void ReplaceClosedStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    [[maybe_unused]] const int replaced = open("/dev/null", O_RDONLY);
  }
}

void EndRun(int status, std::chrono::steady_clock::time_point start) {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
  PrintDetail(fmt::format("ended with status {} after {:.1f} s, peak memory {} MB", status, duration.count(),
                          usage.ru_maxrss / 1024));
}

}  // namespace

void AddCommands(CLI::App& app, const std::string& group, const std::vector<void (*)(CLI::App&)>& setups) {
  const std::size_t earlier = app.get_subcommands({}).size();
  for (const auto setup : setups) setup(app);
  const std::vector<CLI::App*> commands = app.get_subcommands({});
  for (std::size_t i = earlier; i < commands.size(); ++i) {
    if (!commands[i]->get_group().empty()) commands[i]->group(group);
  }
}

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description) {
  return app.add_subcommand(name, description)->group("Commands");
}

void OnRun(CLI::App* command, CommonOptions& common, std::function<ExitStatus()> run) {
  command->add_flag("--json", common.json, "Print the results as JSON");
  command->add_flag("-q,--quiet", common.quiet, "Print nothing but results and errors");
  const auto messages = std::make_shared<MessageOptions>();
  command->add_flag("-v,--verbose", messages->verbose,
                    "Print also options, files that are read and written, and times");
  command->add_option("--log", messages->log, "Append all messages, with times, to this file")
      ->type_name("FILE");
  AddOptionsFile(*command);
  GroupOptions(*command);
  command->final_callback([command, &common, messages, run = std::move(run)] {
    StartRun(*command, common, *messages);
    const ExitStatus status = run();
    if (status != ExitStatus::kDone) throw CLI::RuntimeError(static_cast<int>(status));
  });
}

void SetUpRoot(CLI::App& app) {
  app.name("sonarcal");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Print this help");
  const CLI::Option* licences = app.add_flag_callback(
      "--licenses", [] { throw CLI::CallForVersion(LicenceText(), 0); },
      "Print the version, the licence, and the licences of the libraries");
  const auto version = [licences] {
    return licences->count() > 0 ? LicenceText() : "sonarcal " SONARCAL_VERSION;
  };
  app.set_version_flag("--version", version, "Print the version");
  app.option_defaults()->always_capture_default();
  app.require_subcommand(1);
}

int RunApp(CLI::App& app, int argc, const char* const* argv) {
  ReplaceClosedStreams();
  HandleSignals();
  std::set_terminate(Terminate);
  MutableCommandLine().assign(argv, argv + argc);
  const auto start = std::chrono::steady_clock::now();
  const int status = ParseAndRun(app, {argv + std::min(argc, 1), argv + argc});
  CommandHasEnded();
  std::cout.flush();
  EndRun(status, start);
  if (!std::cout && status == static_cast<int>(ExitStatus::kDone)) {
    return Fail(ExitStatus::kFailed, "cannot write the results to standard output: is the disk full?");
  }
  return status;
}

const std::vector<std::string>& CommandLine() {
  return MutableCommandLine();
}

void PrintNote(const CommonOptions& common, std::string_view sentence) {
  if (common.quiet) return LogLine(sentence);
  PrintMessage(MessageKind::kNote, sentence);
}

void PrintError(std::string_view sentence) {
  PrintMessage(MessageKind::kError, sentence);
}

void PrintResult(std::string_view text) {
  std::cout << text;
}

void PrintJson(const nlohmann::ordered_json& json) {
  std::cout << data_io::JsonText(json);
}

}  // namespace sonarcal::cli
