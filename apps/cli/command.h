// Common part of all commands of `sonarcal`. A command is an options struct, a `Setup...` that describes it
// to CLI11, and a `Run...` that does the work and can be called without a shell.
//
//   void SetupInspect(CLI::App& app) {
//     auto options = std::make_shared<InspectOptions>();
//     CLI::App* command = AddCommand(app, "inspect", "Says what a file holds");
//     command->add_option("FILE", options->files, "Recordings of any readable format")->required();
//     OnRun(command, options->common, [options] { return RunInspect(*options); });
//   }
//
// To add a command: write its file, declare its Setup in apps/commands/commands.h, name it in
// apps/commands/sonarcal.cc, and give it an example in apps/commands/examples.cc.
//
// Results go to stdout, everything else to stderr. A failure prints one sentence on stderr, "sonarcal: ...".
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace sonarcal::cli {

enum class ExitStatus {
  kDone = 0,
  kFailed = 1,         // bad data, or a failed run
  kUsage = 2,          // wrong command line
  kNoSolution = 3,     // a fit has no usable solution
  kThreshold = 4,      // a figure exceeded a threshold of --fail-above
  kInterrupted = 130,  // a command that stops by itself after a signal (apps/cli/interruption.h)
};

// Options of every command.
struct CommonOptions {
  bool json = false;   // prints results as JSON on stdout
  bool quiet = false;  // prints only errors on stderr
  bool force = false;  // for commands with --out DIR (apps/cli/run_output.h): writes into any folder
};

// Calls Setup functions. --help lists their commands under the heading `group`.
void AddCommands(CLI::App& app, const std::string& group, const std::vector<void (*)(CLI::App&)>& setups);

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description);

// Ends a command's Setup: adds the common options, also --verbose and --log (apps/cli/messages.h) and
// --options (apps/cli/options_file.h), groups all options, and sets the function that runs the command. Its
// exit status becomes that of the program. `common` belongs to the options struct that `run` holds.
void OnRun(CLI::App* command, CommonOptions& common, std::function<ExitStatus()> run);

// Prepares the root of the command line for Setup functions: version, licences, help layout, "one command is
// required". Every line of help has a unit and a default. The unit is in the type name or the description.
// The layout adds the default.
void SetUpRoot(CLI::App& app);

// Parses the command line and runs the selected command. Converts every failure to one sentence and an exit
// status. A signal such as SIGINT removes unfinished outputs (apps/cli/run_output.h) and ends the program. If
// the command can keep finished outputs, it is asked to stop (apps/cli/interruption.h).
int RunApp(CLI::App& app, int argc, const char* const* argv);

// Returns the words of the command line of RunApp, for provenance.
const std::vector<std::string>& CommandLine();

// Prints a message on stderr, unless --quiet. It goes to the log in any case.
void PrintNote(const CommonOptions& common, std::string_view sentence);

// Prints a failure that does not end the command, such as one bad file of several. Ignores --quiet.
void PrintError(std::string_view sentence);

// Print results on stdout.
void PrintResult(std::string_view text);
void PrintJson(const nlohmann::ordered_json& json);

}  // namespace sonarcal::cli
