// metrics.json and per_frame.csv. Programs rely on their names: fields are added, never renamed.
//
//   {"format": "sonar-metrics/1", "real", "simulated",
//    "frames": [{"index", "name", "ns", "nr", "na", "ns_over_nr", "na_over_ns", "na_over_nr", "iou",
//                "intensity_error": {"polar", "fan"},
//                "intensity": {"union" | "whole" | "overlap": {"pixels", "mean_absolute", "rmse", "bias"}},
//                "threshold": {"real", "simulated"},
//                "fan": {"ns", ..., "iou", "intensity": {...}}, "notes": [...]}],
//    "macro": {"ns_over_nr", "ns_over_nr_ci": [lo, hi], ..., "intensity_error": {"polar", "polar_ci", ...},
//              "intensity": {...}, "fan": {...}, "frames_left_out": {"na_over_ns": 2}},
//    "micro": {"ns", "nr", "na", and the same},
//    "ci": {"level", "method", "draws", "seed", "absent_because"},
//    "segmentation": {"method", "parameters": {...}, "region_of_interest"},
//    "intensity_error_definition": what the number is, in words,
//    "noise_floor": {"speckle": {...}, "real_against_real": {...}},
//    "notes": [...]}
//
// ns, nr, na and the ratios of a frame are those of the polar image; "fan" holds those of the fan image. A
// value that is not defined, and an interval that cannot be given, is null (in the CSV: empty).
#pragma once

#include <string>
#include <vector>

#include "metrics/aggregate.h"
#include "metrics/compare.h"
#include "metrics/noise_floor.h"

namespace sonarcal {

struct MetricsReport {
  std::string real;       // what was compared, for people: a path, "synthetic" where it is
  std::string simulated;  // likewise
  CompareOptions options;
  std::vector<FrameMetrics> frames;
  Aggregate aggregate;
  NoiseFloor noise_floor;
  std::vector<std::string> notes;  // one sentence each
};

// The text of metrics.json, ending with a newline.
std::string MetricsJson(const MetricsReport& report);

// A header line and a line a frame, RFC 4180, with "\n" line ends. intensity_error_* are over `domain`.
std::string PerFrameCsv(const std::vector<FrameMetrics>& frames, IntensityDomain domain);

}  // namespace sonarcal
