// `sonarcal fit --noise-only`: fits the noise law of a sonar to target-free pings (calib/noise/noise_fit.h).
// Needs no scene, no parameters and no poses.
//
// Writes params.json (receiver and display groups; a placeholder material "default"), fit.json
// (calib/fit_report.h, with `model_choice` and `agreement`), report.html.
//
// `sonarcal fit --still`: measures the noise level on repeated poses (calib/noise/still_frames.h). Needs no
// scene and casts no rays. Parameters are optional; they give display, looks and the shape of the noise.
// Writes params.json (display and receiver; a placeholder material "default"), fit.json (`receiver.noise_db`,
// and the member `still`), report.html.
#pragma once

#include "apps/commands/fitting/fit_command.h"

namespace sonarcal::commands {

cli::ExitStatus RunFitStill(const FitCommandOptions& options);

cli::ExitStatus RunFitNoise(const FitCommandOptions& options);

}  // namespace sonarcal::commands
