// `sonarcal compare`: compares a simulated recording with a real one by all metrics, per frame and
// aggregated.
//
// Writes metrics.json and per_frame.csv (metrics/json/metrics_json.h), residuals.csv
// (metrics/measures/residuals.h), on request threshold_sweep.csv (metrics/threshold_sweep.h), report.html,
// and for up to `pictures` frames recorded, simulated, overlay and object regions as PNG, polar and fan
// (apps/report/pictures/comparison_pictures.h).
//
// Frames are read, compared and released one by one. Only the figures of a frame stay in memory, some
// kilobytes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/workflow/compare.h"
#include "core/types/frame_list.h"

namespace sonarcal::commands {

struct CompareCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path real;
  std::string sonar;                // in place of that of `real`; empty: as recorded
  std::filesystem::path simulated;  // empty: with `merge`
  std::filesystem::path out;
  FrameList frames;  // of both recordings; empty: all
  workflow::CompareOptions compare;
  bool sweep_csv = false;       // also writes threshold_sweep.csv
  int pictures = 100;           // max number of frames with pictures, evenly spread
  std::filesystem::path scene;  // for residuals by incidence and material, and for --object; empty: none
  cli::SceneFormat scene_format;
  bool part = false;                         // of a comparison: writes part.bin, and measures no floor
  std::vector<std::filesystem::path> merge;  // folders of parts; in place of `simulated`
  std::vector<std::string> fail_above;  // "intensity_error.polar=0.1", see metrics/json/threshold_check.h
};

cli::ExitStatus RunCompare(const CompareCommandOptions& options);

}  // namespace sonarcal::commands
