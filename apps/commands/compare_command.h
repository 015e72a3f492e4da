// `sonarcal compare`: a simulated recording against a real one, every metric, frame by frame and together.
//
// Written: metrics.json and per_frame.csv (metrics/json/metrics_json.h), residuals.csv
// (metrics/measures/residuals.h), on request threshold_sweep.csv (metrics/threshold_sweep.h), report.html,
// and for up to `pictures` frames recorded, simulated, overlay and object regions as PNG, polar and fan
// (apps/report/pictures/comparison_pictures.h).
//
// Frames are read, compared and dropped one by one: of a frame its figures are kept, some kilobytes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/workflow/compare.h"

namespace sonarcal::commands {

struct CompareCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path real;
  std::filesystem::path simulated;
  std::filesystem::path out;
  std::string frames;  // "A:B,..." of both, see data_io/recordings/frame_range.h; empty for all
  workflow::CompareOptions compare;
  bool sweep_csv = false;       // write threshold_sweep.csv too
  int pictures = 100;           // frames that get pictures, evenly spread
  std::filesystem::path scene;  // for residuals by incidence and material, and for --object; empty: none
  cli::SceneFormat scene_format;
  std::vector<std::string> fail_above;  // "intensity_error.polar=0.1", see metrics/json/threshold_check.h
};

cli::ExitStatus RunCompare(const CompareCommandOptions& options);

}  // namespace sonarcal::commands
