// metrics.json and per_frame.csv. Programs rely on their names: fields are added, never renamed.
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
//    "region_margin_m",
//                     "simulated_object", "echo_fraction",
//                     "object_region": {"source": "model", "object", "margin_bins", "margin_beams"}},
//    "threshold_sweep": see metrics/json/sweep_json.h; null where none was asked for,
//    "display": {"full_scale", "span_db"},
//    "intensity_error_definition": what the number is, in words,
//    "noise_floor": {"beside_figures", "speckle": {...}, "real_against_real": {...}, "drawn": {...}},
//    "residuals": {"frames", "frames_left_out", "by_range": CLASSES, "by_beam": CLASSES,
//                  "by_incidence": CLASSES, "by_material": CLASSES,
//                  "map": {"rows", "cols", "bins", "beams", "whole": SUMS, "union": SUMS}},
//    "against": {"better", "worse", "same", "not_told", "all_figures": {the same}, "earlier",
//                "common_frames", "method", "figures": [...], "notes": [...]},
//    "notes": [...]}
//
// FIGURES are those of metrics/figures.h, each at its path: "iou", "intensity": {"union": {"rmse": ...}}.
// SUMMARY is for each figure its value, "..._ci": [lo, hi] and "..._floor" (what no simulator could beat,
// from `noise_floor`), those of the fan below "fan", those in fractions of full scale again below
// "in_grey_levels" and, where the scale is known, "in_db". docs/reference/metrics.md defines every figure.
//
// CLASSES are lists of one length: {"name" or "from" and "to", "unit", "whole": SUMS, "union": SUMS}; SUMS is
// {"pixels", "bias", "mean_absolute"}. The map's lists run row by row, a cell being `bins` x `beams` pixels.
//
// "object_region" says where the object was searched: a box around what the scene's model shows of the
// material `object` (metrics/segmentation/object_region.h). It is absent where no such box was used. `end`
// lies one beyond the box; an empty box means that the scene shows nothing of the object in the frame.
//
// ns, nr, na and the figures of a frame are those of the polar image; "fan" holds those of the fan image. A
// value that is not defined, and an interval that cannot be given, is null (in the CSV: empty).
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
  std::string real;       // what was compared, for people: a path, "synthetic" where it is
  std::string simulated;  // likewise
  bool real_is_synthetic = false;
  CompareOptions options;
  ImageScale scale;  // of the real recording: grey levels and dB of a fraction of full scale
  std::vector<FrameMetrics> frames;
  Aggregate aggregate;
  NoiseFloor noise_floor;
  ResidualCollector residuals = {};                    // where it was wrong; without frames: not collected
  std::vector<ResidualTable> residuals_by_scene = {};  // by incidence and material, where the scene is known
  std::optional<Against> against = {};                 // an earlier run, where one was given
  std::optional<ThresholdSweep> sweep = {};            // where CompareOptions::sweep has steps
  std::vector<std::string> notes;                      // one sentence each
};

// One of "frames", in a line.
std::string FrameMetricsJson(const FrameMetrics& frame, IntensityDomain domain);

// The text of metrics.json, ending with a newline.
std::string MetricsJson(const MetricsReport& report);
// The same without "frames", which may be many.
std::string MetricsSummaryJson(const MetricsReport& report);

// A header line and a line a frame, RFC 4180, with "\n" line ends. intensity_error_* are over `domain`; every
// figure stands under its path with "_" for ".", those of the fan after "fan_".
std::string PerFrameCsv(const std::vector<FrameMetrics>& frames, IntensityDomain domain);

}  // namespace sonarcal::metrics
