// `sonarcal compare`: a simulated recording against a real one, every metric, frame by frame and together.
//
// Written: metrics.json and per_frame.csv (metrics/metrics_json.h), on request threshold_sweep.csv
// (metrics/threshold_sweep.h), report.html, and for each frame recorded,
// simulated, overlay and object regions as PNG, polar and fan (apps/comparison_pictures.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/comparison_options.h"

namespace sonarcal {

struct CompareCommandOptions {
  CommonOptions common;
  std::filesystem::path real;
  std::filesystem::path simulated;
  std::filesystem::path out;
  std::string frames;  // "A:B" of both, see apps/frame_range.h; empty for all
  ComparisonOptions comparison;
  int sweep_steps = 21;     // settings of the segmentation that are tried, 0: none
  std::string sweep_range;  // "A:B"; empty for the method's own
  bool sweep_csv = false;   // write threshold_sweep.csv too
  bool as_displayed = false;
  std::vector<std::string> fail_above;  // "intensity_error.polar=0.1", see apps/threshold_check.h
};

ExitStatus RunCompare(const CompareCommandOptions& options);

}  // namespace sonarcal
