#include "apps/commands/fitting/fit_ending.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/report/html/paper_files.h"

namespace sonarcal::commands {

cli::ExitStatus EndFit(const report::HtmlReport& report, const std::string& fit_json,
                       const std::string& summary, const cli::CommonOptions& common, cli::RunOutput& output) {
  report::WriteReport(report, output.staging());
  output.Commit();
  if (common.json) {
    cli::PrintJson(nlohmann::ordered_json::parse(fit_json));
  } else {
    cli::PrintResult(summary);
  }
  return cli::ExitStatus::kDone;
}

std::string NoSolutionText(const calib::FitReport& report) {
  return fmt::format("the fit ended without a usable solution ({})",
                     report.termination.empty() ? "the frames determine no parameter" : report.termination);
}

cli::ExitStatus EndFitWithoutSolution(const std::string& sentence, const std::filesystem::path& out,
                                      cli::RunOutput& output) {
  output.Commit();
  cli::PrintError(
      fmt::format("{}; no parameters were written, see {}", sentence, (out / "fit.json").string()));
  return cli::ExitStatus::kNoSolution;
}

}  // namespace sonarcal::commands
