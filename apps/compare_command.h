// `sonarcal compare`: a simulated recording against a real one, every metric, frame by frame and together.
//
// Written: metrics.json and per_frame.csv (metrics/json/metrics_json.h), residuals.csv
// (metrics/measures/residuals.h), on request threshold_sweep.csv (metrics/threshold_sweep.h), report.html,
// and for up to `pictures` frames recorded, simulated, overlay and object regions as PNG, polar and fan
// (apps/comparison_pictures.h).
//
// Frames are read, compared and dropped one by one: of a frame its figures are kept, some kilobytes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/compare_recordings.h"
#include "apps/comparison_options.h"
#include "apps/scene_option.h"

namespace sonarcal {

struct CompareCommandOptions {
  CommonOptions common;
  std::filesystem::path real;
  std::filesystem::path simulated;
  std::filesystem::path out;
  std::string frames;  // "A:B,..." of both, see apps/frame_range.h; empty for all
  ComparisonOptions comparison;
  int sweep_steps = 21;     // settings of the segmentation that are tried, 0: none
  std::string sweep_range;  // "A:B"; empty for the method's own
  bool sweep_csv = false;   // write threshold_sweep.csv too
  bool as_displayed = false;
  int pictures = 100;             // frames that get pictures, evenly spread
  std::filesystem::path against;  // metrics.json of an earlier run; empty: none
  std::filesystem::path scene;    // for residuals by incidence and material, and for --object; empty: none
  SceneFormat scene_format;
  std::filesystem::path params;         // for a floor drawn from its speckle; empty: none
  std::vector<std::string> fail_above;  // "intensity_error.polar=0.1", see apps/threshold_check.h
};

// A comparison and how it was made.
struct Comparison {
  CompareRecordingsOptions options;
  std::vector<int> frames;
  MetricsReport metrics;
};

// Everything that `compare` measures, and nothing written but pictures: of up to options.pictures frames,
// into `pictures`. Reads the files that the options name but neither recording. Throws as CompareRecordings.
Comparison MeasureComparison(const CompareCommandOptions& options, const RecordingSource& real,
                             const RecordingSource& simulated, const std::filesystem::path& pictures,
                             const std::function<void(int frames_done, int frames_in_all)>& progress = {});

// What the command line may say of the options.
void AddCompareOptions(CLI::App* command, CompareCommandOptions* options);

ExitStatus RunCompare(const CompareCommandOptions& options);

}  // namespace sonarcal
