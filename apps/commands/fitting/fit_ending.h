// End of the commands that fit.
#pragma once

#include <filesystem>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/run_output.h"
#include "apps/report/html/html_report.h"
#include "calib/fit_report.h"

namespace sonarcal::commands {

// Writes the report, completes the output, and prints `fit_json` with --json, else `summary`.
cli::ExitStatus EndFit(const report::HtmlReport& report, const std::string& fit_json,
                       const std::string& summary, const cli::CommonOptions& common, cli::RunOutput& output);

// Says that a fit of a scene has no usable solution, and why.
std::string NoSolutionText(const calib::FitReport& report);

// Completes an output without parameters, and prints `sentence`, which says why, with the place of fit.json.
cli::ExitStatus EndFitWithoutSolution(const std::string& sentence, const std::filesystem::path& out,
                                      cli::RunOutput& output);

}  // namespace sonarcal::commands
