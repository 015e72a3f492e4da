// `sonarcal fit --noise-only`: the noise law of a sonar from target-free pings (calib/noise/noise_fit.h).
// Needs no scene, no parameters and no poses.
//
// Written: params.json (receiver and display groups; a material "default" that stands for nothing), fit.json
// (calib/fit_report.h, with `model_choice` and `agreement`), report.html.
//
// `sonarcal fit --still` does it alone: no scene, no rays; parameters only for display, looks and the shape
// of the noise where they are not as plain as can be. Written: params.json (display and receiver; a material
// "default" that stands for nothing), fit.json (`receiver.noise_db`, and the member `still`), report.html.
#pragma once

#include "apps/commands/fit_command.h"

namespace sonarcal::commands {

cli::ExitStatus RunFitStill(const FitCommandOptions& options);

cli::ExitStatus RunFitNoise(const FitCommandOptions& options);

}  // namespace sonarcal::commands
