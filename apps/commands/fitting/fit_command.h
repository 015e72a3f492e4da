// `sonarcal fit`: fits the parameters of an image model to a recording with poses.
//
// Writes params.json (fitted values), fit.json (calib/fit_report.h, with metrics_before and metrics_after,
// each in the form of metrics.json, and with --choose model_choice, apps/report/sections/choice_section.h),
// report.html. A fit without a usable solution writes only fit.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/workflow/fit.h"

namespace sonarcal::commands {

// --standard-target (apps/commands/fitting/fit_standard_target.h).
struct StandardTargetChoice {
  std::string shape;  // "sphere"; empty: no standard target
  std::optional<double> diameter_mm;
  std::optional<double> bandwidth_khz;  // absent: that of the pulse
  double temperature_sigma_c = 1.0;
  std::filesystem::path second;  // fit.json of another target; empty: none
};

struct FitCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path real;
  std::string sonar;  // in place of that of `real`; empty: as recorded
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::filesystem::path params;
  std::filesystem::path poses;  // empty: those of the recording
  std::filesystem::path out;
  workflow::FitOptions fit;
  // --noise-only (apps/commands/fitting/fit_noise.h): without scene and poses. Uses real, out, held_out, and
  // params for the display.
  bool noise_only = false;
  bool still = false;  // --still (apps/workflow/still_poses.h): without scene; uses real, out and params
  // Uses real, sonar, poses, out, the material of `fit`, and params for the display.
  StandardTargetChoice standard_target = {};
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
  double reject_beyond = 0.0;
  bool find_background = false;
  bool hold_out_bands = false;
};

// Returns the text of fit.json.
std::string FitJson(const workflow::RecordingFit& fit);

cli::ExitStatus RunFit(const FitCommandOptions& options);

}  // namespace sonarcal::commands
