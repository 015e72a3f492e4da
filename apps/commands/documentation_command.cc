// `sonarcal documentation --out DIR`, hidden from --help: writes manual pages and shell completion for the
// build and for packages, and the tables and the schema of docs/reference that describe params.json.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/cli/documentation/command_options.h"
#include "apps/cli/documentation/completion.h"
#include "apps/cli/documentation/man_pages.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameter_reference.h"

namespace sonarcal::commands {
namespace {

struct DocumentationOptions {
  cli::CommonOptions common;
  std::filesystem::path out;
};

cli::ExitStatus RunDocumentation(const DocumentationOptions& options, const CLI::App& root) {
  const std::string version = "sonarcal " SONARCAL_VERSION;
  cli::RunOutput output = cli::RunOutput::Beside(options.out);
  std::vector<std::string> files;
  const auto write = [&](const std::string& name, const std::string& text) {
    data_io::WriteFileWhole(output / name, text);
    files.push_back(name);
  };
  write("sonarcal.1", cli::ProgramManPage(root, version));
  for (const CLI::App* command : cli::DocumentedCommands(root)) {
    write(fmt::format("sonarcal-{}.1", command->get_name()), cli::CommandManPage(*command, version));
  }
  write("sonarcal.bash", cli::BashCompletion(root));
  write("_sonarcal", cli::ZshCompletion(root));
  write("sonarcal.fish", cli::FishCompletion(root));
  write("parameters.md",
        data_io::ParametersTables() + "\n## Default bounds\n\n" + data_io::AcousticFitLimitsTable());
  write("params.schema.json", data_io::JsonText(data_io::ParametersSchema()));
  output.Commit();
  if (options.common.json) {
    cli::PrintJson({{"files", files}});
  } else {
    cli::PrintResult(fmt::format("{}: {} files\n", options.out.string(), files.size()));
  }
  return cli::ExitStatus::kDone;
}

}  // namespace

void SetupDocs(CLI::App& app) {
  auto options = std::make_shared<DocumentationOptions>();
  CLI::App* command = cli::AddCommand(app, "documentation", "Writes manual pages and shell completion");
  command->group("");  // hidden; only for building packages
  command->add_option("--out", options->out, "Folder to write them into")->type_name("DIR")->required();
  cli::OnRun(command, options->common, [options, &app] { return RunDocumentation(*options, app); });
}

}  // namespace sonarcal::commands
