// `sonarcal fit`: parameters of the paper model, fitted to a recording with poses.
//
// Written: params.json (as fitted), fit.json (calib/fit_report.h, with metrics_before and metrics_after, each
// in the form of metrics.json, and with --choose model_choice, apps/report/choice_section.h), report.html. A
// fit without a usable solution writes fit.json alone.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/comparison_options.h"
#include "apps/fit_recording.h"
#include "apps/ray_options.h"
#include "apps/scene_option.h"

namespace sonarcal {

struct FitCommandOptions {
  CommonOptions common;
  std::filesystem::path real;
  std::filesystem::path scene;
  SceneFormat scene_format;
  std::filesystem::path params;
  std::filesystem::path out;
  std::filesystem::path config;  // empty for none
  // Where not empty, each wins over the configuration's.
  std::vector<std::string> free;
  std::vector<std::string> fixed;
  std::vector<int> held_out;
  RayOptions rays;
  int max_iterations = 100;
  int starts = 4;
  std::vector<std::string>
      choose;              // axes of calib/selection/model_choice.h, by the likelihood of the held-out frames
  bool trust_all = false;  // count pixels in full that the scene does not explain
  // --noise-only (apps/fit_noise.h): no scene, no poses; of the others real, out, held_out and, for its
  // display, params are used.
  bool noise_only = false;
  bool still = false;  // --still (apps/still_poses.h): no scene; real, out and params are used
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
  double reject_beyond = 0.0;
  bool find_background = false;
  bool hold_out_bands = false;
  ComparisonOptions comparison;
};

// Who is told how far a fit is; each may be empty.
struct FitListener {
  std::function<void(const std::string& sentence)> say;  // what is being done, and what should not be missed
  std::function<void(int frames_done, int frames_in_all)> on_trace;
  std::function<bool()> stop;  // asked after each step of a solver; ends the fit by FitStopped
};

// What is free, by the options, their file and the model of the parameters to start from.
FitConfig ResolveFitConfig(const FitCommandOptions& options, const ParameterSet& initial, const Scene& scene);

// The fit that the options ask for, but for --noise-only and --still; no file is read or written. Throws as
// FitRecording.
RecordingFit FitAsAsked(const FitCommandOptions& options, const RecordingSource& recording,
                        const Scene& scene, const FitConfig& config, const ParameterSet& initial,
                        const FitListener& listener);

// The text of fit.json.
std::string FitJson(const RecordingFit& fit);

// What the command line may say of the options.
void AddFitOptions(CLI::App* command, FitCommandOptions* options);

ExitStatus RunFit(const FitCommandOptions& options);

}  // namespace sonarcal
