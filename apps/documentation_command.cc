// `sonarcal documentation --out DIR`, hidden from --help: manual pages and shell completion, which the build
// and packages take from here.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/documentation/command_options.h"
#include "apps/documentation/completion.h"
#include "apps/documentation/man_pages.h"
#include "apps/run_output.h"

namespace sonarcal {
namespace {

struct DocumentationOptions {
  CommonOptions common;
  std::filesystem::path out;
};

ExitStatus RunDocumentation(const DocumentationOptions& options, const CLI::App& root) {
  const std::string version = "sonarcal " SONARCAL_VERSION;
  RunOutput output = RunOutput::Beside(options.out);
  std::vector<std::string> files;
  const auto write = [&](const std::string& name, const std::string& text) {
    WriteFileWhole(output / name, text);
    files.push_back(name);
  };
  write("sonarcal.1", ProgramManPage(root, version));
  for (const CLI::App* command : DocumentedCommands(root)) {
    write(fmt::format("sonarcal-{}.1", command->get_name()), CommandManPage(*command, version));
  }
  write("sonarcal.bash", BashCompletion(root));
  write("_sonarcal", ZshCompletion(root));
  write("sonarcal.fish", FishCompletion(root));
  output.Commit();
  if (options.common.json) {
    PrintJson({{"files", files}});
  } else {
    PrintResult(fmt::format("{}: {} files\n", options.out.string(), files.size()));
  }
  return ExitStatus::kDone;
}

}  // namespace

void SetupDocs(CLI::App& app) {
  auto options = std::make_shared<DocumentationOptions>();
  CLI::App* command = AddCommand(app, "documentation", "Writes manual pages and shell completion");
  command->group("");  // for those who build packages
  command->add_option("--out", options->out, "Folder to write them into")->type_name("DIR")->required();
  OnRun(command, options->common, [options, &app] { return RunDocumentation(*options, app); });
}

}  // namespace sonarcal
