// The frame every command of `sonarcal` hangs in: a command is an options struct, a `Setup...` that describes
// it to CLI11, and a `Run...` that does the work and can be called without a shell.
//
//   void SetupInspect(CLI::App& app) {
//     auto options = std::make_shared<InspectOptions>();
//     CLI::App* command = AddCommand(app, "inspect", "Says what a file holds");
//     command->add_option("FILE", options->files, "Recordings of any readable format")->required();
//     OnRun(command, options->common, [options] { return RunInspect(*options); });
//   }
//
// To add a command: write its file, declare its Setup in apps/commands/commands.h, call it in apps/commands/sonarcal.cc.
//
// Results go to stdout, everything else to stderr. A failure costs one sentence on stderr, "sonarcal: ...".
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
  kFailed = 1,         // bad data, or a run that failed
  kUsage = 2,          // wrong command line
  kNoSolution = 3,     // a fit ended without a usable solution
  kThreshold = 4,      // a threshold given with --fail-above was passed
  kInterrupted = 130,  // by SIGINT or SIGTERM, with what was finished in its place (apps/cli/interruption.h)
};

// What every command takes.
struct CommonOptions {
  bool json = false;   // results as JSON on stdout
  bool quiet = false;  // nothing on stderr but errors
  bool force = false;  // of commands with --out DIR (apps/cli/run_output.h): write whatever the folder holds
};

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description);

// Ends a command's Setup: adds the common options, and says what the command does once its line has been
// read. Its exit status becomes the program's. `common` belongs to the options struct that `run` holds.
void OnRun(CLI::App* command, CommonOptions& common, std::function<ExitStatus()> run);

// The root of the command line, ready for Setup functions: version, help layout, "one command is required".
// A unit and a default belong on every line of help: the unit in the type name or the description, the
// default is added by the layout.
void SetUpRoot(CLI::App& app);

// Parses, runs the chosen command, and turns every way of failing into one sentence and an exit status.
// SIGINT and SIGTERM end the program after unfinished outputs have been removed (apps/cli/run_output.h), or,
// where the command can keep what is finished, ask it to (apps/cli/interruption.h).
int RunApp(CLI::App& app, int argc, const char* const* argv);

// The words of the command line, as RunApp was given them. For provenance.
const std::vector<std::string>& CommandLine();

// One sentence for people on stderr, unless --quiet.
void PrintNote(const CommonOptions& common, std::string_view sentence);

// A failure that does not end the command, such as one bad file of several. Printed in spite of --quiet.
void PrintError(std::string_view sentence);

// Results on stdout.
void PrintResult(std::string_view text);
void PrintJson(const nlohmann::ordered_json& json);

}  // namespace sonarcal::cli
