// Many frames in a few numbers, in two ways that answer different questions:
//
//   macro  mean over frames of each frame's own figure: every frame weighs the same. A frame in which a ratio
//          is undefined (no object, say) is left out of that ratio's mean, and counted.
//   micro  the figure of all pixels pooled: counts and sums added up first, every pixel weighs the same.
//
// Micro ratios satisfy Na/Nr = (Na/Ns)(Ns/Nr), which is checked at run time; macro ratios do not. Park 2024's
// Table 6 does not (0.75 x 1.21 = 0.91 against a printed 0.82), so its rows can only be macro figures.
//
// A root mean square over frames is the root of the mean square, never a mean of roots.
//
// Intervals: metrics/bootstrap.h. Frames of which every one states a later time than the one before are drawn
// in blocks, others one by one. Distances between pooled grey levels have none: the levels of frames are
// pooled as they come and not kept.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/bootstrap.h"
#include "metrics/compare.h"

namespace sonarcal::metrics {

struct Statistic {
  std::optional<double> value;
  std::optional<Interval> ci;  // 95 %, where at least kBootstrapMinFrames frames define it
  int frames_used = 0;
  int frames_left_out = 0;  // frames in which it is undefined; always 0 for micro
  int block_frames = 1;     // consecutive frames that the interval drew together
};

// Of the difference (simulated - real) / full_scale over one domain (metrics/measures/intensity.h).
struct DifferenceSummary {
  const Statistic& mean_absolute;
  const Statistic& rmse;
  const Statistic& bias;
};

// The figures of a view, in the order of Figures() (metrics/figures.h).
struct ViewSummary {
  ViewSummary();

  std::vector<Statistic> statistics;

  // By the figure's path, such as "iou"; std::logic_error for one that is not in the table.
  const Statistic& At(std::string_view path) const;
  DifferenceSummary Over(IntensityDomain domain) const;
};

struct Aggregate {
  struct Views {
    ViewSummary polar;
    ViewSummary fan;
  };

  int frame_count = 0;
  bool in_time = false;  // every frame states a later time than the one before
  Views macro;
  Views micro;
  ViewMetrics pooled_polar;  // what micro is computed from
  ViewMetrics pooled_fan;
  FrameLevels pooled_levels;       // grey levels of all frames
  std::string no_interval_reason;  // empty where there are frames enough for intervals
};

// Any number of frames; none gives statistics without a value. `levels`: those of frames that do not hold
// their own any more, pooled.
Aggregate AggregateFrames(const std::vector<FrameMetrics>& frames, FrameLevels levels = {});

}  // namespace sonarcal::metrics
