// `sonarcal fit --noise-only`: the noise law of a sonar from target-free pings (calib/noise/noise_fit.h).
// Needs no scene, no parameters and no poses.
//
// Written: params.json (receiver and display groups; a material "default" that stands for nothing), fit.json
// (calib/fit_report.h, with `model_choice` and `agreement`), report.html.
#pragma once

#include "apps/fit_command.h"

namespace sonarcal {

ExitStatus RunFitNoise(const FitCommandOptions& options);

}  // namespace sonarcal
