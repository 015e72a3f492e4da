// Summarises many frames, in two ways that answer different questions:
//
//   macro  Mean over frames of each frame's figure: every frame has the same weight. A frame in which a ratio
//          is undefined, e.g. without an object, is left out of that ratio's mean and counted.
//   micro  Figure of all pixels pooled: counts and sums are added first, so every pixel has the same weight.
//
// Micro ratios satisfy Na/Nr = (Na/Ns)(Ns/Nr), which is checked at run time; macro ratios do not. Park 2024's
// Table 6 does not (0.75 x 1.21 = 0.91 against a printed 0.82), so its rows must be macro figures.
//
// A root mean square over frames is the root of the mean square, not a mean of roots.
//
// metrics/bootstrap.h computes the intervals. If every frame has a later time than the one before, frames are
// drawn in blocks, otherwise one by one. Distances between pooled grey levels have no interval, because the
// levels of single frames are not kept.
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
  // 95 % confidence interval, if at least kBootstrapMinFrames frames define the figure
  std::optional<Interval> ci;
  int frames_used = 0;
  int frames_left_out = 0;  // frames in which it is undefined; always 0 for micro
  int block_frames = 1;     // consecutive frames per block of the bootstrap
};

// Statistics of the difference (simulated - real) / full_scale over one domain
// (metrics/measures/intensity.h).
struct DifferenceSummary {
  const Statistic& mean_absolute;
  const Statistic& rmse;
  const Statistic& bias;
};

// Figures of a view, in the order of Figures() (metrics/figures.h).
struct ViewSummary {
  ViewSummary();

  std::vector<Statistic> statistics;

  // Statistic by the figure's path, such as "iou". Throws std::logic_error for an unknown path.
  const Statistic& At(std::string_view path) const;
  DifferenceSummary Over(IntensityDomain domain) const;
};

struct Aggregate {
  struct Views {
    ViewSummary polar;
    ViewSummary fan;
  };

  int frame_count = 0;
  bool in_time = false;  // every frame has a later time than the one before
  Views macro;
  Views micro;
  ViewMetrics pooled_polar;  // sums from which micro is computed
  ViewMetrics pooled_fan;
  FrameLevels pooled_levels;       // grey levels of all frames
  std::string no_interval_reason;  // empty if there are enough frames for intervals
};

// Summarises any number of frames; without frames no statistic has a value. `levels`: pooled levels of the
// frames that no longer hold their own.
Aggregate AggregateFrames(const std::vector<FrameMetrics>& frames, FrameLevels levels = {});

}  // namespace sonarcal::metrics
