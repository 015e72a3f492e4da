// `sonarcal fit --standard-target sphere`: calibrates a sonar with a sphere of known material
// (calib/standard_target/standard_target_fit.h). Needs no scene and no poses; poses give the elevation.
//
// Writes params.json (start parameters of a fit with the absolute level, responses and sensitivities; a
// placeholder material "default"), fit.json (calib/fit_report.h, with the member `standard_target`),
// report.html.
#pragma once

#include "apps/commands/fitting/fit_command.h"

namespace sonarcal::commands {

cli::ExitStatus RunFitStandardTarget(const FitCommandOptions& options);

}  // namespace sonarcal::commands
