// metrics.json and per_frame.csv. Other programs rely on the names: fields are added, never renamed.
//
//   {"format": "sonar-metrics/1", "real", "simulated",
//    "frames": [{"index", "name", "time_s", "ns", "nr", "na", FIGURES,
//                "intensity_error": {"polar", "fan"}, "threshold": {"real", "simulated"},
//                "object_region": {"range_bins": [begin, end], "beams": [begin, end]},
//                "fan": {"ns", "nr", "na", FIGURES}, "notes": [...]}],
//    "macro": {SUMMARY, "frames_left_out": {"na_over_ns": 2}},
//    "micro": {"ns", "nr", "na", SUMMARY},
//    "ci": {"level", "method", "draws", "seed", "block_frames", "absent_because"},
//    "segmentation": {"method", "parameters": {...}, "applied_to", "region_of_interest_px",
//                     "region_margin_m", "simulated_object", "echo_fraction",
//                     "object_region": {"source": "model", "object", "margin_bins", "margin_beams"}},
//    "threshold_sweep": see metrics/json/sweep_json.h; null without a sweep,
//    "display": {"full_scale", "span_db"},
//    "intensity_error_definition": text,
//    "noise_floor": {"beside_figures", "speckle": {...}, "real_against_real": {...}, "drawn": {...}},
//    "residuals": {"frames", "frames_left_out", "by_range": CLASSES, "by_beam": CLASSES,
//                  "by_incidence": CLASSES, "by_material": CLASSES,
//                  "map": {"rows", "cols", "bins", "beams", "whole": SUMS, "union": SUMS}},
//    "against": {"better", "worse", "same", "not_told", "all_figures": {the same}, "earlier",
//                "common_frames", "method", "figures": [...], "notes": [...]},
//    "notes": [...]}
//
// FIGURES are those of metrics/figures.h, each at its path: "iou", "intensity": {"union": {"rmse": ...}}.
// SUMMARY contains for each figure its value, "..._ci": [lo, hi] and "..._floor" (its noise floor, from
// `noise_floor`). Figures of the fan are below "fan". Those in fractions of full scale are repeated below
// "in_grey_levels" and, if the scale is known, "in_db". docs/reference/metrics.md defines every figure.
//
// CLASSES are lists of one length: {"name" or "from" and "to", "unit", "whole": SUMS, "union": SUMS}; SUMS is
// {"pixels", "bias", "mean_absolute"}. The map's lists are row-major; a cell has `bins` x `beams` pixels.
//
// "object_region" is the search box of the object: a box around the pixels of the material `object` in the
// scene's model (metrics/segmentation/object_region.h). Absent if no such box was used. `end` is one past the
// box; an empty box means that the model shows no pixel of the object in the frame.
//
// ns, nr, na and the figures of a frame are those of the polar image; "fan" holds those of the fan image.
// Undefined values and missing intervals are null (in the CSV: empty).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/aggregate.h"
#include "metrics/compare.h"
#include "metrics/json/against.h"
#include "metrics/measures/residuals.h"
#include "metrics/noise_floor.h"
#include "metrics/threshold_sweep.h"

namespace sonarcal::metrics {

struct MetricsReport {
  std::string real;       // description of the data: a path, "synthetic" for a simulation
  std::string simulated;  // as `real`
  bool real_is_synthetic = false;
  CompareOptions options;
  ImageScale scale;  // scale of the real recording: grey levels and dB of a fraction of full scale
  std::vector<FrameMetrics> frames;
  Aggregate aggregate;
  NoiseFloor noise_floor;
  ResidualCollector residuals = {};                    // residuals; without frames: not collected
  std::vector<ResidualTable> residuals_by_scene = {};  // by incidence and material, if the scene is known
  std::optional<Against> against = {};                 // comparison with an earlier run, if one was given
  std::optional<ThresholdSweep> sweep = {};            // if CompareOptions::sweep has steps
  std::vector<std::string> notes;                      // one sentence each
};

// One element of "frames", on a single line.
std::string FrameMetricsJson(const FrameMetrics& frame, IntensityDomain domain);

// Text of metrics.json, ending with a newline.
std::string MetricsJson(const MetricsReport& report);
// Text of metrics.json without "frames".
std::string MetricsSummaryJson(const MetricsReport& report);

// Header line and one line per frame, RFC 4180, with "\n" line ends. intensity_error_* are over `domain`.
// Every figure has its path as its name, with "_" for "."; those of the fan have the prefix "fan_".
std::string PerFrameCsv(const std::vector<FrameMetrics>& frames, IntensityDomain domain);

}  // namespace sonarcal::metrics
