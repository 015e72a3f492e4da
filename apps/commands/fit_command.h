// `sonarcal fit`: parameters of the paper model, fitted to a recording with poses.
//
// Written: params.json (as fitted), fit.json (calib/fit_report.h, with metrics_before and metrics_after, each
// in the form of metrics.json, and with --choose model_choice, apps/report/sections/choice_section.h), report.html. A
// fit without a usable solution writes fit.json alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/workflow/fit.h"

namespace sonarcal::commands {

struct FitCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path real;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::filesystem::path params;
  std::filesystem::path out;
  workflow::FitOptions fit;
  // --noise-only (apps/commands/fit_noise.h): no scene, no poses; of the others real, out, held_out and, for its
  // display, params are used.
  bool noise_only = false;
  bool still = false;  // --still (apps/workflow/still_poses.h): no scene; real, out and params are used
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
  double reject_beyond = 0.0;
  bool find_background = false;
  bool hold_out_bands = false;
};

// The text of fit.json.
std::string FitJson(const workflow::RecordingFit& fit);

cli::ExitStatus RunFit(const FitCommandOptions& options);

}  // namespace sonarcal::commands
